"""Wrong types given to what runs, loads and opens: one line that names the argument."""

from __future__ import annotations

import pytest

import breakaway as bk
from breakaway.errors import BreakawayError, OutputError, StudyError


@pytest.fixture(scope="module")
def study():
    return bk.SweepStudy(
        scenario="paper_as_computed",
        changes={"timing.duration_s": 0.001, "disturbance.var": 0.1},
        runs=1,
    )


@pytest.fixture(scope="module")
def tuning():
    return bk.Tuning(
        population="seized_parts",
        method="steady_feed",
        objectives=["strict_share"],
        tune={"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
    )


WRONG = [
    ({"out": 5}, OutputError, "out: 5 is not a path"),
    ({"out": None}, OutputError, "out: None is not a path"),
    ({"resume": "yes"}, StudyError, "resume: 'yes' is not True or False"),
    ({"threads": 1.0}, StudyError, "threads: 1.0 is not a whole number"),
    ({"progress": 5}, StudyError, "progress: 5 can not be called"),
    ({"notice": []}, StudyError, r"notice: \[\] can not be called"),
]


def one_line(error: BreakawayError) -> None:
    assert str(error).count("\n") == 0


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [*WRONG, ({"study": "x.toml"}, StudyError, "study: str is not a study; load one with load_st")],
)
def test_run_study(study, tmp_path, changes, error, words):
    given = {"study": study, "out": tmp_path / "out"} | changes
    with pytest.raises(error, match=words) as caught:
        bk.run_study(given.pop("study"), **given)
    one_line(caught.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        *WRONG,
        ({"tuning": "x.toml"}, StudyError, "tuning: 'x.toml' is not a Tuning; load one with load"),
        ({"evaluations": 2.0}, StudyError, "evaluations: 2.0 is not a whole number >= 1"),
    ],
)
def test_tune(tuning, tmp_path, changes, error, words):
    given = {"tuning": tuning, "out": tmp_path / "out"} | changes
    with pytest.raises(error, match=words) as caught:
        bk.tune(given.pop("tuning"), **given)
    one_line(caught.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        *(wrong for wrong in WRONG if wrong[0] != {"out": None}),
        ({"runs": 2.0}, StudyError, "runs: 2.0 is not a whole number"),
        ({"runs": "4"}, StudyError, "runs: '4' is not a whole number"),
        ({"runs": range(4, 4)}, StudyError, r"runs: range\(4, 4\) is not a range of one part or"),
        ({"runs": range(0, 8, 2)}, StudyError, r"runs: range\(0, 8, 2\) is not a range of one "),
        ({"runs": range(-3, 8)}, StudyError, "first: -3 is not >= 0"),
    ],
)
def test_compare_methods(tmp_path, changes, error, words):
    with pytest.raises(error, match=words) as caught:
        bk.compare_methods("seized_parts", ["steady_feed"], **{"out": tmp_path / "out"} | changes)
    one_line(caught.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("use", [bk.load_study, bk.load_tuning, bk.open_study, bk.open_tuning])
@pytest.mark.parametrize("given", [5, None, [], {}])
def test_paths(use, given):
    with pytest.raises(StudyError, match=r" is not a path; give the path of a ") as caught:
        use(given)
    one_line(caught.value)
