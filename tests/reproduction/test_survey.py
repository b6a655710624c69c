"""Figure 10 in full, in small: its levels are kept, and what they say is right."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binomtest

import breakaway as bk
from breakaway.ask.reproduction.report import reproduce
from breakaway.ask.reproduction.survey import (
    CONTROLS,
    FULL_LEVELS,
    QUICK_LEVELS,
    DisturbanceRange,
    FullSurvey,
    disturbance_range,
    read_survey,
)
from breakaway.cli.reproduce import reproduce as reproduce_command
from breakaway.errors import OutputError, StudyError

pytestmark = pytest.mark.slow

SMALL = FullSurvey(levels=(0.0, 0.05, 0.5), seeds=6)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "figure_10"
    SMALL.run(folder)
    return folder


def contents(folder: Path) -> dict[Path, bytes]:
    """Every file of a folder."""
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def interrupted_after(runs: int):
    def progress(at):
        if at.runs_done >= runs:
            raise KeyboardInterrupt

    return progress


def test_the_full_levels_hold_what_the_paper_prints():
    assert len(FULL_LEVELS) == 20
    assert {0.085, 0.125, *QUICK_LEVELS} <= set(FULL_LEVELS)
    assert list(FULL_LEVELS) == sorted(set(FULL_LEVELS))


def test_both_ways_and_single_runs_give_the_same_bits(whole):
    for control, kept in read_survey(whole).items():
        scenario = bk.load_scenario(CONTROLS[control])
        quick = disturbance_range(scenario, SMALL.levels, SMALL.seeds)
        for name in ("var", "iae_m_s", "peak_force_n", "largest_jump_m"):
            np.testing.assert_array_equal(getattr(kept, name), getattr(quick, name))
        assert {k: v.tolist() for k, v in kept.outcomes.items()} == {
            k: v.tolist() for k, v in quick.outcomes.items()
        }
        run = bk.simulate(scenario.with_({"disturbance.var": 0.5}), run_index=5)
        assert run.outcome == "diverged" or run.metrics.iae_m_s == kept.iae_m_s[2, 5]


@pytest.mark.parametrize("runs", [1, 30])
def test_an_interrupted_survey_goes_on_to_the_same_files(whole, tmp_path, runs):
    folder = tmp_path / "figure_10"
    with pytest.raises(KeyboardInterrupt):
        dataclasses.replace(SMALL, progress=interrupted_after(runs)).run(folder)
    kept = {path: (folder / path).stat().st_mtime_ns for path in contents(folder)}
    pieces = [path for path in kept if path.suffix == ".parquet"]
    assert len(pieces) < 9
    SMALL.run(folder)
    assert contents(folder) == contents(whole)
    for path in pieces:
        assert (folder / path).stat().st_mtime_ns == kept[path]


def test_what_is_done_is_found_and_told(whole):
    told = []
    dataclasses.replace(SMALL, progress=told.append).run(whole)
    assert told[-1].runs_done == told[-1].runs_found == told[-1].runs_max == 54
    assert [at.doing for at in told][::3] == [control.replace("_", " ") for control in CONTROLS]


def test_a_damaged_level_is_computed_again_and_said(whole, tmp_path):
    folder = tmp_path / "figure_10"
    shutil.copytree(whole, folder)
    piece = next(iter(sorted((folder / "with_vibration_bounded" / "pieces").iterdir())))
    piece.write_bytes(piece.read_bytes()[:-30])
    said = []
    dataclasses.replace(SMALL, notice=said.append).run(folder)
    assert len(said) == 1 and piece.name in said[0] and "computed again" in said[0]
    assert contents(folder) == contents(whole)


def test_levels_of_other_settings_are_refused_and_kept(whole):
    before = contents(whole)
    with pytest.raises(StudyError, match=r"holds another study: study\.runs is 6 there and 7 now"):
        dataclasses.replace(SMALL, seeds=7).run(whole)
    assert contents(whole) == before


def test_an_unfinished_survey_is_not_drawn(tmp_path):
    with pytest.raises(StudyError, match="holds no study"):
        read_survey(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        dataclasses.replace(SMALL, progress=interrupted_after(1)).run(tmp_path)
    with pytest.raises(StudyError, match="not finished; go on with breakaway reproduce --full"):
        read_survey(tmp_path)


def test_a_full_disk_tells_how_to_go_on(tmp_path, monkeypatch):
    def full(path, _):
        raise OutputError(f"{path}: cannot be written: No space left on device; make room")

    monkeypatch.setattr("breakaway.ask.durable.journal.write_inside", full)
    with pytest.raises(OutputError, match="what is finished stays: resume it to go on"):
        SMALL.run(tmp_path / "figure_10")


def test_rows_count_bound_and_leave_out_what_diverged():
    iae = np.array([[1.0, 1.0, 1.0, 1.0], [1.0, 2.0, 3.0, np.nan], [np.nan] * 4])
    counts = {"released": [4, 2, 0], "not_released": [0, 1, 0], "diverged": [0, 1, 4]}
    survey = DisturbanceRange(
        var=np.array([0.0, 0.1, 0.2]),
        iae_m_s=iae,
        peak_force_n=iae,
        largest_jump_m=iae,
        outcomes={name: np.array(values) for name, values in counts.items()},
        runs=4,
    )
    undisturbed, some, none = survey.rows()
    assert undisturbed["diverged_upper_bound"] is None  # all runs are the same one
    assert some["iae_median_m_s"] == 2.0
    for row, key, events in (
        (some, "diverged_upper_bound", 1),
        (some, "not_extracted_upper_bound", 2),
        (none, "diverged_upper_bound", 4),
    ):
        test = binomtest(events, 4, alternative="less").proportion_ci(0.95, method="exact")
        assert row[key] == pytest.approx(test.high)
    assert none["iae_median_m_s"] is None
    assert survey.level(0.12) == 1


def test_the_report_takes_the_full_survey(tmp_path, monkeypatch, simulated):
    few = FullSurvey(levels=(0.0, 0.05, 0.085, 0.125), seeds=4)
    runs, _ = simulated
    monkeypatch.setattr(
        "breakaway.ask.reproduction.report.simulate_all",
        lambda _, ranges: dataclasses.replace(runs, ranges=ranges),
    )
    told: list[str] = []
    reproduce(tmp_path, told.append, few)
    assert told[0] == "figure 10: 4 levels x 4 runs of each control"
    values = json.loads((tmp_path / "reproduction.json").read_text(encoding="utf-8"))
    data = values["figures"]["figure_10"]["data"]
    assert data["without_vibration"]["var"] == [0.0, 0.05, 0.085, 0.125]
    assert data["with_vibration"]["diverged"] == [4] * 4
    survived = values["findings"]["largest_stable_var_without_vibration"]["ours"]
    assert "0 of 4 diverged at var = 12.5%, a probability of at most 0.53" in survived
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "run numbers 0 to 3 at each" in page
    assert (tmp_path / "figure_10.png").stat().st_size > 20_000
    assert (tmp_path / "figure_10" / "without_vibration" / "manifest.json").exists()


def test_the_command_goes_in_full_and_tells_how_to_go_on(tmp_path, monkeypatch, capsys):
    out = tmp_path / "out"
    asked = []

    def interrupted(folder, progress, full):
        asked.append(full)
        (folder / "figure_10").mkdir(parents=True)
        progress("under way")
        raise KeyboardInterrupt

    monkeypatch.setattr("breakaway.ask.reproduction.report.reproduce", interrupted)
    with pytest.raises(KeyboardInterrupt):
        reproduce_command(out, full=True)
    assert asked[0].study("without_vibration").runs == 10_000
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines() == [
        "under way",
        f"finished levels are kept; go on with: breakaway reproduce --full --out {out}",
    ]
