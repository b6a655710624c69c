"""What m2 of equation (12) multiplies: the loop of (13), and readings of it that were tried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from breakaway.ask.reproduction.survey import CONTROLS, DisturbanceRange, disturbance_range
from breakaway.ask.reproduction.tables import designed
from breakaway.design.pole_placement import PidGains, coulomb_fall_n_per_m, pole_placement
from breakaway.design.stability import LoopStability, stability
from breakaway.model.scenario.controller import Gains, PolePlacement, gain_sets
from breakaway.model.scenario.files import load_scenario
from breakaway.model.scenario.scenario import Scenario

LEVELS = (0.085, 0.125, 0.9)
"""Levels of var: the two limits that the paper prints, and far beyond."""
SEEDS = 32
"""Runs at each level."""


@dataclass(frozen=True)
class Reading:
    """A reading of what m2 multiplies; the gains of the presets are multiplied by nothing."""

    name: str
    """What it is called."""
    static_too: bool
    """Whether m2 multiplies the static gains as well as the dynamic ones."""
    control_period_s: float
    """T_s, in s: short enough for kd T_s / m < 2, beyond which any sampled loop diverges."""


READINGS = {
    "m2_whole_loop": Reading("m₂ times the whole loop", True, 5e-7),
    "m2_dynamic_gains": Reading("m₂ times the dynamic gains", False, 1e-5),
}
"""The force is m2 u, u the PID's output; or only the gains designed by (13) are multiplied."""


def equation_13(control: str) -> LoopStability:
    """Judge the loop of (13) as printed, with the total gains of one half of Table II.

    Parameters
    ----------
    control : str
        ``"without_vibration"`` or ``"with_vibration"``.

    Examples
    --------
    >>> equation_13("with_vibration").stable
    True

    """
    scenario = load_scenario("paper_as_computed")
    mass_kg = scenario.part.mass_kg
    m2 = coulomb_fall_n_per_m(scenario.joint, mass_kg)
    total = designed(scenario, control).total
    loop = PidGains(kp=(1.0 + total.kp) * m2, ki=total.ki * m2, kd=total.kd * m2)
    return stability(loop, scenario.joint, mass_kg).sliding


def with_m2(scenario: Scenario, reading: Reading) -> Scenario:
    """Give a scenario whose designed gains are multiplied as a reading says.

    Parameters
    ----------
    scenario : Scenario
        Its gains are designed by pole placement.
    reading : Reading
        The reading.

    Examples
    --------
    >>> scenario = with_m2(load_scenario("paper_as_computed"), READINGS["m2_dynamic_gains"])
    >>> round(scenario.controller.gains.kd_n_s_per_m)  # 0.1 * 7200 + 0.9 * 16200
    15300

    """
    changes: dict[str, object] = {
        f"controller.{which}": _gains(scenario, design, reading)
        for which, design in gain_sets(scenario.controller).items()
        if isinstance(design, PolePlacement)
    }
    return scenario.with_({**changes, "timing.control_period_s": reading.control_period_s})


def _gains(scenario: Scenario, design: PolePlacement, reading: Reading) -> Gains:
    joint, mass_kg = scenario.joint, scenario.part.mass_kg
    parts = pole_placement(
        joint,
        mass_kg=mass_kg,
        settling_time_s=design.settling_time_s,
        damping_ratio=design.damping_ratio,
        pole_per_s=design.pole_per_s,
    )
    m2 = coulomb_fall_n_per_m(joint, mass_kg)
    on_static = design.static_share * (m2 if reading.static_too else 1.0)
    on_dynamic = (1.0 - design.static_share) * m2
    static, dynamic = parts.static, parts.dynamic
    return Gains(
        kp_n_per_m=on_static * static.kp + on_dynamic * dynamic.kp,
        ki_n_per_m_s=on_static * static.ki + on_dynamic * dynamic.ki,
        kd_n_s_per_m=on_static * static.kd + on_dynamic * dynamic.kd,
    )


def velocity_gain(reading: Reading, control_period_s: float) -> float:
    """Give kd T_s / m without vibration: above 2 a sampled loop overcorrects more every time.

    Examples
    --------
    >>> f"{velocity_gain(READINGS['m2_whole_loop'], 1e-5):.3g}"
    '25.4'

    """
    scenario = load_scenario("paper_as_computed")
    designs = gain_sets(scenario.controller).values()
    (design,) = (design for design in designs if isinstance(design, PolePlacement))
    gains = _gains(scenario, design, reading)
    return gains.kd_n_s_per_m * control_period_s / scenario.part.mass_kg


def try_readings() -> Mapping[str, Mapping[str, DisturbanceRange]]:
    """Simulate each reading with each control at each of `LEVELS`, by reading and control."""
    return {
        key: {
            control: disturbance_range(with_m2(load_scenario(preset), reading), LEVELS, SEEDS)
            for control, preset in CONTROLS.items()
        }
        for key, reading in READINGS.items()
    }
