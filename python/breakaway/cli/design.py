"""``breakaway design``: gains, margins, poles and limit cycle of a scenario's controller."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from math import isfinite, pi
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.cli.options import Joint, Json, ScenarioName
from breakaway.cli.quantity import show, show_digits
from breakaway.cli.sheet import Sheet
from breakaway.cli.show import busy, plain, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.design import (
        GainSet,
        LimitCycleComparison,
        Margins,
        PidGains,
        SampledLoop,
        SampledPid,
        Stability,
    )
    from breakaway.model.scenario import Gains, PidSettings, PolePlacement, Scenario

NOT_STABLE = 4
"""Exit code where --require-stable is not met."""
ROWS_PER_CYCLE = 100
"""Rows of a trace in a period of the loop, where a limit cycle is measured."""

ROLES = {
    "": "pid",
    "pid.": "vibration",
    "breakaway.": "step 1, pid",
    "vibration.pid.": "step 2, vibration",
}
"""Path of a PID within its controller -> what its gains are for."""


@dataclass(frozen=True)
class Asked:
    """One set of gains of a scenario, and the PID that it belongs to."""

    role: str
    """What the gains are for: pid, vibration, step 1 or step 2."""
    gains: Gains | PolePlacement
    """Given or designed."""
    settings: PidSettings
    """Where the velocity comes from, and its filter."""


@dataclass(frozen=True)
class Judged:
    """One set of gains and what becomes of its loops."""

    role: str
    """What the gains are for."""
    designed: GainSet | None
    """Static, dynamic and total gains, where they are designed."""
    gains: PidGains
    """The gains that run."""
    verdict: Stability
    """Stuck, sliding and Stribeck, without sampling."""
    pid: SampledPid
    """The PID as it runs."""
    loops: tuple[SampledLoop, ...]
    """Its loops, with sampling, hold and delay."""
    limit_cycle: LimitCycleComparison | None
    """Predicted against simulated, where there is something to compare."""

    @property
    def stable(self) -> bool:
        """Whether all loops are stable, sampled or not; self-excited oscillation is not counted."""
        continuous = [loop for loop in (self.verdict.stuck, self.verdict.sliding) if loop]
        return all(loop.stable for loop in continuous) and all(
            loop.margins.stable for loop in self.loops if loop.counts
        )


def design(
    scenario: ScenarioName,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for design.json and the figures.", metavar="DIR"),
    ] = None,
    joint: Joint = None,
    require_stable: Annotated[
        bool,
        typer.Option(
            "--require-stable",
            help="Exit with code 4 unless every gain set is stable, both stuck and sliding.",
        ),
    ] = False,
    json: Json = False,
) -> None:
    """Show a controller's gains, margins and poles, and whether it is stable.

    Each gain set is judged with the joint stuck and with the joint sliding:
    by Routh and Hurwitz without sampling, and as it runs, with sampling, hold
    and delay. If friction falls with speed, the resulting limit cycle is
    predicted and compared with a simulated run. An unstable loop is a
    finding: the exit code is 0, or 4 with --require-stable. Oscillation that
    falling friction drives is shown but not counted. A controller without a
    PID has no linear loop and never meets --require-stable.

    With --out, the folder gets design.json and, for each gain set, a Bode
    plot, a Nyquist plot, a root locus and the limit cycle, as PNG and SVG.
    """
    from breakaway.cli.laid import laid
    from breakaway.model.scenario import load_scenario

    asked, overlay = laid(load_scenario(scenario), joint)
    if out is not None:  # before the work, not after it
        from breakaway.base.output import claim
        from breakaway.base.ownership import DESIGN

        claim(out, DESIGN, [DESIGN.marker])
    with busy("judging the loops ..."):
        judged = [_judge(asked, one) for one in _gain_sets(asked)]
    stable = bool(judged) and all(one.stable for one in judged)
    content = _document(asked, judged, stable)
    if overlay:
        content["joint"] = overlay.to_dict()
    files = _write(asked, judged, content, out) if out is not None else []
    if json:
        say_json(content | {"files": [str(path) for path in files]})
    else:
        if overlay:
            say(*overlay.tables())
        _show_all(asked, judged)
        say_written(files)
    if require_stable and not stable:
        raise typer.Exit(NOT_STABLE)


def _gain_sets(scenario: Scenario) -> list[Asked]:
    from breakaway.model.scenario.controller import pids

    return [Asked(ROLES[path], pid.gains, pid) for path, pid in pids(scenario.controller).items()]


def _judge(scenario: Scenario, asked: Asked) -> Judged:
    from breakaway.design import PidGains, pole_placement, sampled_loops, sampled_pid, stability
    from breakaway.model.scenario import Gains

    joint, mass_kg, gains = scenario.joint, scenario.part.mass_kg, asked.gains
    designed = None
    if isinstance(gains, Gains):
        running = PidGains(kp=gains.kp_n_per_m, ki=gains.ki_n_per_m_s, kd=gains.kd_n_s_per_m)
    else:
        designed = pole_placement(joint, mass_kg=mass_kg, **gains.model_dump(exclude={"kind"}))
        running = designed.total
    verdict = stability(running, joint, mass_kg)
    pid = sampled_pid(running, asked.settings, scenario.timing)
    loops = sampled_loops(pid, joint, mass_kg)
    limit_cycle = _limit_cycle(scenario, pid) if asked.role == "pid" else None
    return Judged(asked.role, designed, running, verdict, pid, loops, limit_cycle)


def _limit_cycle(scenario: Scenario, pid: SampledPid) -> LimitCycleComparison | None:
    """Predict the limit cycle, and compare it with a run of the scenario without disturbance."""
    from breakaway.design import compare_limit_cycle
    from breakaway.design.limit_cycle import oscillator_of
    from breakaway.run.simulation import simulate

    joint, mass_kg = scenario.joint, scenario.part.mass_kg
    oscillator = oscillator_of(pid, joint, mass_kg)
    if oscillator is None:
        return None
    every = max(1, int(1.0 / (ROWS_PER_CYCLE * oscillator.free_hz * pid.period_s)))
    quiet = scenario.with_({"disturbance.var": 0.0, "trace.every_samples": every})
    trace = simulate(quiet).trace
    if len(trace["t_s"]) < ROWS_PER_CYCLE:
        return None
    columns = {name: trace[name] for name in ("t_s", "reference_m", "velocity_m_per_s")}
    return compare_limit_cycle(pid, joint, mass_kg, **columns)


def _show_all(scenario: Scenario, judged: list[Judged]) -> None:
    kind = scenario.controller.kind
    say(f"{scenario.name}: {kind} controller")
    if not judged:
        say(NO_LOOP.format(kind=kind))
    for one in judged:
        _show(one)
    if judged and scenario.actuator.kind != "ideal":
        say(
            f"The loops leave out the {scenario.actuator.kind} actuator, with its limits and "
            "dynamics."
        )


NO_LOOP = (
    "A {kind} controller has no linear loop, so it has no gains or margins and is neither stable "
    "nor unstable.\nJudge it by what it does to parts: `breakaway tune` finds its settings, and "
    "`breakaway compare` compares it with others."
)


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
        labels=1,
    )
    for regime, loop in (("stuck", one.verdict.stuck), ("sliding", one.verdict.sliding)):
        if loop is None:
            loops.add(regime, "no loop", "", "this law has no stiffness while it is stuck")
        else:
            loops.add(regime, _verdict(loop.stable), _poles(loop.poles_per_s), loop.reason)
    say(gains, loops, f"  Stribeck: {one.verdict.stribeck}\n")
    say(_margins_sheet(one))
    for note in _notes(one):
        say(f"  {note}")
    if one.limit_cycle:
        _show_limit_cycle(one.limit_cycle)
    elif one.role == "pid":
        say("  Limit cycle: no prediction for this joint and these gains")
    say("")


def _margins_sheet(one: Judged) -> Sheet:
    numbers = ["gain factor", "phase (°)", "delay", "max |S|", "bandwidth"]
    sheet = Sheet(
        f"As {one.role} runs: {_timing(one.pid)}; loop opened at the force",
        ["joint", "verdict", *numbers, "poles (1/s)"],
        numbers=numbers,
        labels=1,
    )
    for loop in one.loops:
        found = loop.margins
        speed = loop.velocity_m_per_s
        regime = loop.regime if speed is None else f"{loop.regime},\n{show('v_m_per_s', speed)}"
        sheet.add(
            regime,
            _verdict(found.stable),
            _factors(found),
            *_margins(found),
            _poles(found.poles_per_s),
        )
    return sheet


def _timing(pid: SampledPid) -> str:
    n = pid.delay_samples
    delay = "no delay" if n == 0 else f"{n} sample of delay"
    filtered = f", derivative filtered over {show('tau_s', pid.derivative_filter_s)}"
    source = ", velocity differenced" if pid.velocity_from == "position_difference" else ""
    return (
        f"every {show('t_s', pid.period_s)}, held, {delay}{source}"
        f"{filtered if pid.derivative_filter_s else ''}"
    )


def _factors(found: Margins) -> str:
    """Ranges of a common factor on the gains for which the loop is stable."""
    ranges = [
        f"{low:.3g} to {high:.3g}" if isfinite(high) else f"above {low:.3g}"
        for low, high in found.stable_factors
    ]
    return "\n".join(ranges) or "none"


def _margins(found: Margins) -> tuple[str, str, str, str]:
    if not found.stable:
        return ("-",) * 4
    phase = f"{found.phase_margin_deg:.2f}" if isfinite(found.phase_margin_deg) else "any"
    delay = "any"
    if isfinite(found.delay_margin_s):
        periods = found.delay_margin_samples
        delay = f"{show('t_s', found.delay_margin_s)}\n{periods:.4g} samples"
    band = found.bandwidth_rad_per_s
    shown = show("f_hz", band / (2 * pi)) if isfinite(band) else "all"
    return phase, delay, f"{found.max_sensitivity:.3f}", shown


def _notes(one: Judged) -> Iterator[str]:
    from breakaway.design.regimes import disagreement

    verdicts = {"stuck": one.verdict.stuck, "sliding": one.verdict.sliding}
    for loop in one.loops:
        note = disagreement(loop.regime, verdicts.get(loop.regime), loop.margins)
        if note:
            yield f"disagree: {note}"
    unstable = [loop for loop in one.loops if loop.counts and not loop.margins.stable]
    if not unstable:
        yield (
            "gain factor: multiplying all gains by a factor in this range keeps the loop stable; "
            "phase, delay: how much may be added; S = 1/(1+L); poles: ln(z)/T_s"
        )
    for loop in unstable:
        yield f"{loop.regime}: unstable as it is, so it has no margins"


def _show_limit_cycle(found: LimitCycleComparison) -> None:
    say(f"  Limit cycle: {SAID[found.verdict]}")
    if found.verdict != "agree: oscillation":
        return
    numbers = ["predicted", "simulated", "error"]
    sheet = Sheet("", ["limit cycle", *numbers], numbers=numbers)
    sheet.add("seen", _window(found.predicted_window_s), _window(found.simulated_window_s), "")
    sheet.add(
        "frequency",
        show("f_hz", found.predicted_hz),
        show("f_hz", found.simulated_hz),
        f"{found.frequency_error_percent:+.1f} %",
    )
    sheet.add(
        "amplitude, RMS",
        show("a_m_per_s", found.predicted_amplitude_m_per_s),
        show("a_m_per_s", found.simulated_amplitude_m_per_s),
        f"{found.amplitude_error_percent:+.1f} %",
    )
    say(sheet)


SAID = {
    "agree: oscillation": "falling friction drives one, both predicted and simulated (no "
    "disturbance)",
    "agree: none": "none, neither predicted nor simulated (no disturbance)",
    "only predicted": "DISAGREE: predicted, not seen in a run without disturbance",
    "only simulated": "DISAGREE: seen in a run without disturbance, not predicted",
}
"""Verdict of a comparison -> what it says."""


def _window(window_s: tuple[float, float]) -> str:
    begin, end = (f"{1e3 * at:.0f}" for at in window_s)
    return f"{begin} to {end} ms"


def _verdict(stable: bool) -> str:
    return "stable" if stable else "UNSTABLE"


def _shown(gains: PidGains) -> tuple[str, str, str]:
    return show_digits(gains.kp / 1e3), show_digits(gains.ki / 1e3), show_digits(gains.kd)


def _poles(poles_per_s: tuple[complex, ...]) -> str:
    """One pole, or one conjugate pair, on each line."""
    lines = []
    for pole in sorted(poles_per_s, key=lambda p: (p.real, p.imag)):
        if pole.imag == 0.0:
            lines.append(f"{pole.real:.5g}")
        elif pole.imag > 0.0:
            lines.append(f"{pole.real:.5g} ± {pole.imag:.5g} j")
    return "\n".join(lines)


def _document(scenario: Scenario, judged: list[Judged], stable: bool) -> dict[str, Any]:
    kind = scenario.controller.kind
    content: dict[str, Any] = {
        "scenario": scenario.name,
        "controller": kind,
        "stable": stable if judged else None,
        "gain_sets": [_content(one) for one in judged],
    }
    return content if judged else content | {"note": NO_LOOP.format(kind=kind)}


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
        "sampled": {
            "control_period_s": one.pid.period_s,
            "delay_samples": one.pid.delay_samples,
            "opened_at": "force",
            "loops": [_sampled(loop) for loop in one.loops],
            "notes": list(_notes(one)),
        },
        "limit_cycle": _limit_cycle_content(one.limit_cycle) if one.limit_cycle else None,
    }


def _sampled(loop: SampledLoop) -> dict[str, Any]:
    return {
        "regime": loop.regime,
        "velocity_m_per_s": loop.velocity_m_per_s,
        "slope_n_s_per_m": loop.slope_n_s_per_m,
        "counts": loop.counts,
        **asdict(loop.margins),
        "max_sensitivity": loop.margins.max_sensitivity if loop.margins.stable else None,
    }


def _limit_cycle_content(found: LimitCycleComparison) -> dict[str, Any]:
    content = {field.name: getattr(found, field.name) for field in fields(found)}
    columns = asdict(content.pop("cycles"))
    listed = {
        name: value.tolist() if hasattr(value, "tolist") else value
        for name, value in content.items()
    }
    return {
        **listed,
        "frequency_error_percent": found.frequency_error_percent,
        "amplitude_error_percent": found.amplitude_error_percent,
        "cycles": {name: column.tolist() for name, column in columns.items()},
    }


def _named(gains: PidGains) -> dict[str, float]:
    return {"kp_n_per_m": gains.kp, "ki_n_per_m_s": gains.ki, "kd_n_s_per_m": gains.kd}


def _write(
    scenario: Scenario, judged: list[Judged], content: dict[str, Any], folder: Path
) -> list[Path]:
    """Write design.json and the figures, all of them or none."""
    from json import dumps

    from breakaway.base.output import output_folder
    from breakaway.base.ownership import DESIGN
    from breakaway.drawing.style import save_figure

    with output_folder(folder, DESIGN) as staging:
        text = dumps(plain(content), indent=2, allow_nan=False) + "\n"
        (staging / "design.json").write_text(text, encoding="utf-8", newline="\n")
        for one in judged:
            stem = "" if len(judged) == 1 else "_" + one.role.split(",")[0].replace(" ", "_")
            for name, figure in _figures(scenario, one):
                for suffix in (".png", ".svg"):
                    save_figure(figure, staging / f"{name}{stem}{suffix}")
        names = sorted(path.name for path in staging.iterdir())
    return [folder / name for name in names]


def _figures(scenario: Scenario, one: Judged) -> Iterator[tuple[str, Any]]:
    from breakaway.show.plots.design import (
        plot_bode,
        plot_limit_cycle,
        plot_nyquist,
        plot_root_locus,
    )

    about = f"{scenario.name}: {one.role}"
    yield "bode", plot_bode(one.loops, f"{about}, open loop")
    yield "nyquist", plot_nyquist(one.loops, f"{about}, open loop")
    yield "root_locus", plot_root_locus(one.loops, f"{about}, closed-loop poles")
    if one.limit_cycle:
        yield "limit_cycle", plot_limit_cycle(one.limit_cycle, f"{about}, limit cycle")
