"""What cannot be tuned is said before anything runs: field, value, range, remedy."""

import sys

import pytest

import breakaway as bk

SPEED = "controller.speed_m_per_s"
SPAN = {"low": 0.01, "high": 0.04}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"tune": {"controller.speed": SPAN}}, "did you mean controller.speed_m_per_s?"),
        ({"tune": {"actuator.kind": SPAN}}, "is not a number of the method 'steady_feed'; "),
        ({"tune": {"actuator": SPAN}}, "tune.actuator: is not a number of the method"),
        ({"tune": {}}, "tune"),
        ({"tune": {SPEED: {"low": 0.04, "high": 0.01}}}, "low: 0.04 is not < high = 0.01; swap"),
        ({"tune": {SPEED: {"low": 0.0, "high": 1.0, "log": True}}}, "logarithmic scale needs that"),
        (
            {"tune": {SPEED: {"low": -1.0, "high": 1.0}}},
            "tune.controller.speed_m_per_s.low: -1.0 is",
        ),
        (
            {"tune": {SPEED: {"low": 0.1}}},
            "tune.controller.speed_m_per_s.high: is missing; give a number: Largest value",
        ),
        ({"tune": {SPEED: {**SPAN, "hihg": 1.0}}}, "hihg: is not a known key; did you mean high?"),
        ({"objectives": []}, "objectives"),
        ({"variation": "fields"}, "variation: 'fields' is not one of 'field', 'part', 'none' or"),
        ({"objectives": ["strict_shar"]}, "objectives[0]: 'strict_shar' is not a score; did you"),
        ({"objectives": ["strict_share"] * 2}, "objectives: 'strict_share' is named twice"),
        ({"objectives": ["median_stack_loss_w"]}, "needs a piezo, which the method does not have"),
        ({"constraints": {"strict": {"at_least": 0.5}}}, "constraints.strict: 'strict' is not"),
        ({"constraints": {"strict_share": {"at_most": 0.5}}}, "give at_least = a number"),
        ({"tune": {SPEED: 3.0}}, "3.0 is not a table"),
        ({"tune": 3.0}, "tune: 3.0 is not a table"),
        ({"constraints": {"strict_share": {"atleast": 1}}}, "did you mean at_least?"),
        ({"constraints": {"strict_share": {}}}, "give at_least = a number"),
        ({"constraints": {"strict_share": {"at_least": 1.5}}}, "1.5 is not a share > 0 and <= 1"),
        ({"constraints": {"p99_impacts": {"at_most": 0.0}}}, "at_most: 0.0 is not > 0"),
        ({"laws": ["lugre", "lugre"]}, "names a law twice"),
        ({"laws": ["lugr"]}, "laws"),
        ({"evaluations": 0}, "evaluations: 0 is not >= 1"),
        ({"training_runs": 0}, "training_runs: 0 is not >= 1"),
        ({"method": "steady_fed"}, "did you mean steady_feed?"),
        ({"population": "seized"}, "is neither a file nor a preset"),
        ({"metods": "x"}, "did you mean method?"),
    ],
)
def test_wrong_tunings(feed, changes, words):
    with pytest.raises(bk.StudyError) as error:
        feed(**changes)
    assert words in str(error.value)


@pytest.mark.parametrize(("first", "last"), [(0, 11), (11, 11), (5, 6)])
def test_unseen_parts_must_be_unseen(feed, first, last):
    runs = min(100, last - first + 1) if last < 11 else 100
    with pytest.raises(bk.StudyError) as error:
        feed(test_runs={"first": first, "runs": runs})
    assert str(error.value) == (
        f"test_runs.first: {first} is not >= training_runs = 12: parts {first} to {last} would be "
        "tuned on and called unseen; give a first part >= 12"
    )
    assert feed(test_runs={"first": 12, "runs": 100}).test_runs.numbers == range(12, 112)


def test_what_a_method_is_told_can_not_be_tuned(feed):
    with pytest.raises(bk.StudyError, match=r"tune\.controller\.travel_m: is set for each part"):
        feed(method="force_ramp", tune={"controller.travel_m": SPAN})


def test_quoted_paths_and_tables_are_the_same(feed):
    nested = {"controller": {"speed_m_per_s": SPAN}, "actuator": {"contact": {"gap_m": SPAN}}}
    quoted = {SPEED: SPAN, "actuator.contact.gap_m": SPAN}
    assert feed(tune=nested) == feed(tune=quoted)


@pytest.mark.usefixtures("no_figures")
def test_what_a_scenario_refuses_is_a_trial_with_its_reason(feed, tmp_path):
    tuning = feed(
        method="paper_fm",
        tune={"controller.vibration.frequency_min_hz": {"low": 10.0, "high": 300.0}},
        objectives=["released_share"],
        evaluations=12,
    )
    done = bk.tune(tuning, out=tmp_path)
    refused = [e for e in done.evaluations if e.laws is None]
    assert 0 < len(refused) < 12
    for evaluation in refused:
        assert "is not <= frequency_max_hz = 160.0; swap them" in evaluation.refused
        assert evaluation.numbers["controller.vibration.frequency_min_hz"] > 160.0
    assert done.summary["refused"] == len(refused)
    assert f"{len(refused)} evaluations were refused" in " ".join(done.summary["notes"])
    rows = (tmp_path / "evaluations.csv").read_text().splitlines()[1:]
    assert sum(",refused," in row and "swap them" in row for row in rows) == len(refused)


@pytest.mark.usefixtures("no_figures")
def test_when_all_is_refused_that_is_the_result(feed, tmp_path):
    tuning = feed(
        method="paper_fm",
        tune={"controller.vibration.frequency_min_hz": {"low": 200.0, "high": 300.0}},
        evaluations=2,
    )
    done = bk.tune(tuning, out=tmp_path)
    assert done.summary["result"][0].startswith(
        "all 2 evaluations were refused, the last one with: "
    )


def test_a_missing_optuna_names_the_extra(feed, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(bk.StudyError, match=r"pip install 'breakaway\[tune\]'"):
        bk.tune(feed(), out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "range_"), [("evaluations", "from 1 to 10000$"), ("threads", ">= 1 and <= 1024$")]
)
@pytest.mark.parametrize("value", [0, -1, 1.5, True])
def test_counts_are_checked(feed, tmp_path, name, range_, value):
    end = rf" {range_}" if type(value) is int else "; give one$"
    with pytest.raises(bk.StudyError, match=rf"^{name}: {value} is not a whole number{end}"):
        bk.tune(feed(), out=tmp_path / "out", **{name: value})
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("\ufeff", "byte order mark"),
        ("no toml", "is not TOML"),
        ("", "population: is missing"),
        ('population = "none.toml"', "none.toml: is neither a file nor a preset"),
    ],
)
def test_wrong_files(tmp_path, text, words):
    path = tmp_path / "tuning.toml"
    path.write_text(text)
    with pytest.raises(bk.StudyError) as error:
        bk.load_tuning(path)
    assert str(error.value).startswith(f"{path}:")
    assert words in str(error.value)


def test_paths_start_at_the_file(feed, tmp_path):
    import tomli_w

    values = feed().model_dump(exclude_none=True)
    (tmp_path / "parts.toml").write_text(tomli_w.dumps(values["population"]))
    (tmp_path / "feed.toml").write_text(tomli_w.dumps(values["method"]))
    named = values | {"population": "parts.toml", "method": "feed.toml"}
    (tmp_path / "tuning.toml").write_text(tomli_w.dumps(named))
    assert bk.load_tuning(tmp_path / "tuning.toml") == feed()
