"""An advice says what its trials say, part by part; and what it rests on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import breakaway as bk
from breakaway.ask.advice.advising import not_judged
from breakaway.ask.advice.outcome import Bounds, outcome_of
from breakaway.ask.advice.parts import at_rig, parts_of, with_guide
from breakaway.ask.advice.ranking import difference
from breakaway.ask.advice.trying import FIRST_JUDGED, TRAINING, _rounds
from breakaway.ask.advice.ways import ways_of
from breakaway.ask.advice.worth import _gain, _worth_of_law, worths

pytestmark = pytest.mark.slow

SEIZED = bk.load_population("seized_parts")
ROOT = Path(__file__).parents[2]


def test_the_same_call_gives_the_same_bits_on_any_threads(
    advice: bk.Advice, population: bk.PartPopulation, limits: bk.HarmLimits
) -> None:
    again = bk.advise(
        population, "fast_force", limits, budget_s=1e6, parts_max=48, seed=1, threads=1
    )
    assert again.to_dict() == advice.to_dict()
    assert again.sentences == advice.sentences


def test_a_share_is_that_of_trials_made_one_by_one(
    advice: bk.Advice, population: bk.PartPopulation
) -> None:
    """Every limit is applied here by hand to the metrics of single trials."""
    rig = advice.bounds.rig
    for row in advice.ranking:
        trial = bk.run_trial(
            at_rig(population, rig),
            advice.tried.chosen[row.way],
            law=row.law,
            runs=range(FIRST_JUDGED, FIRST_JUDGED + 48),
            seed=1,
        )
        m = trial.metrics
        spared = 0
        for i in range(48):
            is_out = np.isfinite(m["time_to_release_s"][i])
            stress_pa = m["peak_force_n"][i] / 1e-5
            on_host_pa = m["peak_force_n"][i] / 4e-5
            spared += bool(
                is_out
                and m["peak_force_n"][i] <= rig.force_max_n
                and stress_pa <= 2e8
                and on_host_pa <= 1e8
                and m["largest_jump_m"][i] <= 2.5e-4
                and m["release_velocity_m_per_s"][i] <= 0.2
            )
        assert row.unharmed == spared / 48
        assert row.unharmed == min(row.by_law.values())


def test_the_best_stands_first_and_is_the_method_that_is_given(
    advice: bk.Advice, population: bk.PartPopulation
) -> None:
    shares = [row.unharmed for row in advice.ranking]
    assert shares == sorted(shares, reverse=True)
    assert {row.way for row in advice.ranking} == {
        way.name for way in ways_of(advice.bounds.rig, population)
    }
    assert advice.method.controller == advice.tried.chosen[advice.best.way].controller
    assert advice.best.setting in advice.sentences[0]
    assert f"{100 * advice.best.unharmed:.3g} %" in advice.sentences[0]


def test_a_difference_counts_parts_that_one_way_alone_spares(advice: bk.Advice) -> None:
    best, second = advice.ranking[:2]
    found = difference(advice.tried, best, second)
    one, other = (advice.tried.outcomes[best.law][row.way].unharmed for row in (best, second))
    pairs = list(zip(one.tolist(), other.tolist(), strict=True))
    assert found.only_best == pairs.count((True, False))
    assert found.only_second == pairs.count((False, True))
    assert advice.difference == found


def test_settings_are_chosen_on_other_parts_than_are_judged() -> None:
    judged = list(_rounds(100))
    assert [len(one) for one in judged] == [16, 16, 32, 36]
    assert judged[0].start == FIRST_JUDGED and judged[-1].stop == FIRST_JUDGED + 100
    assert TRAINING.stop <= FIRST_JUDGED


def test_a_rig_that_is_too_weak_or_too_short_frees_nothing(
    population: bk.PartPopulation, limits: bk.HarmLimits
) -> None:
    rig = bk.load_rig("screw_jack")
    method = ways_of(rig, population)[0].settings[0]
    trial = bk.run_trial(at_rig(population, rig), method, runs=16, seed=1)
    assert outcome_of(trial, Bounds(limits, population.gentle, rig)).freed.all()
    for change in ({"force_max_n": 1.0}, {"stroke_m": 1e-3}):
        weak = rig.model_copy(update=change)
        found = outcome_of(trial, Bounds(limits, population.gentle, weak))
        assert not found.freed.any() and not found.unharmed.any()


def test_without_limits_those_of_the_population_count_and_it_says_assumed(
    population: bk.PartPopulation,
) -> None:
    found = bk.advise(population, "screw_jack", budget_s=1e6, parts_max=16, seed=2)
    trial = bk.run_trial(
        at_rig(population, found.bounds.rig),
        found.method,
        law=found.best.law,
        runs=range(FIRST_JUDGED, FIRST_JUDGED + 16),
        seed=2,
    )
    assert found.best.unharmed == trial.within(population.gentle).mean()
    assert any("assumed, no limits file stated" in line for line in found.rests_on)


def test_what_the_rig_does_not_read_is_not_used() -> None:
    rig = bk.load_rig("fast_force")
    blind = rig.model_copy(update={"reads": ()})
    assert rig.actuator.kind == "force" and "position" in rig.reads
    assert "timed_impacts" in {way.name for way in ways_of(rig, SEIZED)}
    assert "timed_impacts" not in {way.name for way in ways_of(blind, SEIZED)}
    assert "vibrated_feed" not in {
        way.name
        for way in ways_of(bk.load_rig("piezo_tip").model_copy(update={"reads": ()}), SEIZED)
    }
    assert "vibrated_feed" in {way.name for way in ways_of(bk.load_rig("piezo_tip"), SEIZED)}


@pytest.mark.parametrize("name", bk.preset_names("rigs"))
def test_every_rig_has_a_way_and_sources(name: str) -> None:
    rig = bk.load_rig(name)
    assert rig.name == name and rig.description and rig.sources
    assert ways_of(rig, SEIZED)


def test_what_has_no_model_is_named() -> None:
    names = {one.name for one in not_judged()}
    assert len(names) >= 5
    for one in not_judged():
        assert one.what and one.why and one.source


def test_knowing_what_decides_is_worth_what_it_spares() -> None:
    """Two ways, each of which spares one half of the parts by q alone: to know q spares all."""
    q = np.arange(400.0)
    spared = np.array([q < 200.0, q >= 200.0]).astype(float)
    groups = np.array_split(np.argsort(q), 4)
    assert _gain(groups, spared) == 0.5
    assert _gain([np.arange(0, 400, 2), np.arange(1, 400, 2)], spared) == 0.0


def test_knowing_the_law_is_worth_what_it_decides() -> None:
    """Under each of two laws another way spares all parts; with like laws there is nothing."""
    ones, none = np.ones(200), np.zeros(200)
    found = _worth_of_law(np.array([[ones, none], [none, ones]]))
    assert 0.4 < found.gain <= 0.5 and found.is_clear
    alike = _worth_of_law(np.array([[ones, none], [ones, none]]))
    assert alike.gain == 0.0 and not alike.is_clear


def test_knowing_what_decides_nothing_is_worth_nothing(advice: bk.Advice) -> None:
    for one in worths(advice.tried):
        assert 0.0 <= one.gain <= 1.0
    if len({row.unharmed for row in advice.ranking}) > 1 and advice.best.unharmed == 1.0:
        assert all(one.gain == 0.0 for one in advice.worths)


def test_parts_that_no_pull_spares_are_counted(population: bk.PartPopulation) -> None:
    weak = bk.HarmLimits(stresses=[bk.StressLimit(place="n", section_m2=1e-6, allowed_pa=5e8)])
    found = bk.advise(population, "screw_jack", weak, budget_s=1e6, parts_max=16)
    share = np.mean(found.tried.quantities["stiction_n"] > 500.0)
    words = f"{100 * share:.2g} % of the parts take more than 500 N"
    assert any(words in sentence for sentence in found.sentences)
    assert found.best.unharmed <= 1.0 - share


def test_a_joint_file_gives_its_draws_and_assumes_the_rest(joint_file: bk.JointFile) -> None:
    parts = parts_of(joint_file)
    draws = joint_file.draws
    assert draws is not None
    drawn = bk.draw_parts(parts.population, 500, seed=0)
    coulomb = np.sort(np.unique(drawn["stiction_n"] / drawn["stiction_ratio"]))
    known = np.asarray(draws.values["joint.coulomb_n"])
    assert np.abs(coulomb[:, None] / known[None, :] - 1.0).min(axis=1).max() < 1e-9
    assert "stiction_n" in parts.told and "correlation_length_m" in parts.assumed
    assert set(parts.told).isdisjoint(parts.assumed)
    assert any("log " in line for line in parts.provenance)


def test_a_pull_tells_its_forces_and_the_rest_is_called_assumed() -> None:
    log = bk.read_log(ROOT / "examples/10_from_pull_to_report/part_1.csv")
    parts = parts_of(bk.joint_from_pull(log, mass_kg=2.0))
    assert parts.told == ("stiction_n", "stiction_ratio", "mass_kg")
    assert {"presliding_m", "bristle_damping_ratio", "stribeck_velocity_m_per_s"} <= set(
        parts.assumed
    )
    drawn = bk.draw_parts(parts.population, 200, seed=3)
    assert 2300.0 < np.median(drawn["stiction_n"]) < 2500.0
    assert (drawn["mass_kg"] == 2.0).all()
    assert any("bound from below" in line for line in parts.provenance)


def test_a_guide_of_known_length_is_told() -> None:
    parts = with_guide(parts_of("seized_parts"), 0.03)
    assert parts.told == ("engagement_length_m",) and "engagement_length_m" not in parts.assumed
    drawn = bk.draw_parts(parts.population, 50, seed=0)
    assert (drawn["engagement_length_m"] == 0.03).all()
    same = bk.draw_parts(SEIZED, 50, seed=0)
    np.testing.assert_array_equal(drawn["stiction_n"], same["stiction_n"])


@pytest.mark.parametrize("length_m", [0.0, -0.02, 30.0, float("nan")])
def test_a_guide_that_is_none_is_refused(length_m: float) -> None:
    with pytest.raises(bk.ScenarioError, match=r"engagement_length_m: .* is not > 0 and <= 10"):
        bk.advise("seized_parts", "screw_jack", engagement_length_m=length_m)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"budget_s": 0.0}, "budget_s: 0.0 is not > 0"),
        ({"budget_s": float("nan")}, "budget_s: nan is not > 0"),
        ({"budget_s": float("inf")}, "budget_s: inf is not > 0"),
        ({"parts_max": 3}, "parts_max: 3 is not >= 16"),
    ],
)
def test_numbers_out_of_range_are_refused(changes: dict[str, float], words: str) -> None:
    with pytest.raises(bk.StudyError, match=words):
        bk.advise("seized_parts", "screw_jack", **changes)


def test_a_log_is_told_how_it_becomes_a_joint(tmp_path: Path) -> None:
    log = tmp_path / "pull.csv"
    log.write_text("t_s,position_m,force_n\n0,0,0\n")
    with pytest.raises(bk.ScenarioError, match=r"^pull\.csv: is not TOML; .* breakaway events LOG"):
        bk.advise(log)


def test_what_is_no_file_is_named() -> None:
    with pytest.raises(bk.ScenarioError, match="nowhere"):
        bk.advise("nowhere.toml")
    with pytest.raises(bk.ScenarioError, match=r"no_rig.*screw_jack"):
        bk.advise("seized_parts", "no_rig")
