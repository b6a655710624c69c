"""What is said of a factor that is redrawn by the clock is what it does."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import breakaway as bk
from breakaway.run.warnings import REDRAWN_IN_TIME

SCRIPT = Path(__file__).parents[2] / "examples/11_redrawn_in_time/redrawn_in_time.py"


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location(SCRIPT.stem, SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("wait_s", [0.05, 0.25])
def test_waiting_finds_the_lowest_of_the_draws(example, wait_s):
    """Rigid friction lets go at the lowest of 450 (1 + 0.3 w), w drawn once per ms."""
    lowest_n = 450.0 * 0.7
    found_n = example.smallest_push_n(wait_s, example.REDRAWN)
    draws = round(wait_s / 1e-3)
    assert lowest_n < found_n < lowest_n + 450.0 * 0.6 * 7.0 / draws  # by chance exp(-7) more
    assert example.smallest_push_n(wait_s, example.UNDISTURBED) == pytest.approx(450.0, abs=0.2)


def test_waiting_changes_nothing_along_the_way(example):
    short, long = (example.smallest_push_n(s, example.ALONG_THE_WAY) for s in (0.05, 0.5))
    scenario = example.rigid(400.0, 1.0, example.ALONG_THE_WAY)
    factor = bk.friction_field(scenario, np.zeros(1)).factor[0]
    assert short == long == pytest.approx(450.0 * factor, abs=0.2)


@pytest.mark.slow
def test_the_warning_has_the_figures_of_the_example(example):
    name, part = "vibrated_feed_soft_at_rest", example.one_part()
    still = example.jumps(name, "none", part).split(";")[0]
    redrawn = example.jumps(name, "paper_random_factor", part).split(";")[0]
    assert f"every 1 ms: {still} became {redrawn})" in REDRAWN_IN_TIME
    push_n = example.smallest_push_n(4.0, example.REDRAWN)
    assert f"let go at {push_n:.1f} N within 4 s" in REDRAWN_IN_TIME


def test_it_is_warned_of_where_the_paper_is_not_reproduced(example):
    for disturbance, warned in (
        (example.REDRAWN, True),
        (example.REDRAWN.model_copy(update={"var": 0.0}), False),
        (example.REDRAWN.model_copy(update={"hold_s": 0.01}), False),  # for the whole run
        (example.ALONG_THE_WAY, False),
    ):
        scenario = example.rigid(400.0, 0.01, disturbance)
        assert REDRAWN_IN_TIME not in bk.simulate(scenario).warnings  # named paper_as_computed
        mine = scenario.with_(name="mine")
        assert (REDRAWN_IN_TIME in bk.simulate(mine).warnings) == warned


@pytest.mark.parametrize("kind", ["paper_random_factor", "field"])
def test_a_study_of_robustness_says_it_once(tmp_path, monkeypatch, kind):
    monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)
    field = {"kind": "field", "var": 0.0, "correlation_length_m": 1e-3}
    study = bk.RobustnessStudy(
        scenario="paper_as_computed",
        changes={"timing.duration_s": 0.005}
        | ({"disturbance": field} if kind == "field" else {}),
        runs=2,
        robustness={
            "over": "disturbance.var", "low": 0.0, "high": 0.2, "resolution": 0.1,
            "failure": ["diverged"], "failure_probability_max": 0.9,
        },
    )  # fmt: skip
    done = bk.run_study(study, out=tmp_path / "out")
    assert done.summary["notes"].count(REDRAWN_IN_TIME) == (kind == "paper_random_factor")
    words = "bounded field along the way, correlation length 1 mm"
    assert (words in done.summary["disturbance"]) == (kind == "field")
