"""The same question under every friction law: what they agree on, what only one of them says."""

import json

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.studies import load_study, open_study, run_study
from breakaway.ask.studies.agreement import bisected, narrowed
from breakaway.ask.studies.agreement_study import certain_under
from breakaway.ask.studies.files import parse_study
from breakaway.ask.studies.plans import plan_of
from breakaway.ask.studies.statistics import mcnemar
from breakaway.ask.studies.verdicts import (
    compared,
    compared_shares,
    conclusion_of,
    direction_of,
    in_words,
    verdict_of,
)
from breakaway.cli.app import app
from breakaway.drawing.style import COLORS
from breakaway.errors import StudyError
from breakaway.model.scenario.laws import joint_under
from breakaway.show.plots.study import plot_agreement

LAWS = ["lugre", "elasto_plastic", "gms", "coulomb_stiction"]
LENGTH_M = 0.002
PUSH = {"kind": "force_ramp", "rate_n_per_s": 5e4, "travel_m": LENGTH_M}
PULSES = {
    "kind": "fm_vibration",
    "pid": {
        "gains": {"kind": "given", "kp_n_per_m": 1e6, "ki_n_per_m_s": 0.0, "kd_n_s_per_m": 0.0},
        "anti_windup": "conditional",
    },
    "vibration": {
        "frequency_min_hz": 100.0,
        "frequency_max_hz": 100.0,
        "error_full_scale_m": 1e-3,
        "pulse_width_s": 5e-3,
        "shape": "rectangular",
    },
}
VIBRATED = [{"name": "constant"}, {"name": "pulses", "changes": {"controller": PULSES}}]
FORCES = [
    {"name": "weak"},
    {"name": "strong", "changes": {"actuator": {"force_max_n": 600.0}}},
]
NORMAL = {"distribution": "normal", "mean": 450.0, "std": 20.0}
SEARCH = {"over": "actuator.force_max_n", "low": 300.0, "high": 600.0, "resolution": 20.0}


@pytest.fixture(scope="module")
def short():
    """Give a joint of 450 N with a short guide, under a constant push of 360 N."""
    return bk.load_scenario("paper_as_computed").with_(
        {"joint.engagement_length_m": LENGTH_M},
        reference={"kind": "step", "distance_m": 0.02},
        actuator={"kind": "push_only", "force_max_n": 360.0},
        controller=PUSH,
        timing={"duration_s": 0.2, "control_period_s": 5e-5},
        limits={"diverged_error_m": 1.0, "after_release_s": 0.0},
    )


@pytest.fixture(autouse=True)
def no_figures(monkeypatch, request):
    """Leave figures out, which take longer than the studies."""
    if request.node.name != "test_the_command_shows_it":
        monkeypatch.setattr("breakaway.ask.studies.running._save", lambda *_: None)


def study_of(scenario, runs=1, agreement=None, variants=FORCES, **values):
    table = {"variants": variants, **(agreement or {})}
    return parse_study(
        {"kind": "agreement", "scenario": scenario, "runs": runs, "agreement": table, **values}
    )


def verdicts(done):
    return {row["quantity"]: row["verdict"] for row in done.summary["tables"]["conclusions"]}


# What is concluded


def test_laws_agree_that_a_force_above_breakaway_frees(tmp_path, short):
    done = run_study(study_of(short, metrics=["peak_force_n"]), out=tmp_path)
    assert verdicts(done) == {"released": "agreed", "peak_force_n": "agreed"}
    assert [row["direction"] for row in done.summary["tables"]["laws"]] == ["higher"] * 8
    assert done.summary["result"][0] == (
        "agreed: strong releases more often than weak [lugre +100 %, elasto_plastic +100 %, gms "
        "+100 %, coulomb_stiction +100 %]"
    )
    assert done.summary["certain"] is True


def test_only_lugre_drifts_out_below_breakaway(tmp_path, short):
    """Pulses of 80 % of F_s0 free a part in LuGre, which drifts, and in no other law."""
    agreement = {"relevant": {"final_position_m": 1e-4}}
    study = study_of(short, 1, agreement, VIBRATED, metrics=["final_position_m"])
    done = run_study(study, out=tmp_path)
    assert verdicts(done) == {"released": "only lugre", "final_position_m": "only lugre"}
    assert done.summary["result"][0].startswith(
        "only lugre: pulses releases more often than constant, and nothing else that was asked "
        "shows it: it may be a property of this model only"
    )
    conclusion = done.summary["tables"]["conclusions"][0]
    assert (conclusion["said_by"], conclusion["shown_by_all"]) == ("lugre", None)


def test_parts_and_draws_are_the_same_under_every_law(tmp_path, short):
    """What a law has no place for is drawn all the same, so that the rest stays paired."""
    vary = {
        "joint.stiffness_n_per_m": {"distribution": "uniform", "low": 3e7, "high": 3.6e7},
        "joint.stiction_n": NORMAL,
    }
    done = run_study(study_of(short, 8, vary=vary, metrics=["peak_force_n"]), out=tmp_path)
    table = done.to_pandas()
    grouped = table.groupby(["law", "variant"])["joint.stiction_n"].apply(tuple)
    assert len(grouped) == 8
    assert len(set(grouped)) == 1
    rigid = table.law == "coulomb_stiction"
    assert table["joint.stiffness_n_per_m"].isna().equals(rigid)
    for point in (0, 6):
        again = done.replay(point, 3)
        row = table[(table.point == point) & (table.run_index == 3)].iloc[0]
        assert again.metrics.peak_force_n == row.peak_force_n
        assert again.scenario.joint.law == row.law


def test_a_controller_does_not_know_the_law():
    study = study_of("paper_as_computed", variants=[
        {"name": "usual"}, {"name": "damped", "changes": {"controller.gains.damping_ratio": 1.2}}
    ], agreement={"laws": ["lugre", "two_region", "coulomb_stiction"]})  # fmt: skip
    gains = {
        (name, scenario.controller.gains.kp_n_per_m)
        for (_, _, name), scenario in study.scenarios.items()
    }
    assert len(gains) == 2
    nominal = bk.resolve(bk.load_scenario("paper_as_computed")).controller.gains
    assert ("usual", nominal.kp_n_per_m) in gains


# The smallest sufficient level


def test_rigid_friction_needs_its_stiction(tmp_path, short):
    """Under Coulomb friction the smallest force is the first level above each part's F_s0."""
    agreement = {"smallest": SEARCH, "laws": ["coulomb_stiction", "gms"]}
    variants = [{"name": "light"}, {"name": "heavy", "changes": {"part.mass_kg": 2.0}}]
    study = study_of(short, 12, agreement, variants, vary={"joint.stiction_n": NORMAL})
    done = run_study(study, out=tmp_path)
    assert verdicts(done) == {"smallest actuator.force_max_n": "agreed"}
    row = done.summary["tables"]["smallest"][0]
    drawn = bk.draw_columns(study.vary, range(12), seed=0)["joint.stiction_n"]
    needed = 300.0 + 20.0 * np.ceil((drawn - 300.0) / 20.0)
    assert (row["law"], row["median"]) == ("coulomb_stiction", np.median(needed))
    assert (row["at_lowest"], row["above_highest"]) == (0, 0)
    tried = done.to_pandas()
    assert set(tried["actuator.force_max_n"]) <= set(np.arange(300.0, 601.0, 20.0))
    assert len(tried) == done.summary["runs"] == plan_of(study).runs_max


def test_levels_out_of_reach_are_told(tmp_path, short):
    agreement = {"smallest": SEARCH | {"high": 400.0}, "laws": ["lugre", "gms"]}
    variants = [{"name": "light"}, {"name": "heavy", "changes": {"part.mass_kg": 2.0}}]
    done = run_study(study_of(short, 1, agreement, variants), out=tmp_path)
    assert [row["above_highest"] for row in done.summary["tables"]["smallest"]] == [1] * 4
    assert any("4 runs need more than the highest level 400" in n for n in done.summary["notes"])


def test_a_disturbance_of_the_joint_force_moves_what_lugre_holds(tmp_path, short):
    """110 N move a part of 450 N in 4 s; with the disturbance on g alone nothing does."""
    agreement = {
        "laws": ["lugre", "gms"],
        "disturbances": ["joint_force", "friction_level"],
        "smallest": {
            "over": "actuator.force_max_n", "low": 100.0, "high": 600.0, "resolution": 50.0,
            "until": "loose",
        },
    }  # fmt: skip
    variants = [{"name": "still"}, {"name": "disturbed", "changes": {"disturbance.var": 0.3}}]
    scenario = short.with_({"limits.breakaway_travel_m": 2e-4})
    done = run_study(study_of(scenario, 6, agreement, variants), out=tmp_path)
    rows = {(r["law"], r["disturbance"]): r for r in done.summary["tables"]["laws"]}
    assert rows["lugre", "joint_force"]["difference_high"] <= -150.0
    assert rows["lugre", "friction_level"]["direction"] == "same"
    conclusion = done.summary["tables"]["conclusions"][0]
    assert conclusion["verdict_joint_force"] != conclusion["verdict_friction_level"]
    assert any("jolts it at every redraw" in note for note in done.summary["notes"])


# How friction varies

ASKED = ["joint_force", "friction_level", "field", "part", "none"]
DISTURBED = {"disturbance": {"var": 0.3, "hold_s": 2e-3}}


def disturbances_of(scenario, asked=ASKED, **table):
    study = study_of(scenario, 8, {"disturbances": asked, "laws": ["lugre", "gms"], **table})
    return {how: s.disturbance for (law, how, name), s in study.scenarios.items()
            if (law, name) == ("gms", "weak")}  # fmt: skip


def test_a_random_factor_becomes_what_is_asked(short):
    found = disturbances_of(short.with_(**DISTURBED), correlation_length_m=1e-4)
    redrawn = bk.UniformDisturbance(var=0.3, hold_s=2e-3)
    assert found == {
        "joint_force": redrawn,
        "friction_level": redrawn.model_copy(update={"acts_on": "friction_level"}),
        "field": bk.FieldDisturbance(var=0.3, correlation_length_m=1e-4),
        "part": bk.UniformDisturbance(var=0.3, hold_s=0.2, acts_on="friction_level"),
        "none": bk.UniformDisturbance(),
    }


def test_a_field_becomes_what_is_asked(short):
    own = bk.FieldDisturbance(law="log_normal", var=0.2, correlation_length_m=3e-4)
    found = disturbances_of(short.with_(disturbance=own))
    assert found["field"] == own
    assert found["joint_force"] == bk.UniformDisturbance(var=0.2, hold_s=1e-3)
    assert found["part"] == bk.UniformDisturbance(var=0.2, hold_s=0.2, acts_on="friction_level")


def test_a_factor_that_is_held_for_the_whole_run_is_one_of_the_part(tmp_path, short):
    """Rigid friction with a factor held: the smallest force is 450 N times one number."""
    variants = [{"name": "light"}, {"name": "heavy", "changes": {"part.mass_kg": 2.0}}]
    agreement = {
        "disturbances": ["part", "none"],
        "laws": ["coulomb_stiction", "two_region"],
        "smallest": SEARCH | {"resolution": 1.0},
    }
    done = run_study(study_of(short.with_(**DISTURBED), 12, agreement, variants), out=tmp_path)
    rows = {(r["law"], r["disturbance"]): r for r in done.summary["tables"]["smallest"]}
    still, held = (rows["coulomb_stiction", how] for how in ("none", "part"))
    assert (still["p05"], still["p95"]) == (451.0, 451.0)
    assert 315.0 <= held["p05"] < 400.0 and 500.0 < held["p95"] <= 586.0


def test_what_is_not_drawn_is_certain(short):
    scenario = short.with_(**DISTURBED)
    both = study_of(scenario, 8, {"disturbances": ["none", "field"], "laws": ["lugre", "gms"]})
    assert certain_under(both, "gms", "none") and not certain_under(both, "gms", "field")
    assert not both.certain
    alone = {"disturbances": ["none"], "laws": ["lugre", "gms"]}
    assert study_of(scenario, 1, alone).certain
    vary = {"disturbance.var": {"distribution": "uniform", "low": 0.1, "high": 0.3}}
    assert study_of(scenario, 1, alone, vary=vary).certain
    with pytest.raises(StudyError, match=r"all be the same, .*agreement\.disturbances is none"):
        study_of(scenario, 8, alone, vary=vary)
    with pytest.raises(StudyError, match="give 6 or more"):
        study_of(scenario, 1, {"disturbances": ["part"], "laws": ["lugre", "gms"]})


def test_what_means_nothing_is_drawn_and_left_out(tmp_path, short):
    vary = {
        "disturbance.var": {"distribution": "uniform", "low": 0.1, "high": 0.3},
        "disturbance.hold_s": {"distribution": "uniform", "low": 1e-3, "high": 3e-3},
        "joint.stiction_n": NORMAL,
    }
    agreement = {"disturbances": ASKED, "laws": ["lugre", "gms"]}
    study = study_of(short.with_(**DISTURBED), 6, agreement, vary=vary, metrics=["peak_force_n"])
    done = run_study(study, out=tmp_path)
    table = done.to_pandas()
    left_out = {
        how: {path for path in vary if rows[path].isna().all()}
        for how, rows in table.groupby("disturbance")
    }
    assert left_out == {
        "joint_force": set(),
        "friction_level": set(),
        "field": {"disturbance.hold_s"},
        "part": {"disturbance.hold_s"},
        "none": {"disturbance.hold_s", "disturbance.var"},
    }
    drawn = table.groupby(["law", "disturbance", "variant"])["joint.stiction_n"].apply(tuple)
    assert len(set(drawn)) == 1
    again = done.replay(0, 3)
    assert again.metrics.peak_force_n in set(table[table.point == 0]["peak_force_n"])


def test_a_study_that_was_run_runs_again_to_the_same_bytes(tmp_path, short):
    variants = [
        VIBRATED[0],
        {"name": "pulses", "changes": {"controller": bk.FmVibration(**PULSES)}},
    ]
    study = study_of(short, 1, {"laws": ["lugre", "gms"]}, variants, metrics=["peak_force_n"])
    run_study(study, out=tmp_path / "one")
    run_study(load_study(tmp_path / "one" / "study.toml"), out=tmp_path / "two")
    for name in ("manifest.json", "summary.json", "study.toml", "pieces/piece-000000.parquet"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


@pytest.mark.parametrize("count", [1, 2, 31, 33, 700])
def test_searches_find_the_first_place(count):
    need = np.arange(count + 1)

    def passes(_, places):
        assert places.min() >= 0
        assert places.max() < count
        return places >= need.reshape(-1, 1)

    np.testing.assert_array_equal(narrowed(count, count + 1, passes).ravel(), need)
    np.testing.assert_array_equal(bisected(count, (count + 1, 1), passes).ravel(), need)


# Files


def test_what_is_interrupted_goes_on_to_the_same_bytes(tmp_path, short):
    agreement = {"smallest": SEARCH | {"resolution": 60.0}, "laws": ["lugre", "gms"]}
    study = study_of(
        short, 6, agreement, vary={"joint.stiction_n": NORMAL}, runs_per_piece=16,
        variants=[{"name": "light"}, {"name": "heavy", "changes": {"part.mass_kg": 2.0}}],
        metrics=["peak_force_n"],
    )  # fmt: skip
    whole = tmp_path / "whole"
    run_study(study, out=whole, threads=2)

    def stop(at):
        if at.runs_done >= 40:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(study, out=tmp_path / "again", progress=stop)
    assert not open_study(tmp_path / "again").finished
    run_study(study, out=tmp_path / "again", resume=True, threads=1)
    files = [p.relative_to(whole) for p in whole.rglob("*") if p.is_file() and p.name != ".lock"]
    assert len([name for name in files if name.suffix == ".parquet"]) > 3
    for name in files:
        assert (whole / name).read_bytes() == (tmp_path / "again" / name).read_bytes(), name
    assert open_study(whole).study == study


@pytest.mark.slow
def test_the_command_shows_it(tmp_path, short):
    from typer.testing import CliRunner

    bk.save_scenario(short, tmp_path / "short.toml")
    (tmp_path / "study.toml").write_text(
        'kind = "agreement"\nscenario = "short.toml"\nruns = 1\nmetrics = ["peak_force_n"]\n'
        '[agreement]\nlaws = ["lugre", "gms"]\n'
        "[agreement.smallest]\n"
        'over = "actuator.force_max_n"\nlow = 300.0\nhigh = 600.0\nresolution = 30.0\n'
        '[[agreement.variants]]\nname = "light"\n'
        '[[agreement.variants]]\nname = "heavy"\nchanges = { part.mass_kg = 2.0 }\n'
    )
    out = tmp_path / "out"
    shown = CliRunner().invoke(app, ["study", str(tmp_path / "study.toml"), "--out", str(out)])
    assert shown.exit_code == 0, shown.output
    summary = json.loads((out / "summary.json").read_text())
    for sentence in summary["result"]:
        assert sentence in shown.output
    names = {path.name for path in out.iterdir() if path.suffix in (".csv", ".png")}
    assert names == {
        "conclusions.csv", "laws.csv", "variants.csv", "smallest.csv", "agreement.png"
    }  # fmt: skip


def test_the_figure_flags_what_only_one_law_says():
    names = {"other": "b", "first": "a", "quantity": "peak_force_n", "disturbance": "joint_force"}
    keys = ("difference", "difference_low", "difference_high", "relative", "relative_low",
            "relative_high")  # fmt: skip
    laws = [
        names | {"law": "lugre", "pairs": 9, "direction": "lower"} | dict.fromkeys(keys, -0.2),
        names | {"law": "gms", "pairs": 0, "direction": "undecided"} | dict.fromkeys(keys),
    ]
    figure = plot_agreement("f", [names | {"verdict": "only lugre"}], laws)
    axes = figure.axes[0]
    assert axes.get_title(loc="left") == "only LuGre"
    assert axes._left_title.get_color() == COLORS["alarm"]
    assert [t.get_text() for t in axes.get_yticklabels()] == ["LuGre", "generalized Maxwell-slip"]
    assert [t.get_text() for t in axes.texts] == ["no pairs"]


# Verdicts


def test_directions():
    assert direction_of(None, None, 1.0) == "undecided"
    assert direction_of(0.0, 0.0, 0.0) == "same"
    assert direction_of(1.0, 2.0, 0.0) == "higher"


@pytest.mark.parametrize(
    ("said", "verdict"),
    [
        (["lower", "lower", "lower"], "agreed"),
        (["same", "same", "same"], "agreed"),
        (["undecided", "undecided", "undecided"], "undecided"),
        (["same", "undecided", "same"], "undecided"),
        (["lower", "same", "same"], "only lugre"),
        (["undecided", "undecided", "higher"], "only gms"),
        (["lower", "lower", "same"], "contradicted"),
        (["lower", "undecided", "higher"], "contradicted"),
    ],
)
def test_verdicts(said, verdict):
    laws = [(law, "joint_force") for law in ("lugre", "elasto_plastic", "gms")]
    assert verdict_of(dict(zip(laws, said, strict=True))) == verdict


def test_verdicts_over_disturbances():
    both = [(law, acts) for law in ("lugre", "gms") for acts in ("joint_force", "friction_level")]
    said = dict(zip(both, ["lower", "same", "lower", "undecided"], strict=True))
    assert verdict_of(said) == "only joint_force"
    assert verdict_of(said | {("gms", "joint_force"): "same"}) == "only lugre with joint_force"


def test_a_verdict_names_what_is_redrawn_in_time():
    cases = [(law, how) for law in ("lugre", "gms") for how in ASKED]
    redrawn = ["lower", "lower", "same", "undecided", "same"]
    assert verdict_of(dict(zip(cases, redrawn * 2, strict=True))) == "only redrawn in time"
    of_lugre = verdict_of(dict(zip(cases, redrawn + ["undecided"] * 5, strict=True)))
    assert of_lugre == "only lugre with redrawn in time"
    field = ["same", "same", "lower", "same", "same"]
    assert verdict_of(dict(zip(cases, field * 2, strict=True))) == "only field"


def test_a_conclusion_says_that_it_turns_on_the_variation():
    keys = ("difference", "difference_low", "difference_high", "relative", "relative_low",
            "relative_high")  # fmt: skip
    names = {"other": "b", "first": "a", "quantity": "peak_force_n"} | dict.fromkeys(keys, -0.2)
    rows = [
        names | {"law": law, "disturbance": how, "direction": way}
        for law in ("lugre", "gms") for how, way in (("field", "lower"), ("none", "same"))
    ]  # fmt: skip
    conclusion = conclusion_of(rows)
    assert (conclusion["verdict"], conclusion["turns_on"]) == ("only field", "disturbance")
    assert "; it turns on how friction varies [lugre with field -20 %" in in_words(conclusion, rows)


@pytest.mark.parametrize("gained", range(9))
def test_shares_differ_exactly_where_mcnemar_says_so(gained):
    before = np.repeat([0.0, 1.0, 1.0], [gained, 8 - gained, 4])
    after = np.repeat([1.0, 0.0, 1.0], [gained, 8 - gained, 4])
    row = compared_shares(before, after, 0.95, 0.0, certain=False)
    assert (row["direction"] in ("lower", "higher")) == (mcnemar(8 - gained, gained) < 0.05)
    assert row["difference_low"] <= row["difference"] <= row["difference_high"]


def test_what_is_not_there_is_not_compared():
    nan = np.full(8, np.nan)
    row = compared(nan, np.ones(8), 0.95, 0.0, certain=False)
    assert (row["pairs"], row["difference"], row["direction"]) == (0, None, "undecided")


# Errors

RUNS = {"runs": 1}
WRONG = [
    ({"laws": ["lugre"]}, {}, "agreement.laws: 'lugre' alone cannot disagree; give two or more"),
    ({"laws": ["lugre", "lugre"]}, {}, "agreement.laws: 'lugre' is given twice"),
    ({"laws": ["lugre", "lurge"]}, {}, "'lurge' is not one of"),
    ({"variants": FORCES[:1]}, {}, "variants: 1 is not a comparison; give two or more"),
    ({"variants": [FORCES[0], FORCES[0]]}, {}, "variants: 'weak' is given twice"),
    ({"variants": [FORCES[0], {"name": "twin"}]}, {}, "'weak' and 'twin' are the same"),
    ({"variants": [FORCES[0], {"name": "b", "changes": {"joint.law": "gms"}}]}, {},
     "joint.law is the same for all variants; name laws in agreement.laws"),
    ({"variants": [FORCES[0], {"name": "b", "changes": {"seed": 3}}]}, {}, "cannot change seed"),
    ({"variants": [FORCES[0], {"name": "b", "changes": {"part.mas_kg": 3.0}}]}, {},
     "agreement.variants.b.changes: part.mas_kg: is not a known key; did you mean mass_kg?"),
    ({"numbers": {"gms": {"elements": 3}}}, {},
     "agreement.numbers.gms.elements: 3 is not >= 4"),
    ({"numbers": {"gms": {"elemnts": 5}}}, {}, "did you mean elements?"),
    ({"numbers": {"two_region": {}}}, {}, "numbers.two_region: is not one of the laws"),
    ({"relevant": {"peak_forc_n": 1.0}}, {}, "agreement.relevant: 'peak_forc_n' is not a metric"),
    ({"relevant": {"released": -1.0}}, {}, "-1.0 is not >= 0"),
    ({"disturbances": ["joint_force", "friction_level"]}, {}, "disturbance.var is 0 in every"),
    ({"disturbances": ["friction_level"], "variants": [
        FORCES[0], {"name": "b", "changes": {"disturbance": {"acts_on": "joint_force"}}}]}, {},
     "disturbance.acts_on is also in agreement.disturbances; leave one out"),
    ({"disturbances": ["field"], "variants": [
        FORCES[0], {"name": "b", "changes": {"disturbance": {"kind": "field", "var": 0.1,
                                                             "correlation_length_m": 1e-3}}}]}, {},
     "disturbance.kind is also in agreement.disturbances; leave one out"),
    ({"disturbances": ["fields"]}, {}, "'fields' is not one of 'joint_force', 'friction_level'"),
    ({"disturbances": ["field"], "correlation_length_m": 0.0}, {}, "0.0 is not >= 1e-06"),
    ({"disturbances": ["none"], "smallest": SEARCH | {"over": "disturbance.var", "low": 0.1,
                                                     "high": 0.3, "resolution": 0.1}}, {},
     "disturbance.var means nothing where agreement.disturbances has 'none'; leave one out"),
    ({}, {"runs": 9}, "runs: 9 runs of each variant would all be the same"),
    ({}, {"runs": 5, "vary": {"joint.stiction_n": NORMAL}}, "give 6 or more"),
    ({}, {"runs": 9, "vary": {"actuator.force_max_n": NORMAL}}, "force_max_n is also in vary"),
    ({"smallest": SEARCH}, {}, "actuator.force_max_n is sought in agreement.smallest"),
    ({"smallest": SEARCH | {"over": "part.mass"}}, {},
     "agreement.smallest.over: (weak, lugre) part.mass: is not a number of the scenario"),
    ({"smallest": SEARCH | {"over": "joint.stiffness_n_per_m"}}, {},
     "(weak, coulomb_stiction) joint.stiffness_n_per_m: is not a number"),
    ({"smallest": SEARCH | {"low": -1.0, "over": "part.mass_kg"}}, {},
     "agreement.smallest.low: (weak, lugre): part.mass_kg: -1.0 is not > 0"),
    ({"smallest": SEARCH | {"low": 700.0}}, {}, "low: 700.0 is not < high = 600.0; swap them"),
    ({"smallest": SEARCH | {"until": "free"}}, {}, "until: 'free' is not one of"),
]  # fmt: skip


@pytest.mark.parametrize(("table", "values", "words"), WRONG, ids=[w[2][:40] for w in WRONG])
def test_a_contradiction_is_explained(short, table, values, words):
    with pytest.raises(StudyError) as error:
        study_of(short, **RUNS | values, agreement=table)
    assert words in str(error.value)


def test_a_law_that_lacks_a_number_says_which(short):
    rigid = bk.CoulombStiction(
        stiction_n=450, coulomb_n=360, stribeck_velocity_m_per_s=0.09, engagement_length_m=LENGTH_M
    )
    words = r"agreement\.numbers\.lugre\.stiffness_n_per_m: is missing; give a number > 0"
    with pytest.raises(StudyError, match=words):
        study_of(short.with_(joint=rigid))
    given = {"stiffness_n_per_m": 3.6e7, "damping_n_s_per_m": 9000.0}
    assert joint_under("lugre", rigid, given) == bk.load_scenario(
        "paper_as_computed"
    ).joint.model_copy(update={"engagement_length_m": LENGTH_M})
