"""Formulas of MDF files: known answers, and what is not understood."""

import math
import time

import numpy as np
import pytest

from breakaway.measure.logs.mdf.formula import FUNCTIONS, FormulaError, parse

X = 6.0


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("X1*10^2", 600.0),
        ("X", 6.0),
        ("x1 ", 6.0),
        ("7", 7.0),
        ("1.5e1 - .5 + 2.", 16.5),
        ("1 - 2 - 3", -4.0),
        ("12 / X / 2", 1.0),
        ("1 + 2 * X", 13.0),
        ("(1 + 2) * X", 18.0),
        ("X / 4", 1.5),
        ("2 * X^2", 72.0),
        ("X**2", 36.0),
        ("2^-X", 1 / 64),
        ("-X", -6.0),
        ("--X", 6.0),
        ("-+-X", 6.0),
        ("2 * -X", -12.0),
        ("(-X)^2", 36.0),
        ("-(X^2)", -36.0),
        ("-0.5*X^2 + 1", -17.0),
        ("(2^3)^2", 64.0),
        ("2^(3^2)", 512.0),
        ("pow(X, 2) + 1", 37.0),
        ("ln(X)", math.log(6.0)),
        ("log10(X)", math.log10(6.0)),
        ("SQRT(X + 3)", 3.0),
        ("abs(-X)", 6.0),
        ("atan(X) - arctan(X)", 0.0),
        ("sin(X)^2 + cos(X)^2", 1.0),
        ("exp(ln(X))", 6.0),
    ],
)
def test_known_answers(text: str, value: float) -> None:
    np.testing.assert_allclose(parse(text)(np.array([X, X])), [value, value], rtol=1e-15)


def test_integers_are_divided_and_raised_as_numbers() -> None:
    raw = np.array([7, -1], dtype=np.int8)
    np.testing.assert_array_equal(parse("X / 2")(raw), [3.5, -0.5])
    np.testing.assert_array_equal(parse("X^2 * 100")(raw), [4900.0, 100.0])
    np.testing.assert_array_equal(parse("2^X")(raw), [128.0, 0.5])


@pytest.mark.parametrize("text", ["1 / (X - 6)", "sqrt(-X)", "(-8)^(1/3)", "exp(1000 * X)"])
def test_what_has_no_value_is_not_finite(text: str) -> None:
    assert not np.isfinite(parse(text)(np.array([X]))).any()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "ends too early"),
        ("X +", "ends too early"),
        ("(X", r"'\)' is missing"),
        ("X)", r"'\)' stands where it should end"),
        ("X X", "'x' stands where it should end"),
        ("2X", "'x' stands where it should end"),
        ("X2 + 1", "'x2' is unknown"),
        ("sin", r"'\(' is missing"),
        ("pow(X)", "',' is missing"),
        ("sqrt(X, 2)", r"'\)' is missing"),
        ("X & 3", "'&' has no meaning"),
        ("X == 1", "'=' has no meaning"),
        ("X.real", "'.' has no meaning"),
        ("X[0]", r"'\[' has no meaning"),
        ("'text'", '"\'" has no meaning'),
        ("²", "'²' has no meaning"),
        ("٣", "'٣' has no meaning"),
        ("marker(X)", "'marker' is unknown"),
        ("1e999", "not a finite number"),
        ("log(X)", "ln or log10"),
        ("-X^2", "a sign before a power"),
        ("2^3^2", "a power of a power"),
        ("2^-3^2", "a power of a power"),
    ],
)
def test_refuses(text: str, words: str) -> None:
    with pytest.raises(FormulaError, match=words):
        parse(text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("X" + " " * 1000, "1000 characters"),
        ("(" * 33 + "X" + ")" * 33, "32 nested brackets"),
        ("-" * 33 + "X", "32 nested brackets and signs"),
        ("sin(" * 33 + "X" + ")" * 33, "32 nested brackets"),
        ("+X" * 150, "200 numbers and operations"),
    ],
)
def test_limits(text: str, words: str) -> None:
    begin = time.process_time()
    with pytest.raises(FormulaError, match=words):
        parse(text)
    assert time.process_time() - begin < 0.5


def test_every_function_is_that_of_its_name() -> None:
    for name, function in FUNCTIONS.items():
        arguments = (0.5,) * function.nin
        expected = getattr(math, name.replace("arc", "a").replace("ln", "log"), abs)(*arguments)
        text = f"{name}({', '.join(['X'] * function.nin)})"
        np.testing.assert_allclose(parse(text)(np.array([0.5])), [expected], rtol=1e-15)
