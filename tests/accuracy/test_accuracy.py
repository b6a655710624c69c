"""The benchmark of accuracy: a few of its cases, closed forms, and that it can fail."""

from dataclasses import replace
from math import inf, nan, sqrt

import pytest
from tests.accuracy.chaos import is_chaotic, unlike
from tests.accuracy.figures import errors_of, figures_of, floors_of, worst_of
from tests.accuracy.impacts import CONTACTS_N_PER_M, TOOLS_KG, impact_scenario, strike
from tests.accuracy.independent import LAWS, build, is_known, solve
from tests.accuracy.kinds import KINDS, kind_of
from tests.accuracy.reach import missed
from tests.accuracy.scenarios import draw_case
from tests.accuracy.steps import at_steps, steps_of
from tests.accuracy.table import report
from tests.accuracy.verdict import State, Verdict, judge

import breakaway as bk

DRIVES = ("ideal", "push_only", "force", "feed_rigid", "feed_grip")


@pytest.fixture(scope="module")
def solver(tmp_path_factory):
    program = build(tmp_path_factory.mktemp("solver"))
    if program is None:
        pytest.skip("no C compiler")
    return program


def test_a_case_is_a_function_of_seed_and_number():
    assert draw_case(3, 14).scenario == draw_case(3, 14).scenario
    assert draw_case(3, 14).scenario != draw_case(4, 14).scenario


def test_every_kind_comes_once_in_a_lap():
    assert {kind_of(5, n) for n in range(len(KINDS))} == set(KINDS)
    assert {kind_of(5, n) for n in range(len(KINDS), 2 * len(KINDS))} == set(KINDS)


@pytest.mark.parametrize("number", range(len(KINDS)))
def test_every_kind_is_a_scenario(number):
    case = draw_case(1, number)
    assert case.scenario.joint.law == case.kind.law
    assert case.scenario.controller.kind == case.kind.controller


def test_errors_are_relative_to_the_reference_or_a_floor():
    reference = {"a": 2.0, "b": 1e-9, "c": nan, "d": nan, "impacts": 7.0}
    figures = {"a": 2.1, "b": 2e-9, "c": nan, "d": 1.0, "impacts": 9.0}
    errors = errors_of(figures, reference, {"b": 1e-6})
    assert errors == pytest.approx({"a": 0.05, "b": 1e-3, "c": 0.0, "d": inf, "impacts": 2.0})
    assert worst_of({"a": 0.05, "impacts": 1.0}) == 0.05
    assert worst_of({"a": 0.05, "impacts": 3.0}) == 2.0


@pytest.fixture
def coarse(pull):
    """A case at steps that do not resolve its bristle."""
    timing = {"timing.control_period_s": 1e-3, "timing.steps_per_period": 100}
    scenario = pull("two_region", "push_only").with_(timing)
    return replace(draw_case(0, 0), scenario=at_steps(scenario, 1))


def test_coarse_steps_are_found_out(coarse):
    verdict = judge(coarse)
    assert verdict.state is State.CONVERGED
    assert verdict.worst > 0.05
    assert any("within 1 %" in line for line in missed([verdict], []))
    assert any(str(coarse.kind) in line for line in report([verdict], 0))


def test_fine_steps_are_near_their_reference(coarse):
    verdict = judge(replace(coarse, scenario=at_steps(coarse.scenario, 200)))
    assert verdict.state is State.CONVERGED and verdict.worst < 0.01
    assert list(missed([verdict], [])) == []


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("law", LAWS)
def test_the_independent_solver_has_the_same_answer(law, drive, pull, solver):
    scenario = pull(law, drive)
    assert is_known(scenario)
    found = figures_of(bk.simulate(scenario))
    solution = solve(solver, scenario)
    errors = errors_of(found, solution, floors_of(scenario))
    assert solution["release_velocity_m_per_s"] > 0.05
    assert worst_of(errors) < 5e-3, errors


@pytest.mark.parametrize("contact_n_per_m", CONTACTS_N_PER_M)
@pytest.mark.parametrize("tool_kg", TOOLS_KG)
def test_peak_of_an_impact(tool_kg, contact_n_per_m):
    scenario = impact_scenario(tool_kg, contact_n_per_m, 2e-4)
    enough = round(2e-4 / (0.02 * sqrt(tool_kg / contact_n_per_m))) + 1
    assert strike(scenario, enough).error < 2e-3


@pytest.mark.parametrize("period_s", [1e-5, 1e-3])
@pytest.mark.parametrize("tool_kg", [min(TOOLS_KG), max(TOOLS_KG)])
def test_peak_of_an_impact_at_the_default_steps(tool_kg, period_s):
    scenario = impact_scenario(tool_kg, max(CONTACTS_N_PER_M), period_s)
    assert strike(scenario, steps_of(scenario)).error < 2e-3


def test_too_few_steps_miss_the_peak_of_an_impact():
    impact = strike(impact_scenario(5.0, 2e8, 1e-3), 5)
    assert impact.error > 0.1
    assert any("peaks" in line for line in missed([], [impact]))


def test_a_smooth_case_is_not_chaotic(pull):
    scenario = pull("lugre", "ideal")
    assert not is_chaotic(scenario, 2, floors_of(scenario))


def test_distributions_over_starts_tell_coarse_steps(coarse):
    scenario, floors = coarse.scenario, floors_of(coarse.scenario)
    assert unlike(scenario, 1, 1, floors) == {}
    assert "largest_error_m" in unlike(scenario, 1, 200, floors)


def test_the_reach_is_for_cases_and_for_chaos():
    fine = Verdict(0, "a b c", State.CONVERGED, 1, 50, 100, {"iae_m_s": 1e-3})
    chaotic = Verdict(1, "a b c", State.CHAOTIC, 1, 50, 100, {})
    assert list(missed([fine] * 20, [])) == []
    assert list(missed([fine] * 10 + [chaotic], [])) == ["chaotic: 1 of 11, more than 5%"]
    near = replace(fine, solved={"iae_m_s": 0.02})
    assert len(list(missed([fine] * 97 + [near] * 3, []))) == 0
    assert len(list(missed([fine] * 96 + [near] * 4, []))) == 1
