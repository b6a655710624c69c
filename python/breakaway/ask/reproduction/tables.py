"""Tables I and II of the paper beside ours."""

from __future__ import annotations

from breakaway.ask.reproduction.rows import Row, printed_row
from breakaway.design.pole_placement import GainSet, pole_placement
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.joint import Lugre
from breakaway.model.scenario.scenario import Scenario
from breakaway.model.units import unit_of

TUNING = {
    "without_vibration": {"settling_time_s": 5e-4, "damping_ratio": 1.0},
    "with_vibration": {"settling_time_s": 5.2e-4, "damping_ratio": 1.2},
}
"""Section 4 of the paper; the third pole is at 200 1/s in both."""

TABLE_2 = {
    "without_vibration": {
        "static": {"kp": "31200", "kd": "7.2000", "ki": "12800000"},
        "dynamic": {"kp": "19.2", "kd": "0.0046", "ki": "3655"},
        "total": {"kp": "3137.3", "kd": "0.7242", "ki": "1283289"},
    },
    "with_vibration": {
        "static": {"kp": "8168.3", "kd": "6.5846", "ki": "8218277"},
        "dynamic": {"kp": "12.6", "kd": "0.0044", "ki": "2347"},
        "total": {"kp": "828.2", "kd": "0.6625", "ki": "823940"},
    },
}
"""The printed gains, in thousands (the paper's second table, captioned as its first)."""

_NAMES = {"kp": "proportional", "kd": "derivative", "ki": "integral"}
_GAINS = ("kp_n_per_m", "kd_n_s_per_m", "ki_n_per_m_s")
_UNITS = {name[:2]: unit_of(name).prefixed(3) for name in _GAINS}
"""In thousands, as the paper prints them."""


def designed(scenario: Scenario, control: str) -> GainSet:
    """Design the gains of one half of Table II for the joint of a scenario."""
    mass_kg = scenario.part.mass_kg
    return pole_placement(scenario.joint, mass_kg=mass_kg, pole_per_s=200.0, **TUNING[control])


def table_1() -> list[Row]:
    """Table I, beside what Table II implies."""
    joint = load_scenario("paper_as_computed").joint
    if not isinstance(joint, Lugre):
        raise TypeError("the preset paper_as_computed is a LuGre joint")
    implied = "all 18 gains of Table II follow from our value; with the printed one 8 do not"
    rows = (
        ("f_s0", "initial stiction force F_s0", "450", joint.stiction_n, "N"),
        ("f_c0", "initial Coulomb force F_c0", "360", joint.coulomb_n, "N"),
        ("k_e", "stiffness k_e", "30000000", joint.stiffness_n_per_m, "N/m"),
        ("c", "damping c, printed as 1.6 k_e", "48000000", joint.damping_n_s_per_m, "N s/m"),
        ("v_s", "Stribeck velocity", "0.09", joint.stribeck_velocity_m_per_s, "m/s"),
        ("l_f", "disassembly distance l_f", "0.1", joint.engagement_length_m, "m"),
    )
    return [
        printed_row(f"table1.{key}", what, printed, ours, unit, implied)
        for key, what, printed, ours, unit in rows
    ]


def table_2(preset: str = "paper_as_computed", key: str = "table2") -> list[Row]:
    """Table II beside the gains designed for the joint of a preset."""
    scenario = load_scenario(preset)
    k_e, c = scenario.joint.stiffness_n_per_m, scenario.joint.damping_n_s_per_m
    reason = f"the joint of Table I (k_e = {k_e:g} N/m, c = {c:g} N s/m) does not give it"
    rows = []
    for control, kinds in TABLE_2.items():
        gain_set = designed(scenario, control)
        for kind, gains in kinds.items():
            for gain, printed in gains.items():
                ours = getattr(getattr(gain_set, kind), gain) / 1000.0
                what = f"{_NAMES[gain]} gain, {kind}, {control.replace('_', ' ')}"
                name = f"{key}.{control}.{kind}.{gain}"
                rows.append(printed_row(name, what, printed, ours, _UNITS[gain], reason))
    return rows
