"""What a comparison says is what its parts say, part by part."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.dataset as ds
import pytest
from scipy import stats

import breakaway as bk
from breakaway.ask.comparison.asked import Asked
from breakaway.ask.comparison.courses import course_of, kept_rows, worst_slip
from breakaway.ask.comparison.findings import sentences_of
from breakaway.ask.comparison.table import median_row, table_of, worst_row
from breakaway.run.trials import Case

pytestmark = pytest.mark.slow

LAWS = ["lugre", "elasto_plastic"]


def columns_of(folder: Path, law: str, method: str) -> dict[str, np.ndarray]:
    wanted = (ds.field("law") == law) & (ds.field("method") == method)
    table = ds.dataset(folder / "pieces", format="parquet").to_table(filter=wanted)
    return {name: table[name].to_numpy() for name in table.column_names}


def test_the_folder_has_everything(whole, done):
    names = {path.name for path in whole.iterdir()}
    courses = {f"course_{place}_{law}_field" for place in (1, 2, 3) for law in LAWS}
    figures = {"shares", "jump_against_peak_field", *courses}
    assert names == {
        ".lock", "digests.txt", "manifest.json", "comparison.toml", "table.csv", "summary.json",
        "index.html", "pieces", *(f"{name}.{kind}" for name in figures for kind in ("png", "svg")),
    }  # fmt: skip
    assert len(list((whole / "pieces").iterdir())) == 6
    summary = json.loads((whole / "summary.json").read_text())
    assert summary["result"] == list(done.result)
    assert summary["table"] == list(done.table)
    assert [row["method"] for row in done.table[:3]] == ["follow", "ramp", "weak & <slow>"]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("method", ["follow", "ramp", "weak & <slow>"])
def test_the_table_follows_from_the_parts(whole, done, law, method):
    """By numpy and scipy alone, from the files."""
    data, row = columns_of(whole, law, method), done.row(law, method)
    runs = len(data["run_index"])
    assert sorted(data["run_index"]) == list(range(24))
    free = np.isfinite(data["time_to_release_s"])
    peak, jump = data["peak_over_breakaway"], data["largest_jump_m"]
    velocity = data["release_velocity_m_per_s"]
    found = {
        "released": free,
        "gentle": free & (peak <= 1.5) & (jump <= 0.5e-3) & (velocity <= 0.3),
        "strict": free & (peak <= 1.25) & (jump <= 0.25e-3) & (velocity <= 0.1),
    }
    for name, mask in found.items():
        interval = stats.binomtest(int(mask.sum()), runs).proportion_ci(0.95, "exact")
        assert row[name] == mask.sum()
        assert row[f"{name}_share"] == mask.sum() / runs
        assert row[f"{name}_low"] == pytest.approx(interval.low, abs=1e-9)
        assert row[f"{name}_high"] == pytest.approx(interval.high, abs=1e-9)
    assert row["force_share"] == (free & (peak <= 1.5)).sum() / runs
    assert row["jump_share"] == (free & (jump <= 0.5e-3)).sum() / runs
    assert row["velocity_share"] == (free & (velocity <= 0.3)).sum() / runs
    assert row["time_to_release_s_median"] == np.median(data["time_to_release_s"][free])
    assert row["release_velocity_m_per_s_p99"] == np.quantile(velocity[free], 0.99)
    for name in ("largest_jump_m", "peak_over_breakaway", "largest_impact_work_j", "impulse_n_s"):
        assert row[f"{name}_median"] == np.median(data[name])
        assert row[f"{name}_p99"] == np.quantile(data[name], 0.99)
    assert row["stack_cycles_median"] is None
    assert row["worst_run"] == data["run_index"][np.argmax(jump)]
    released = np.sort(jump[free])
    middle = jump[data["run_index"] == row["median_run"]][0]
    assert middle == released[(len(released) - 1) // 2]


def test_pairs_are_compared_part_by_part(whole, done):
    row = done.row("lugre", "ramp")
    assert row["against"] == "follow"
    masks = []
    for method in ("ramp", "follow"):
        d = columns_of(whole, "lugre", method)
        ok = np.isfinite(d["time_to_release_s"]) & (d["peak_over_breakaway"] <= 1.5)
        ok &= (d["largest_jump_m"] <= 0.5e-3) & (d["release_velocity_m_per_s"] <= 0.3)
        masks.append(ok)
    ours, theirs = (masks[0] & ~masks[1]).sum(), (masks[1] & ~masks[0]).sum()
    assert (row["gentle_only_this"], row["gentle_only_other"]) == (ours, theirs)
    p = stats.binomtest(int(min(ours, theirs)), int(ours + theirs)).pvalue
    assert row["gentle_p"] == pytest.approx(p, rel=1e-9)


def test_the_csv_is_the_table(whole, done):
    with (whole / "table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["method"] for row in rows] == [row["method"] for row in done.table]
    assert [float(row["gentle_low"]) for row in rows] == [row["gentle_low"] for row in done.table]


def test_the_best_is_marked(done):
    best = {row["method"]: row["best"].split(";") for row in done.table if row["law"] == "lugre"}
    assert "gentle_share" in best["follow"]
    assert "largest_jump_m_median" in best["follow"]
    assert "gentle_share" not in best["ramp"]
    assert best["weak & <slow>"] == [""]  # frees too few to be best in anything


def test_sentences_say_what_was_found(done):
    text = "\n".join(done.result)
    assert "follow (100 %) clearly frees most parts gently under every law" in text
    assert "ramp frees 0 % gently; it fails most often because of the jump, within its" in text
    assert re.search(r"weak & <slow> leaves [\d.]+ % of the parts in place after", text)
    assert [sentence for sentence in done.result if sentence.startswith("CAUTION")] == [
        "CAUTION: asked under one kind of variation (field) alone; --variations "
        "field,part,none,paper_random_factor shows what turns on it"
    ]


def test_too_few_parts_are_said_to_be_too_few(done):
    """Six comparisons need p < 0.0083, which no fewer than 8 parts can give."""
    rows = [{**row, "runs": 7} for row in done.table]
    said = sentences_of(done.asked, done.trials, rows)
    assert said[0] == (
        "too few parts to tell the methods apart: a difference with p < 0.0083 needs 8 parts that "
        "only one of two methods frees, and 7 were tried; raise --runs"
    )
    assert not any("clearly" in sentence for sentence in said if "CAUTION" not in sentence)
    enough = [{**row, "runs": 8} for row in done.table]
    assert not any("too few" in one for one in sentences_of(done.asked, done.trials, enough))


def test_no_limit_that_all_parts_keep_is_a_cause(done):
    """One law keeps every limit, the other frees half of the parts and keeps every limit."""
    kept = dict.fromkeys(("force_share", "jump_share", "velocity_share", "gentle_share"), 1.0)
    half = dict.fromkeys(kept, 0.5)
    rows = [
        row | (kept | {"released_share": 1.0} if row["law"] == "lugre" else half)
        | ({} if row["law"] == "lugre" else {"released_share": 0.5})
        for row in done.table
    ]  # fmt: skip
    said = sentences_of(done.asked, done.trials, rows)
    assert (
        "follow frees 50 to 100 % gently; it fails most often because of parts that stay in place "
        "under elasto_plastic, which are all but 50 % of the parts"
    ) in said
    assert not any("within its limit for 100 %" in sentence for sentence in said)


def test_a_conclusion_of_one_law_is_flagged(done):
    """Under one law of the two, both ways are made to do the same."""
    trials = {case: dict(by_method) for case, by_method in done.trials.items()}
    lugre = trials[Case("lugre", "field")]
    lugre["ramp"] = replace(lugre["follow"], method=done.asked.methods[1])
    said = sentences_of(done.asked, trials, table_of(trials, []))
    assert (
        "CAUTION, one law only: follow is gentler than ramp under elasto_plastic, not clearly "
        "under lugre"
    ) in said
    assert (
        "CAUTION: which method frees most parts gently depends on the friction law; do not rely on "
        "one law"
    ) in said
    assert any("clearly frees more parts gently than follow" in s for s in said)


def under_two_variations(done, alike):
    """Give what is said where ramp does what follow does in some of four cases."""
    asked = done.asked.model_copy(update={"variations": ["field", "none"]})
    trials = {case: dict(done.trials[Case(case.law, "field")]) for case in asked.cases}
    for law, variation in alike:
        found = trials[Case(law, variation)]
        found["ramp"] = replace(found["follow"], method=asked.methods[1])
    return sentences_of(asked, trials, table_of(trials, []))


def test_a_conclusion_of_one_variation_is_flagged(done):
    said = under_two_variations(done, [("lugre", "none"), ("elasto_plastic", "none")])
    assert (
        "CAUTION, one variation only: follow is gentler than ramp under every law with field, not "
        "clearly under every law with none"
    ) in said
    assert (
        "CAUTION: which method frees most parts gently depends on how friction varies; do not rely "
        "on one variation"
    ) in said
    assert not any("depends on the friction law" in s or "one kind of variation" in s for s in said)


def test_a_conclusion_of_one_law_with_one_variation_is_flagged(done):
    even = [("lugre", "none"), ("elasto_plastic", "field"), ("elasto_plastic", "none")]
    said = under_two_variations(done, even)
    assert (
        "CAUTION, one law and one variation only: follow is gentler than ramp under lugre with "
        "field, not clearly under lugre with none, elasto_plastic with field and elasto_plastic "
        "with none"
    ) in said
    assert sum("frees most parts gently depends on" in s for s in said) == 2


def test_what_holds_everywhere_is_not_flagged(done):
    said = under_two_variations(done, [])
    assert not any(s.startswith("CAUTION") for s in said)
    best = "follow (100 %) clearly frees most parts gently under every law with every variation"
    assert best in said


def test_every_law_is_asked_with_every_variation(inputs, tmp_path):
    population, methods = inputs
    done = bk.compare_methods(
        population, methods[:2], laws=["lugre", "gms"], variations=["part", "none"], runs=4,
        out=tmp_path / "out",
    )  # fmt: skip
    found = [(row["law"], row["variation"], row["method"]) for row in done.table]
    assert found == [
        (law, how, name) for law in ("lugre", "gms") for how in ("part", "none")
        for name in ("follow", "ramp")
    ]  # fmt: skip
    alone = bk.run_trial(
        done.asked.population, done.asked.methods[1], law="gms", variation="part", runs=4, seed=0
    )
    assert done.trial("gms", "ramp", variation="part") == alone
    assert done.row("gms", "ramp") == done.row("gms", "ramp", variation="part")
    pieces = ds.dataset(tmp_path / "out" / "pieces", format="parquet").to_table()
    assert set(pieces["variation"].to_pylist()) == {"part", "none"}
    page = (tmp_path / "out" / "index.html").read_text()
    assert "2 friction laws with 2 kinds of variation" in page
    assert "generalized Maxwell-slip, friction varies from part to part" in page
    file = tmp_path / "out" / "comparison.toml"
    assert bk.compare_methods(file, out=tmp_path / "out", resume=True) == done


def test_the_worst_part_replays_bit_for_bit(done):
    for trial in done.trials[Case("elasto_plastic", "field")].values():
        for row in (worst_row(trial), median_row(trial)):
            run = trial.replay(row)
            for name, values in trial.metrics.items():
                value = getattr(run.metrics, name)
                assert value == values[row] or (np.isnan(value) and np.isnan(values[row])), name


def test_the_worst_slip_has_the_largest_jump(done):
    for trial in done.trials[Case("lugre", "field")].values():
        run = trial.replay(worst_row(trial))
        start, end = worst_slip(run)
        x = run.trace["position_m"]
        assert x[end] - x[start] >= 0.98 * run.metrics.largest_jump_m
        course = course_of(trial, worst_row(trial))
        assert course.slip_s[1] > course.slip_s[0]
        assert course.whole["force_n"].max() == run.trace["applied_force_n"].max()


@pytest.mark.parametrize("name", ["steady_feed", "vibrated_feed"])
def test_a_feed_axis_tells_where_drive_tool_and_tip_are(name):
    population, method = bk.load_population("seized_parts"), bk.load_method(name)
    trial = bk.run_trial(population, method, runs=range(1), seed=0)
    course = course_of(trial, 0)
    stack = name == "vibrated_feed"
    assert ("tool_m" in course.whole, "tool_m" in course.slip) == (stack, stack)
    gap = course.whole["position_m"] - course.whole["tip_m"]
    assert gap[0] == method.actuator.contact.gap_m
    # k_c d within what the contact's damper adds, c_c times a speed of 10 mm/s
    pressed = course.slip["tip_m"] - course.slip["position_m"]
    np.testing.assert_allclose(course.slip["force_n"], 3e8 * pressed, atol=0.2 * 3e8 * 1e-5)
    ahead = course.whole["feed_m"] - course.whole.get("tool_m", course.whole["tip_m"])
    peak = np.argmax(course.whole["force_n"])
    assert ahead[peak] == pytest.approx(course.whole["force_n"][peak] / 3e7, rel=0.5)


def test_a_force_has_no_tip(done):
    course = course_of(done.trial("lugre", "ramp"), 0)
    assert set(course.whole) == {"t_s", "position_m", "force_n", "breakaway_n"}


def test_thinning_keeps_extremes_and_ends():
    values = np.sin(np.arange(100_000.0))
    values[777], values[99_990] = 5.0, -7.0
    rows = kept_rows(values, 100)
    assert len(rows) <= 102
    assert {0, 777, 99_990, 99_999} <= set(rows)
    assert (np.diff(rows) > 0).all()


def test_baselines_are_what_others_are_measured_by(inputs):
    population, methods = inputs
    done = bk.compare_methods(
        population, methods, laws="lugre", runs=3, baselines=["ramp", "weak & <slow>"]
    )
    assert {row["method"]: row["against"] for row in done.table}["follow"] in (
        "ramp",
        "weak & <slow>",
    )
    assert done.folder is None
    assert "under the law lugre alone" in done.notes[-1]


def test_one_method_alone_is_a_comparison(inputs):
    population, methods = inputs
    done = bk.compare_methods(population, [methods[2]], laws=["two_region"], runs=2)
    row = done.row("two_region", "weak & <slow>")
    assert (row["against"], row["gentle_p"], row["best"]) == (None, None, "")
    with pytest.raises(bk.StudyError, match=r"lugre, field, ramp: was not compared; the laws a"):
        done.row("lugre", "ramp")


def test_the_whole_comparison_reads_back(whole, done):
    again = bk.compare_methods(whole / "comparison.toml", runs=2)
    assert again.asked == done.asked.model_copy(update={"runs": 2})
    assert Asked.parse(json.loads(done.asked.model_dump_json())) == done.asked


def test_a_range_of_parts_is_these_parts(inputs, tmp_path):
    """Parts are functions of seed and number, so a range meets those that all of them would."""
    population, (method, *_) = inputs
    asked = {"methods": [method], "laws": ["lugre"]}
    whole = bk.compare_methods(population, **asked, runs=5).trial("lugre", "follow")
    done = bk.compare_methods(population, **asked, runs=range(2, 5), out=tmp_path / "out")
    some = done.trial("lugre", "follow")
    assert some.runs == range(2, 5)
    for name, values in whole.metrics.items():
        assert np.array_equal(some.metrics[name], values[2:], equal_nan=True)
    assert bk.compare_methods(tmp_path / "out" / "comparison.toml").asked == done.asked


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"laws": ["lugr"]}, "laws: 'lugr' is not one of .*; did you mean 'lugre'?"),
        ({"laws": []}, "laws: "),
        ({"laws": ["gms", "gms"]}, "laws: 'gms' is given twice"),
        (
            {"variations": ["fields"]},
            "variations: 'fields' is not one of .*; did you mean 'field'?",
        ),
        ({"variations": ["part", "part"]}, "variations: 'part' is given twice"),
        ({"runs": 0}, "runs: 0 is not >= 1"),
        ({"seed": -1}, "seed: -1 is not >= 0"),
        ({"methods": []}, "methods: "),
        ({"methods": ["none"]}, "none: is neither a file nor a preset; presets: "),
        ({"baselines": ["none"]}, "baselines: 'none' is not one of follow, ramp, weak"),
        ({"threads": 0}, "threads: 0 is not a whole number >= 1"),
        ({"population": "none"}, "none: is neither a file nor a preset"),
    ],
)
def test_what_makes_no_sense_is_refused(inputs, tmp_path, changes, words):
    population, methods = inputs
    asked = {"population": population, "methods": methods, "out": tmp_path / "out", **changes}
    with pytest.raises(bk.BreakawayError, match=words) as error:
        bk.compare_methods(**asked)
    assert error.value.exit_code == 2
    assert not (tmp_path / "out").exists()


def test_the_same_method_twice_is_refused(inputs):
    population, methods = inputs
    with pytest.raises(bk.StudyError, match="methods: 'ramp' is given twice; give each once"):
        bk.compare_methods(population, [methods[1], methods[1]])
