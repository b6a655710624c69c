"""How the friction of parts varies, and which of their quantities go together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

import breakaway as bk
from breakaway.errors import ScenarioError, StudyError
from breakaway.model.scenario.laws import LAWS
from breakaway.model.scenario.variation import VARIATIONS
from breakaway.run.trials import TRIAL_METRICS, part_columns

PARTS = 20_000
TOGETHER = [
    {"of": ["stiction_n", "presliding_m"], "normal": 0.5},
    {"of": ["mass_kg", "stiction_n"], "normal": -0.3},
]


@pytest.fixture(scope="module")
def population() -> bk.PartPopulation:
    """Seized parts in guides of 1 to 2 mm, which are out within a second."""
    whole = bk.load_population("seized_parts")
    short = {"engagement_length_m": bk.Uniform(low=0.001, high=0.002)}
    parts = whole.parts.model_copy(update=short)
    return whole.model_copy(update={"parts": parts, "duration_s": 0.6})


def correlated(*correlations: dict[str, Any], **parts: Any) -> bk.PartPopulation:
    values = bk.load_population("seized_parts").model_dump()
    given = {"parts": values["parts"] | parts, "correlations": list(correlations)}
    return bk.PartPopulation.parse(values | given)


# How friction varies


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("variation", VARIATIONS)
def test_a_part_replays_to_the_bit_however_its_friction_varies(population, law, variation):
    method = bk.load_method("timed_impacts")
    trial = bk.run_trial(population, method, law=law, variation=variation, runs=range(3, 6), seed=4)
    run = trial.replay(1, trace_every=0)
    for metric in TRIAL_METRICS:
        alone, together = getattr(run.metrics, metric), trial.metrics[metric][1]
        assert alone == together or (np.isnan(alone) and np.isnan(together)), metric


def test_a_population_says_how_friction_varies(population):
    method = bk.load_method("timed_impacts")
    own, asked, still = (
        bk.run_trial(population, method, variation=variation, runs=4, seed=1)
        for variation in (None, "field", "none")
    )
    assert own == asked
    assert own.variation == "field"
    assert not np.array_equal(own.metrics["peak_force_n"], still.metrics["peak_force_n"])


def test_a_variation_is_what_its_word_says(population):
    method = bk.load_method("timed_impacts")
    trials = {v: bk.run_trial(population, method, variation=v, runs=3, seed=1) for v in VARIATIONS}
    parts = trials["field"].parts
    disturbances = {v: trial.scenario(2).disturbance for v, trial in trials.items()}
    assert disturbances["field"] == bk.FieldDisturbance(
        law="bounded",
        var=float(parts["var"][2]),
        correlation_length_m=float(parts["correlation_length_m"][2]),
    )
    assert disturbances["paper_random_factor"] == bk.UniformDisturbance(
        var=float(parts["var"][2]), hold_s=float(parts["hold_s"][2]), acts_on="friction_level"
    )
    assert disturbances["part"].var == disturbances["none"].var == 0.0
    joints = {v: trial.scenario(2).joint for v, trial in trials.items()}
    assert joints["field"] == joints["none"] == joints["paper_random_factor"]
    factor = float(1.0 + parts["var"][2] * parts["level_draw"][2])
    assert joints["part"].model_dump() == joints["none"].model_dump() | {
        "stiction_n": factor * joints["none"].stiction_n,
        "coulomb_n": factor * joints["none"].coulomb_n,
    }


def test_levels_from_part_to_part_stay_within_var(population):
    parts = bk.draw_parts(population, 1000, seed=2)
    method = bk.load_method("force_ramp")
    columns = part_columns(population, method, "lugre", "part", parts)
    w = (columns["joint.stiction_n"] / parts["stiction_n"] - 1.0) / parts["var"]
    assert abs(w).max() <= 1.0 + 1e-12
    assert stats.kstest(w, stats.uniform(-1.0, 2.0).cdf).pvalue > 1e-3
    stiffness = parts["stiction_n"] / parts["presliding_m"]
    np.testing.assert_array_equal(columns["joint.stiffness_n_per_m"], stiffness)


def test_an_unknown_variation_is_refused(population):
    method = bk.load_method("force_ramp")
    with pytest.raises(StudyError, match="variation: 'fields' is not one of field, part, none, "):
        bk.run_trial(population, method, variation="fields", runs=1, seed=0)
    values = population.model_dump() | {"variation": "fields"}
    with pytest.raises(ScenarioError, match="variation: 'fields' is not one of 'field', "):
        bk.PartPopulation.parse(values)


# Which quantities go together


def test_correlated_quantities_have_the_rank_correlation_that_follows():
    parts = bk.draw_parts(correlated(*TOGETHER), PARTS, seed=3)
    for correlation in TOGETHER:
        one, other = (parts[name] for name in correlation["of"])
        found = stats.spearmanr(one, other).statistic
        expected = 6.0 / np.pi * np.arcsin(0.5 * correlation["normal"])
        assert abs(found - expected) <= 3.0 / np.sqrt(PARTS - 1)


def test_three_quantities_go_together_as_asked():
    three = [*TOGETHER, {"of": ["presliding_m", "mass_kg"], "normal": 0.6}]
    parts = bk.draw_parts(correlated(*three), PARTS, seed=5)
    for correlation in three:
        ranks = [stats.rankdata(parts[name]) for name in correlation["of"]]
        scores = [stats.norm.ppf((rank - 0.5) / PARTS) for rank in ranks]
        found = np.corrcoef(*scores)[0, 1]
        assert found == pytest.approx(correlation["normal"], abs=3.0 / np.sqrt(PARTS))


def test_correlation_leaves_every_distribution_as_it_is():
    population = correlated(*TOGETHER)
    parts = bk.draw_parts(population, PARTS, seed=3)
    log = stats.uniform(np.log(5e-6), np.log(30e-6 / 5e-6))
    assert stats.kstest(np.log(parts["presliding_m"]), log.cdf).pvalue > 1e-3
    assert stats.kstest(parts["mass_kg"], stats.uniform(0.2, 1.8).cdf).pvalue > 1e-3


def test_quantities_without_correlation_keep_their_bits():
    plain = bk.draw_parts(bk.load_population("seized_parts"), 100, seed=3)
    parts = bk.draw_parts(correlated(*TOGETHER), 100, seed=3)
    moved = {name for name in plain if not np.array_equal(plain[name], parts[name])}
    assert moved == {"presliding_m", "mass_kg"}  # which follow stiction_n


def test_a_correlated_part_depends_on_its_number_alone():
    population = correlated(*TOGETHER)
    whole, some = (bk.draw_parts(population, runs, seed=3) for runs in (10, range(4, 7)))
    for name, values in whole.items():
        np.testing.assert_array_equal(values[4:7], some[name])


SHARED = {"distribution": "samples", "values": [1.0, 2.0], "rows": "shared"}


@pytest.mark.parametrize(
    ("correlations", "parts", "words"),
    [
        ([{"of": ["mass_kg", "mass"], "normal": 0.1}], {},
         r"correlations\.0\.of: 'mass' is not one of stiction_n, "),
        ([{"of": ["mass_kg", "mass_kg"], "normal": 0.1}], {},
         r"correlations\.0\.of: names 'mass_kg' twice; give two quantities"),
        ([{"of": ["mass_kg", "var"], "normal": 1.0}], {},
         r"correlations\.0\.normal: 1\.0 is not < 1"),
        ([TOGETHER[0], {"of": ["presliding_m", "stiction_n"], "normal": 0.1}], {},
         r"correlations\.1\.of: presliding_m and stiction_n have a correlation already"),
        ([{"of": [a, b], "normal": r} for a, b, r in (
            ("mass_kg", "var", 0.9), ("var", "stiction_n", 0.9), ("mass_kg", "stiction_n", -0.9))],
         {}, r"correlations: .*the smallest eigenvalue of their matrix is -0\.8, not > 0"),
        ([{"of": ["mass_kg", "var"], "normal": 0.1}], {"mass_kg": SHARED},
         r"correlations\.0\.of: 'mass_kg' is drawn from shared rows of a table"),
    ],
)  # fmt: skip
def test_correlations_that_cannot_be_are_refused(correlations, parts, words):
    with pytest.raises(ScenarioError, match=words) as error:
        correlated(*correlations, **parts)
    assert "\n" not in str(error.value)
