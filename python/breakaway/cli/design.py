"""``breakaway design``: gains, closed-loop poles and stability of a scenario's controller."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.cli.quantity import show_digits
from breakaway.cli.show import Sheet, say, say_json

if TYPE_CHECKING:
    from breakaway.design import GainSet, LoopStability, PidGains, Stability
    from breakaway.scenario import Gains, PolePlacement, Scenario

NOT_STABLE = 4
"""Exit code where --require-stable is not met."""


@dataclass(frozen=True)
class Judged:
    """One set of gains and what becomes of its loops."""

    role: str
    """What the gains are for: pid, vibration, step 1 or step 2."""
    designed: GainSet | None
    """Static, dynamic and total gains, where they are designed."""
    gains: PidGains
    """The gains that run."""
    verdict: Stability
    """Stuck, sliding and Stribeck."""

    @property
    def stable(self) -> bool:
        """Whether both loops are stable; self-excited oscillation is not counted."""
        return self.verdict.stuck.stable and self.verdict.sliding.stable


def design(
    scenario: Annotated[str, typer.Argument(help="Name of a preset, or path of a TOML file.")],
    require_stable: Annotated[
        bool,
        typer.Option(
            "--require-stable",
            help="Exit with 4 unless every gain set is stable, stuck and sliding.",
        ),
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON document.")] = False,
) -> None:
    """Show a controller's gains, its closed-loop poles, and whether they are stable.

    Each gain set is judged with the joint stuck and with the joint sliding,
    by Routh and Hurwitz, without sampling and delay. An unstable loop is a
    finding: the exit code is 0, and 4 only where --require-stable is given.
    The Stribeck verdict is shown, and not counted.
    """
    from breakaway.scenario import load_scenario

    asked = load_scenario(scenario)
    judged = [_judge(asked, role, gains) for role, gains in _gain_sets(asked)]
    if json:
        say_json(
            {
                "scenario": asked.name,
                "stable": all(one.stable for one in judged),
                "gain_sets": [_content(one) for one in judged],
            }
        )
    else:
        say(f"{asked.name}: {asked.controller.kind} controller")
        for one in judged:
            _show(one)
    if require_stable and not all(one.stable for one in judged):
        raise typer.Exit(NOT_STABLE)


def _gain_sets(scenario: Scenario) -> list[tuple[str, Gains | PolePlacement]]:
    from breakaway.scenario import FmVibration, TwoStep

    controller = scenario.controller
    if isinstance(controller, TwoStep):
        return [
            ("step 1, pid", controller.pid.gains),
            ("step 2, vibration", controller.vibration_gains),
        ]
    if isinstance(controller, FmVibration):
        return [("vibration", controller.pid.gains)]
    return [("pid", controller.gains)]


def _judge(scenario: Scenario, role: str, gains: Gains | PolePlacement) -> Judged:
    from breakaway.design import PidGains, pole_placement, stability
    from breakaway.scenario import Gains

    joint, mass_kg = scenario.joint, scenario.part.mass_kg
    designed = None
    if isinstance(gains, Gains):
        running = PidGains(kp=gains.kp_n_per_m, ki=gains.ki_n_per_m_s, kd=gains.kd_n_s_per_m)
    else:
        designed = pole_placement(joint, mass_kg=mass_kg, **gains.model_dump(exclude={"kind"}))
        running = designed.total
    return Judged(role, designed, running, stability(running, joint, mass_kg))


def _show(one: Judged) -> None:
    columns = ["kp (kN/m)", "ki (kN/(m s))", "kd (N s/m)"]  # as the paper's Table II
    gains = Sheet(f"Gains of {one.role}", ["gains", *columns], numbers=columns)
    if one.designed:
        gains.add("static", *_shown(one.designed.static))
        gains.add("dynamic", *_shown(one.designed.dynamic))
    gains.add("total" if one.designed else "given", *_shown(one.gains))
    loops = Sheet(
        f"Stability of {one.role}",
        ["joint", "verdict", "poles (1/s)", "because"],
        prose=["because"],
    )
    for regime, loop in (("stuck", one.verdict.stuck), ("sliding", one.verdict.sliding)):
        loops.add(regime, "stable" if loop.stable else "UNSTABLE", _poles(loop), loop.reason)
    say(gains, loops, f"  Stribeck: {one.verdict.stribeck}\n")


def _shown(gains: PidGains) -> tuple[str, str, str]:
    return show_digits(gains.kp / 1e3), show_digits(gains.ki / 1e3), show_digits(gains.kd)


def _poles(loop: LoopStability) -> str:
    """One pole, or one conjugate pair, on each line."""
    lines = []
    for pole in sorted(loop.poles_per_s, key=lambda p: (p.real, p.imag)):
        if pole.imag == 0.0:
            lines.append(f"{pole.real:.5g}")
        elif pole.imag > 0.0:
            lines.append(f"{pole.real:.5g} ± {pole.imag:.5g} j")
    return "\n".join(lines)


def _content(one: Judged) -> dict[str, Any]:
    designed = one.designed
    return {
        "role": one.role,
        "designed": designed is not None,
        "static": _named(designed.static) if designed else None,
        "dynamic": _named(designed.dynamic) if designed else None,
        "total": _named(one.gains),
        "natural_frequency_rad_per_s": designed.natural_frequency_rad_per_s if designed else None,
        "stable": one.stable,
        **asdict(one.verdict),
    }


def _named(gains: PidGains) -> dict[str, float]:
    return {"kp_n_per_m": gains.kp, "ki_n_per_m_s": gains.ki, "kd_n_s_per_m": gains.kd}
