"""Which numbers of a rig a law frees, and where they go."""

import itertools

import numpy as np
import pytest

from breakaway._core import RIG_NUMBERS
from breakaway.errors import LogError
from breakaway.measure.identification.laws import LAWS, Layout, Parameter, check_law


def names(law: str, offsets: int = 1, **options: bool) -> list[str]:
    chosen = check_law(law, options.get("asymmetric", False), options.get("position", False))
    return [one.name for one in chosen.parameters(offsets)]


def test_each_law_has_the_parameters_of_the_one_before() -> None:
    assert names("coulomb") == ["mass_kg", "coulomb_n", "viscous_n_s_per_m", "offset_n"]
    for simple, rich in itertools.pairwise(LAWS):
        assert set(names(simple)) < set(names(rich))
    assert set(names("elasto_plastic")) - set(names("lugre")) == {"elastic_share"}


def test_sides_hold_the_offset() -> None:
    both = names("coulomb", asymmetric=True)
    assert "offset_n" not in both
    assert {"coulomb_positive_n", "viscous_negative_n_s_per_m"} < set(both)
    assert names("coulomb", 3, asymmetric=True)[-2:] == ["offset_2_n", "offset_3_n"]
    assert names("coulomb", 3)[-3:] == ["offset_1_n", "offset_2_n", "offset_3_n"]


def test_position_adds_a_slope_and_a_spring() -> None:
    added = set(names("lugre", position=True)) - set(names("lugre"))
    assert added == {"coulomb_slope_n_per_m", "spring_n_per_m"}


@pytest.mark.parametrize("law", LAWS)
def test_every_number_of_a_law_is_one_of_the_core(law: str) -> None:
    parameters = check_law(law, asymmetric=False, position_dependent=True).parameters(2)
    known = {*RIG_NUMBERS, "offset 0", "offset 1"}
    assert all(set(one.numbers) <= known for one in parameters)


def test_a_label_says_the_options() -> None:
    assert check_law("lugre", asymmetric=True, position_dependent=True).label == (
        "LuGre, each direction, position"
    )
    assert check_law("elasto_plastic", False, False).label == "elasto-plastic"


def test_an_unknown_law_is_refused() -> None:
    with pytest.raises(LogError, match="law: 'LuGre' is not one of coulomb, stribeck, lugre"):
        check_law("LuGre", asymmetric=False, position_dependent=False)


def test_numbers_go_to_their_places() -> None:
    parameters = check_law("coulomb", asymmetric=False, position_dependent=False).parameters(2)
    layout = Layout.of(parameters, {"mass_kg": 2.0, "stiffness_n_per_m": 1e6}, (0, 1, 1))
    values = {"coulomb_n": 5.0, "viscous_n_s_per_m": 7.0, "offset_1_n": -1.0, "offset_2_n": 3.0}
    at = np.array([one.internal(values[one.name]) for one in layout.free])
    numbers = dict(zip(RIG_NUMBERS[:-1], layout.numbers(at)[:15], strict=True))
    assert layout.values(at) == pytest.approx(values)
    assert numbers["mass_kg"] == 2.0
    assert numbers["coulomb_positive_n"] == numbers["coulomb_negative_n"] == pytest.approx(5.0)
    assert numbers["viscous_negative_n_s_per_m"] == pytest.approx(7.0)
    assert (numbers["stiction_ratio"], numbers["stiffness_n_per_m"]) == (1.0, 1e6)
    assert layout.numbers(at)[15:].tolist() == [-1.0, 3.0, 3.0]
    many = layout.numbers(np.stack([at, at + 0.1]))
    np.testing.assert_array_equal(many[0], layout.numbers(at))


def test_slopes_are_those_of_the_values() -> None:
    parameters = check_law("lugre", asymmetric=True, position_dependent=True).parameters(1)
    layout = Layout.of(parameters, {}, (0,))
    at = np.linspace(-1.0, 1.0, len(layout.free))
    values, more, less = (layout.values(at + h) for h in (0.0, 1e-6, -1e-6))
    central = [(more[name] - less[name]) / 2e-6 for name in values]
    np.testing.assert_allclose(layout.slope(at), central, rtol=1e-8)


def test_a_positive_parameter_is_fitted_as_its_logarithm() -> None:
    positive = Parameter("mass_kg", ("mass_kg",), True, 1e-9, 1e9)
    assert positive.internal(np.e) == pytest.approx(1.0)
    assert positive.external(np.array([1.0]))[0] == pytest.approx(np.e)
