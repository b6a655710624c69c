"""Conversions of MDF files: known answers by hand, the same as asammdf's where it is right."""

from pathlib import Path
from typing import Any

import asammdf
import numpy as np
import pytest
from asammdf.blocks import v4_constants as v4c
from asammdf.blocks.v4_blocks import ChannelConversion
from tests.logs.mdf_files import converted, write

from breakaway.errors import LogError
from breakaway.measure.logs import read_log
from breakaway.measure.logs.budget import Budget
from breakaway.measure.logs.mdf import open_mdf
from breakaway.measure.logs.mdf.conversion import ConversionError, Ranges, Table

Conversion = ChannelConversion


def conversion(kind: str, **values: Any) -> ChannelConversion:
    """Return a conversion, of a kind as asammdf calls it."""
    return ChannelConversion(conversion_type=getattr(v4c, f"CONVERSION_TYPE_{kind}"), **values)


def table(kind: str, **columns: list[Any]) -> ChannelConversion:
    """Return a table, of columns as asammdf calls them."""
    rows = {f"{name}_{k}": x for name, column in columns.items() for k, x in enumerate(column)}
    count = len(rows) if kind != "TABX" else len(rows) // 2
    return conversion(kind, val_param_nr=count, **rows)


def ranges(default: float, *rows: tuple[float, float, float]) -> ChannelConversion:
    lower, upper, phys = (list(column) for column in zip(*rows, strict=True))
    columns = {"lower": lower, "upper": upper, "phys": phys}
    values = {f"{name}_{k}": x for name, column in columns.items() for k, x in enumerate(column)}
    return conversion("RTAB", val_param_nr=3 * len(rows) + 1, default=default, **values)


def texts(default: bytes | Conversion, **rows: bytes | Conversion) -> ChannelConversion:
    """Return a table of raw values as ``v7=b"open"``, each a text or a conversion."""
    values = {f"val_{k}": float(key[1:]) for k, key in enumerate(rows)}
    values |= {f"text_{k}": row for k, row in enumerate(rows.values())}
    links = len(rows) + 5
    return conversion(
        "TABX",
        val_param_nr=len(rows),
        ref_param_nr=len(rows) + 1,
        links_nr=links,
        default_addr=default,
        **values,
    )


def range_texts(
    default: bytes | Conversion, *rows: tuple[float, float, bytes | Conversion]
) -> ChannelConversion:
    values: dict[str, Any] = {}
    for k, (lower, upper, text) in enumerate(rows):
        values |= {f"lower_{k}": lower, f"upper_{k}": upper, f"text_{k}": text}
    return conversion(
        "RTABX",
        val_param_nr=2 * len(rows),
        ref_param_nr=len(rows) + 1,
        links_nr=len(rows) + 5,
        default_addr=default,
        **values,
    )


HALF = conversion("LIN", a=0.5, b=-1.0)
INTEGERS = np.array([0, 1, 2, 3, 4, 5, 6, 7, 8, 9], dtype=np.uint8)
REALS = INTEGERS / 2.0 - 1.0

KNOWN: dict[str, tuple[ChannelConversion, np.ndarray, list[float]]] = {
    "none": (conversion("NON"), INTEGERS, list(range(10))),
    "linear": (HALF, INTEGERS, [-1, -0.5, 0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5]),
    "rational": (  # (x² + 2 x + 3) / (x + 4)
        conversion("RAT", P1=1.0, P2=2.0, P3=3.0, P4=0.0, P5=1.0, P6=4.0),
        INTEGERS,
        [3 / 4, 6 / 5, 11 / 6, 18 / 7, 27 / 8, 38 / 9, 51 / 10, 66 / 11, 83 / 12, 102 / 13],
    ),
    "interpolated": (
        table("TABI", raw=[1, 3, 7], phys=[10, 30, -10]),
        INTEGERS,
        [10, 10, 20, 30, 20, 10, 0, -10, -10, -10],
    ),
    "nearest": (
        table("TAB", raw=[1, 3, 8], phys=[10, 30, -10]),
        INTEGERS,
        [10, 10, 10, 30, 30, 30, -10, -10, -10, -10],
    ),
    "ranges of integers": (
        ranges(-7, (1, 2, 20), (4, 6, 40)),
        INTEGERS,
        [-7, 20, 20, -7, 40, 40, 40, -7, -7, -7],
    ),
    "ranges of reals": (
        ranges(-7, (-1, 0, 20), (0, 1.5, 40)),
        REALS,
        [20, 20, 40, 40, 40, -7, -7, -7, -7, -7],
    ),
    "further conversions by value": (
        texts(HALF, v7=b"a fault", v300=conversion("LIN", a=2.0, b=0.0)),
        np.array([0, 300, 2, 300, 4, 6], dtype=np.uint16),
        [-1, 600, 0, 600, 1, 2],
    ),
    "further conversions by range": (
        range_texts(b"a fault", (0, 3, HALF), (4, 9, conversion("LIN", a=1.0, b=100.0))),
        INTEGERS,
        [-1, -0.5, 0, 0.5, 104, 105, 106, 107, 108, 109],
    ),
}


def force_of(path: Path) -> np.ndarray:
    """Return the values of the force; fail with the reason if there are none."""
    with open_mdf(path, Budget(path.name, 1e8)) as raw:
        raw.load(raw.names)
    assert raw.unreadable == {}
    assert raw.listed["force"].unit == "N"
    return raw.channels["force"].values


def why_not(path: Path) -> str:
    """Return why the force cannot be read."""
    with open_mdf(path, Budget(path.name, 1e8)) as raw:
        raw.load(raw.names)
    assert raw.channels == {}
    return raw.unreadable["force"]


@pytest.mark.parametrize("name", list(KNOWN))
def test_known_answers_and_those_of_asammdf(tmp_path: Path, name: str) -> None:
    conversion, raw, values = KNOWN[name]
    path = write(tmp_path, [converted(raw, conversion)])
    np.testing.assert_allclose(force_of(path), values, rtol=1e-15)
    if name == "ranges of integers":  # asammdf 8.8 gives 0 the value of the last range
        return
    with asammdf.MDF(path) as file:
        np.testing.assert_allclose(file.get("force").samples.astype(float), values, rtol=1e-12)


def test_a_formula_is_applied(tmp_path: Path) -> None:
    path = write(tmp_path, [converted(INTEGERS, conversion("ALG", formula="X1*10^2"))])
    np.testing.assert_array_equal(force_of(path), 100.0 * INTEGERS)


def test_a_formula_that_is_not_understood_is_shown(tmp_path: Path) -> None:
    path = write(tmp_path, [converted(INTEGERS, conversion("ALG", formula="marker\x1b(X1) & 3"))])
    shown = r"its formula 'marker\x1b(X1) & 3' is not applied: '\x1b' has no meaning in it"
    assert why_not(path) == shown
    with pytest.raises(LogError, match=r"motor\.mf4: column 'force': its formula 'marker"):
        read_log(path, {"channels": {"force_n": {"from": "force", "unit": "N"}}})
    path = write(tmp_path, [converted(INTEGERS, conversion("ALG", formula="X1+" * 100 + "Q"))])
    assert len(why_not(path)) < 200


def test_texts_are_no_numbers(tmp_path: Path) -> None:
    path = write(tmp_path, [converted(INTEGERS, texts(HALF, v7=b"a fault"))])
    said = why_not(path)
    assert said == "row 8: its raw value 7 stands for the text 'a fault', which is not a number"
    path = write(tmp_path, [converted(INTEGERS[:7], texts(b"", v7=b"a fault"))])
    assert "stands for nothing, which is not a number" in why_not(path)
    path = write(tmp_path, [converted(INTEGERS, range_texts(b"low", (5, 9, HALF)))])
    said = why_not(path)
    assert said == "row 1: its raw value 0 stands for the text 'low', which is not a number"


def test_a_formula_behind_a_table(tmp_path: Path) -> None:
    inner = texts(HALF, v3=conversion("ALG", formula="X^2"), v4=conversion("ALG", formula="X | 1"))
    path = write(tmp_path, [converted(INTEGERS[:4], inner)])
    np.testing.assert_array_equal(force_of(path), [-1, -0.5, 0, 9])
    path = write(tmp_path, [converted(INTEGERS, inner)])
    assert why_not(path).startswith("its formula 'X | 1' is not applied")


def test_rows_count_in_the_whole_channel(tmp_path: Path) -> None:
    raw = np.zeros(3_000_000, dtype=np.uint8)
    raw[2_999_998] = 7
    path = write(tmp_path, [converted(raw, texts(HALF, v7=b"a fault"))])
    assert why_not(path).startswith("row 2999999: its raw value 7")


def test_tables_that_can_be_read_in_two_ways_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [converted(INTEGERS, table("TABI", raw=[3, 1], phys=[0, 1]))])
    assert why_not(path) == "the keys of its table do not ascend"
    path = write(tmp_path, [converted(INTEGERS, ranges(0, (0, 4, 1), (3, 6, 2)))])
    assert why_not(path) == "the ranges of its table overlap"
    path = write(tmp_path, [converted(INTEGERS, ranges(0, (0, 4, 1), (4, 6, 2)))])
    assert "row 5: its raw value 4 is at the end of a range" in why_not(path)
    path = write(tmp_path, [converted(INTEGERS, texts(HALF, v1=HALF, v01=HALF))])
    assert why_not(path) == "its table holds the same key twice"


def test_raw_values_that_are_none_get_no_default(tmp_path: Path) -> None:
    raw = np.where(INTEGERS == 2, np.nan, REALS)
    path = write(tmp_path, [converted(raw, ranges(0, (-1, 4, 1)))])
    assert why_not(path) == "row 3: its raw value nan is not a number"
    nearest = Table(np.array([0.0, 1.0]), np.array([5.0, 6.0]), interpolated=False)
    assert np.isnan(nearest(raw)[2]) and not np.isnan(nearest(raw)[3])


def test_a_range_without_width_is_doubtful_for_reals() -> None:
    point = Ranges(np.array([0.0, 1.0]), np.array([0.0, 2.0]))
    np.testing.assert_array_equal(point(np.array([0, 1, 3])), [0, 1, 2])
    with pytest.raises(ValueError, match="end of a range"):
        point(np.array([0.0, 1.0]))
    with pytest.raises(ConversionError, match="empty"):
        Ranges(np.zeros(0), np.zeros(0))
