"""A law pays where it predicts rows that it has not seen, and not otherwise."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from breakaway.errors import LogError
from breakaway.measure.identification import LAWS, compare_laws
from breakaway.measure.logs import Log


@pytest.fixture(scope="module")
def plain() -> Log:
    """Give a log of Coulomb and viscous friction alone."""
    t_s = np.arange(2000) / 1000.0
    x = 0.02 * np.sin(6 * t_s) + 0.006 * np.sin(23 * t_s)
    v = 0.12 * np.cos(6 * t_s) + 0.138 * np.cos(23 * t_s)
    force = 5.0 * np.sign(v) + 20.0 * v + 0.3 * np.random.default_rng(0).standard_normal(len(v))
    return Log(t_s=t_s, position_m=x, force_n=force)


def test_a_peak_that_is_not_there_does_not_pay(plain: Log) -> None:
    simple, rich = compare_laws(plain, held_out=(1.4, 2.0), laws=["coulomb", "stribeck"], starts=2)
    assert (simple.pays, rich.pays) == (True, False)
    assert (simple.against, simple.because) == ("", "the first law")
    assert rich.against == simple.fit.law.label
    assert "held-out error" in rich.because and "AIC" in rich.because
    assert simple.fit.spans == ((0.0, 1.4),)


def test_a_bristle_pays_where_there_is_one(rich: Log) -> None:
    compared = compare_laws(rich, held_out=(1.1, 1.5), laws=LAWS[:3], starts=2)
    assert [one.fit.law.name for one in compared] == list(LAWS[:3])
    assert compared[-1].pays
    assert compared[-1].held_out_error < 0.2 * compared[0].held_out_error
    assert compared[-1].held_out_error == compared[-1].fit.predict(spans=[(1.1, 1.5)]).rms_error


def test_the_unit_of_force_does_not_matter(plain: Log) -> None:
    settings: dict[str, Any] = {"held_out": (1.4, 2.0), "laws": LAWS[:2], "starts": 2}
    one = compare_laws(plain, **settings)
    other = compare_laws(replace(plain, force_n=1e3 * plain.force_n), **settings)
    assert [each.pays for each in one] == [each.pays for each in other]
    assert other[0].held_out_error == pytest.approx(1e3 * one[0].held_out_error, rel=1e-4)
    drops = [each[0].fit.aic_for(100.0) - each[1].fit.aic_for(100.0) for each in (one, other)]
    assert drops[0] == pytest.approx(drops[1], abs=0.01)


def test_more_parameters_cost_more(plain: Log) -> None:
    simple, rich = compare_laws(plain, held_out=(1.4, 2.0), laws=LAWS[:2], starts=1)
    rows = 500.0
    less = simple.fit.aic_for(rows) - 2 * len(simple.fit.estimates)
    more = rich.fit.aic_for(rows) - 2 * len(rich.fit.estimates)
    assert more <= less + 0.1
    for fit in (simple.fit, rich.fit):
        due = (np.log(fit.effective_rows) - 2.0) * (len(fit.estimates) + 1)
        assert fit.bic - fit.aic == pytest.approx(due)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"held_out": (1.0, 2.0), "repeats": [(0.0, 1.2)]}, "held_out: 1 s to 2 s overlaps"),
        ({"held_out": (0.0, 0.5)}, "the span 0 s to 0 s holds 0 rows"),
        ({"held_out": (1.0, 2.0), "laws": ["coulomb", "dahl"]}, "law: 'dahl' is not one of"),
        ({"held_out": (5.0, 6.0)}, "span 5 s to 6 s holds 0 rows"),
        ({"held_out": (1.0, 2.0), "starts": 0}, "starts: 0 is not a whole number"),
    ],
)
def test_refuses(plain: Log, settings: dict[str, Any], words: str) -> None:
    with pytest.raises(LogError, match=words):
        compare_laws(plain, **{"laws": ["coulomb"], "starts": 1, **settings})
