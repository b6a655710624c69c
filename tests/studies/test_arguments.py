"""What runs, loads and opens studies, tunings and comparisons refuses before it touches a disk."""

from __future__ import annotations

import pytest

import breakaway as bk
from breakaway.errors import OutputError, StudyError

WRONG = [
    ({"out": 5}, OutputError, "out: 5 is not a path"),
    ({"resume": "yes"}, StudyError, "resume: 'yes' is not True or False"),
    ({"threads": 1.0}, StudyError, "threads: 1.0 is not a whole number"),
    ({"progress": 5}, StudyError, "progress: 5 is not a function"),
    ({"notice": []}, StudyError, r"notice: \[\] is not a function"),
]
RUNS = [
    ({"runs": 2.0}, StudyError, "runs: 2.0 is not a whole number"),
    ({"runs": "4"}, StudyError, "runs: '4' is not a whole number"),
    ({"runs": range(4, 4)}, StudyError, r"runs: range\(4, 4\) is not .* nor a range"),
    ({"runs": range(0, 8, 2)}, StudyError, r"runs: range\(0, 8, 2\) is not .* nor a range"),
    ({"runs": range(-3, 8)}, StudyError, r"runs: range\(-3, 8\) is not .* nor a range"),
]


def refuses(call, given, error, words, out):
    with pytest.raises(error, match=words) as caught:
        call(**{"out": out} | given)
    assert "\n" not in str(caught.value)
    assert not out.exists()


@pytest.mark.parametrize(("given", "error", "words"), WRONG)
def test_run_study(tmp_path, given, error, words):
    changes = {"timing.duration_s": 0.001, "disturbance.var": 0.1}
    study = bk.SweepStudy(scenario="paper_as_computed", changes=changes, runs=1)
    refuses(bk.run_study, {"study": study} | given, error, words, tmp_path / "out")


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [*WRONG, ({"evaluations": 0}, StudyError, "evaluations: 0 is not a whole number from 1 to ")],
)
def test_tune(tmp_path, given, error, words):
    tuning = bk.Tuning(
        population="seized_parts",
        method="steady_feed",
        objectives=["strict_share"],
        tune={"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
    )
    refuses(bk.tune, {"tuning": tuning} | given, error, words, tmp_path / "out")


@pytest.mark.parametrize(("given", "error", "words"), [*WRONG, *RUNS])
def test_compare_methods(tmp_path, given, error, words):
    asked = {"population": "seized_parts", "methods": ["steady_feed"]}
    refuses(bk.compare_methods, asked | given, error, words, tmp_path / "out")
