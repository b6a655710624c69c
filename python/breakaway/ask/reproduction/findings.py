"""Where the paper and the equations disagree, each finding with its figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.reproduction.figure_10 import PRINTED_VAR
from breakaway.ask.reproduction.readings import READINGS, Reading, equation_13, velocity_gain
from breakaway.ask.reproduction.rows import Row
from breakaway.ask.reproduction.runs import Runs
from breakaway.ask.reproduction.survey import CONFIDENCE, NAMES, DisturbanceRange
from breakaway.ask.reproduction.tables import designed
from breakaway.design.pole_placement import coulomb_fall_n_per_m
from breakaway.design.stability import LoopStability, stability
from breakaway.model.scenario.files import load_scenario
from breakaway.run.finished import Run

KNOWN_IAE_M_S = 3.0361549e-6
"""IAE of the loop without vibration, by an independent Runge-Kutta at 0.1 us."""


@dataclass(frozen=True)
class Finding:
    """A disagreement, or a claim that was checked."""

    key: str
    """A name for machines."""
    title: str
    """What was found, in one sentence."""
    printed: str
    """What the paper says."""
    ours: str
    """What we measured."""
    brief: str
    """The same in a few words, for the summary; empty for what the summary leaves out."""
    agrees: bool | None
    """Whether both agree; None where the paper prints nothing to agree with."""
    explanation: str
    """Why."""

    def to_dict(self) -> dict[str, object]:
        """Plain values."""
        return asdict(self)


def misprints() -> list[Finding]:
    """Findings that need no simulation."""

    def misprint(key: str, title: str, printed: str, ours: str, explanation: str) -> Finding:
        return Finding(f"misprint_{key}", title, printed, ours, "", False, explanation)

    return [
        misprint(
            "equation_2",
            "Equation (2) lacks the bristle stiffness",
            "dz/dt = v − |v| z / g(v)",
            "dz/dt = v − k_e |v| z / g(v)",
            "As printed the units do not match; Canudas de Wit et al. (1995) have the factor.",
        ),
        misprint(
            "equation_11",
            "The characteristic polynomial lacks an s",
            "(s + a)(s² + 2 ε ω + ω²)",
            "(s + a)(s² + 2 ε ω s + ω²)",
            "Without the s its middle term is a constant, and the gains do not follow from it.",
        ),
        misprint(
            "static_gains",
            "Two terms of the static gains are misprinted",
            "kp_s = ω² + 2 a ε ω + ω² − k_e, kd_s = (2 ε ω + a) m − ε",
            "kp_s = (ω² + 2 a ε ω) m − k_e, kd_s = (2 ε ω + a) m − c",
            "Only these give Table II.",
        ),
        misprint(
            "equation_13",
            "Equation (13) has a wrong sign, and the dynamic gains with it",
            "(1 + kp_d) m₂/m s, kp_d = (ω² + 2 a ε ω) m/m₂ − 1",
            "(kp_d − 1) m₂/m s, kp_d = (ω² + 2 a ε ω) m/m₂ + 1",
            "m x'' = m₂ u − R with R = F_c0 − m₂ x, equation (6), puts −m₂ x on the left; the "
            f"force is m₂ u. Table II does not tell which was meant: {_kp_with_both_signs()}.",
        ),
        misprint(
            "units",
            "Table I gives the Stribeck velocity in m/s², and Table II carries its caption",
            "0.09 m/s²",
            "0.09 m/s",
            "v_s divides a velocity in equation (3).",
        ),
    ]


def _kp_with_both_signs() -> str:
    """Say what the sign of (13) changes in the proportional gains of Table II."""
    scenario = load_scenario("paper_as_computed")
    said = []
    for control, words in (("without_vibration", "without"), ("with_vibration", "with")):
        gains = designed(scenario, control)
        printed, total = gains.dynamic.kp, gains.total.kp
        said.append(
            f"{words} vibration kp_d is {printed:.1f} as printed, {printed + 2.0:.1f} put right, "
            f"which changes the total by {0.9 * 2.0 / total:.1e} of itself"
        )
    return "; ".join(said)


def table_1_and_table_2(rows: list[Row]) -> Finding:
    """Judge the gains that follow from the printed joint."""
    agree = sum(row.agrees is True for row in rows)
    kd_static = designed(load_scenario("paper_as_printed"), "without_vibration").static.kd
    return Finding(
        "gains_do_not_follow_from_table_1",
        "Table II does not follow from Table I",
        "gains computed from k_e = 3.0e7 N/m and c = 1.6 k_e",
        f"{agree} of {len(rows)} gains follow from Table I, but no static kp or kd "
        f"(kd_s would be {kd_static:.3g} N s/m); "
        "all 18 follow from k_e = 3.6e7 N/m and c = 9000 N s/m",
        "",
        False,
        "c = 9000 is 1.5 √k_e. Hence two sets of presets: as printed, and as computed.",
    )


def simulated(runs: Runs) -> list[Finding]:
    """Findings from the simulations."""
    return [
        *_routh_hurwitz(runs),
        _equation_13(runs),
        _known_value(runs),
        _limit_cycle(runs),
        _as_printed(runs),
        _stable_range(runs, "without_vibration"),
        _stable_range(runs, "with_vibration"),
        *(_reading(runs, key) for key in READINGS),
        _smoother(runs),
        _jolt(runs),
    ]


def _routh_hurwitz(runs: Runs) -> list[Finding]:
    scenario = load_scenario("paper_as_computed")
    findings = []
    outcomes = {
        "without_vibration": runs.undisturbed["without_vibration"],
        "with_vibration": runs.plain_vibration_gains,
    }
    for control, run in outcomes.items():
        total = designed(scenario, control).total
        verdict = stability(total, scenario.joint, scenario.part.mass_kg).sliding
        words = control.replace("_", " ")
        findings.append(
            Finding(
                f"routh_hurwitz_{control}",
                f"The gains {words} are {'stable' if verdict.stable else 'unstable'} while the "
                "part slides, by Newton's m x'' = F − R",
                "stable up to a disturbance range",
                f"{verdict.reason}, largest real part of a pole {_rightmost(verdict)}; as a plain "
                f"PID on an ideal actuator, undisturbed, the run {_ending(run)}",
                f"kp kd / m > ki, largest real part {_rightmost(verdict)}"
                if verdict.stable
                else f"kp kd / m < ki, largest real part {_rightmost(verdict)}; as a plain PID "
                f"{_ending(run)}",
                verdict.stable,
                "Routh-Hurwitz for s³ + kd/m s² + kp/m s + ki/m: stable if kp kd / m > ki. "
                "Gating the force by a duty cycle scales both sides and does not help.",
            )
        )
    return findings


def _rightmost(loop: LoopStability) -> str:
    """Give the largest real part of a pole."""
    return f"{max(pole.real for pole in loop.poles_per_s):+.3g} 1/s"


def _equation_13(runs: Runs) -> Finding:
    scenario = runs.oracle.scenario
    m2 = coulomb_fall_n_per_m(scenario.joint, scenario.part.mass_kg)
    without, with_it = (equation_13(c) for c in ("without_vibration", "with_vibration"))
    return Finding(
        "equation_13",
        "By the paper's (13), whose loop is multiplied by m₂, the gains with vibration are stable",
        "s³ + kd m₂/m s² + (1 + kp) m₂/m s + ki m₂/m",
        f"largest real part of a pole {_rightmost(with_it)} with the gains with vibration, "
        f"{_rightmost(without)} with those without; multiplied by m₂, as a plain PID, undisturbed, "
        f"the run with the gains with vibration {_ending(runs.plain_vibration_gains_times_m2)}",
        f"largest real part {_rightmost(with_it)}",
        with_it.stable,
        f"m₂ = {m2:.1f} N/m, equation (12), is a gain in (13) and in the paper's block diagram. "
        "Table II's totals taken in N/m, N s/m and N/(m s) act on Newton's law without it.",
    )


def _known_value(runs: Runs) -> Finding:
    ours, oracle = (r.metrics.iae_m_s for r in (runs.undisturbed["without_vibration"], runs.oracle))
    return Finding(
        "iae_without_vibration",
        "The loop without vibration has an IAE of 3.036e-6 m s",
        "no number; points of figure 10",
        f"{ours:.7e} m s at one step per control period; Runge-Kutta at 0.1 µs {oracle:.7e} m s "
        f"({oracle / KNOWN_IAE_M_S - 1:+.1e} of the independent {KNOWN_IAE_M_S:.7e}); "
        f"peak force {runs.oracle.metrics.peak_force_n:.4f} N",
        f"{ours:.4e} m s, {ours / oracle - 1:+.0e} of Runge-Kutta's",
        None,
        f"Our integrator errs by {ours / oracle - 1:+.1e} with a hundredth of the steps.",
    )


def _limit_cycle(runs: Runs) -> Finding:
    run, damped = runs.undisturbed["without_vibration"], runs.damped
    return Finding(
        "limit_cycle",
        "A Stribeck-driven oscillation runs from 0.03 to 0.12 s",
        "not mentioned",
        f"about {oscillation_hz(run, 0.03, 0.12):.0f} Hz, peak force "
        f"{run.metrics.peak_force_n:.0f} N; with kd = 2500 instead of 724 N s/m it is gone: IAE "
        f"{damped.metrics.iae_m_s:.2e} m s, peak {damped.metrics.peak_force_n:.0f} N",
        f"{oscillation_hz(run, 0.03, 0.12):.0f} Hz, peak {run.metrics.peak_force_n:.0f} N",
        None,
        "The friction curve falls by up to 858 N s/m at 0.064 m/s, more than kd damps. It is no "
        "numerical artifact: Runge-Kutta at 0.1 µs gives "
        f"{oscillation_hz(runs.oracle, 0.03, 0.12):.0f} Hz and "
        f"{runs.oracle.metrics.peak_force_n:.0f} N.",
    )


def oscillation_hz(run: Run, start_s: float, end_s: float) -> float:
    """Dominant frequency of the tracking error within a time window, in Hz."""
    t = run.trace["t_s"]
    window = (t >= start_s) & (t < end_s)
    error = (run.trace["reference_m"] - run.trace["position_m"])[window]
    spectrum = np.abs(np.fft.rfft((error - error.mean()) * np.hanning(error.size), 8 * error.size))
    spacing = float(t[1] - t[0])
    return float(np.fft.rfftfreq(8 * error.size, spacing)[int(np.argmax(spectrum))])


def _as_printed(runs: Runs) -> Finding:
    run = runs.as_printed
    return Finding(
        "as_printed_does_not_move",
        "With Tables I and II exactly as printed the part is not extracted",
        "extracted",
        f"the run {_ending(run)}, having moved {run.metrics.final_position_m * 1e6:.1f} µm",
        _ending(run),
        False,
        "c = 4.8e7 N s/m resists the first micrometer with more force than 20 F_s0.",
    )


def _stable_range(runs: Runs, control: str) -> Finding:
    survey, printed = runs.ranges[control], PRINTED_VAR[control]
    ours, top = survey.largest_stable_var, survey.var[-1]
    found = "none: it diverges undisturbed" if ours is None else _survived(ours, top)
    found += f"; {_diverged_near(survey, printed)}"
    if control == "with_vibration":
        bounded = runs.ranges["with_vibration_bounded"]
        found += (
            f"; the reading that stays bounded: {_survived(bounded.largest_stable_var, top)}; "
            f"{_diverged_near(bounded, printed)}; it released "
            f"{bounded.released.min():,} of {bounded.runs:,} at the worst level"
        )
    return Finding(
        f"largest_stable_var_{control}",
        f"The largest survived disturbance {control.replace('_', ' ')} is not the printed one",
        f"var = {printed:.1%}",
        found,
        "none, diverges at 0" if ours is None else _survived(ours, top),
        ours == printed,
        f"Survived means: none of {survey.runs:,} runs at this level or any below it "
        "diverged (|e| above l_f / 2 or |F| above 20 F_s0); w uniform on [-1, 1], redrawn every "
        "0.1 ms. The paper names neither distribution, nor rate, nor number of runs.",
    )


def _reading(runs: Runs, key: str) -> Finding:
    """Say what the loop survives if m2 multiplies more than nothing."""
    reading, ranges = READINGS[key], runs.readings[key]
    plain = ranges["without_vibration"]
    without, literal, bounded = (
        _survived(ranges[control].largest_stable_var, plain.var[-1]) for control in NAMES
    )
    iae_m_s = np.median(plain.iae_m_s[plain.level(PRINTED_VAR["without_vibration"])])
    return Finding(
        f"reading_{key}",
        f"With {reading.name} the printed limits do not come out either",
        "; ".join(f"var = {var:.1%} {c.replace('_', ' ')}" for c, var in PRINTED_VAR.items()),
        f"without vibration {without}; with vibration, as printed, {literal}; bounded {bounded}; "
        f"median IAE without vibration {iae_m_s:.2e} m s at var = 12.5%",
        f"without {without}; with {literal}; bounded {bounded}",
        all(ranges[c].largest_stable_var == var for c, var in PRINTED_VAR.items()),
        f"{plain.runs} runs at each of var = {', '.join(f'{var:.1%}' for var in plain.var)}, with "
        f"the draws of figure 10. {_sampling(reading)}",
    )


def _sampling(reading: Reading) -> str:
    """Say how often the controller has to be sampled."""
    usual_s = load_scenario("paper_as_computed").timing.control_period_s
    at, usually = (
        f"{velocity_gain(reading, period_s):.2g} at {1e-6 / period_s:g} MHz"
        for period_s in (reading.control_period_s, usual_s)
    )
    said = at if at == usually else f"{at} as here, {usually}"
    return f"kd T_s / m is {said}; above 2 a sampled loop diverges."


def _diverged_near(survey: DisturbanceRange, printed: float) -> str:
    """Say how many runs diverged at the level nearest to a printed limit."""
    row = survey.rows()[survey.level(printed)]
    bound = row["diverged_upper_bound"]
    said = f"{row['diverged']:,} of {row['runs']:,} diverged at var = {row['var']:.1%}"
    if bound is None or bound == 1.0:
        return said
    return f"{said}, a probability of at most {bound:.2g} at {100 * CONFIDENCE:g} % confidence"


def _survived(var: float | None, largest_tried: float) -> str:
    if var is None:
        return "none"
    return f"at least var = {var:.0%}" if var == largest_tried else f"var = {var:.1%}"


def _smoother(runs: Runs) -> Finding:
    level = runs.ranges["without_vibration"].level(0.05)
    plain, pulsed = (
        runs.ranges[control] for control in ("without_vibration", "with_vibration_bounded")
    )
    peak, jump, iae = (
        f"{_spread(getattr(pulsed, name)[level], factor)} {unit} with (bounded reading), "
        f"{_spread(getattr(plain, name)[level], factor)} {unit} without"
        for name, factor, unit in (
            ("peak_force_n", 1.0, "N"),
            ("largest_jump_m", 1e3, "mm"),
            ("iae_m_s", 1e6, "µm s"),
        )
    )
    return Finding(
        "vibration_does_not_lower_the_force",
        "Vibration does not lower the force amplitude here",
        "the force with vibration is smoother, its amplitude lower",
        f"var = {plain.var[level]:.3g}, median and 5 to 95 % of {plain.runs:,} runs: "
        f"peak force {peak}; largest jump {jump}; IAE {iae}",
        f"median peak {np.nanmedian(pulsed.peak_force_n[level]):.0f} N with, "
        f"{np.nanmedian(plain.peak_force_n[level]):.0f} N without",
        False,
        "Each pulse throws the part ahead of the reference; the PID's output then turns negative, "
        "which a tip that only pushes cannot follow, and the part waits. This loop is chaotic: "
        "a single run is no measurement, and only figures over many runs are quoted.",
    )


def _spread(values: NDArray[np.float64], factor: float) -> str:
    low, median, high = np.nanpercentile(values * factor, [5, 50, 95])
    return f"{median:.3g} ({low:.3g} to {high:.3g})"


def _jolt(runs: Runs) -> Finding:
    on_force, on_level = runs.half_push["joint_force"], runs.half_push["friction_level"]
    return Finding(
        "disturbance_jolts_a_stuck_joint",
        "The paper's disturbance lets a stuck joint creep at half its breakaway force",
        "a random factor on the joint force describes uncertainty",
        "a constant push of half of F_s0 for 4 s at var = 30 % moves the part by "
        f"{on_force.metrics.final_position_m * 1e3:.2f} mm with the factor on the joint force, by "
        f"{on_level.metrics.final_position_m * 1e3:.4f} mm with it on the friction level only",
        f"{on_force.metrics.final_position_m * 1e3:.1f} mm in 4 s at var = 30 %",
        None,
        "Each redraw rescales the elastic force of a stuck joint and jolts it. The artifact "
        "flatters every force; the option acts_on = 'friction_level' avoids it.",
    )


def _ending(run: Run) -> str:
    m = run.metrics
    if run.outcome == "diverged":
        return f"diverged at {m.simulated_s:.3f} s"
    if np.isfinite(m.time_to_release_s):
        return f"released at {m.time_to_release_s:.2f} s"
    return f"not released but {m.final_position_m * 1e3:.3g} mm from the seat"
