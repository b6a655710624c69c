"""What the benchmark prints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf

import numpy as np
from tests.accuracy.figures import COUNTS, worst_of
from tests.accuracy.impacts import CLOSE as CLOSE_PEAK
from tests.accuracy.impacts import Impact
from tests.accuracy.verdict import State, Verdict

QUANTILES = (0.5, 0.9, 0.97, 0.99, 1.0)
METRIC = "{:26} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8}"
WORST = 15
"""Cases that are named as the worst."""


def report(verdicts: Sequence[Verdict], seed: int) -> Iterator[str]:
    """Every table, line by line."""
    yield "Errors at the default steps; of counts, how far they are off"
    yield from _by_metric([v.errors for v in verdicts if v.errors])
    yield "\nThe same against the independent solver, where it knows the equations"
    yield from _by_metric([v.solved for v in verdicts if v.solved])
    yield "\nReferences of the first table against the independent solver"
    yield from _by_metric([v.limit for v in verdicts if v.limit])
    yield ""
    yield from _by_kind(verdicts)
    yield ""
    yield from _worst(verdicts, seed)
    yield ""
    yield from _chaotic(verdicts)
    yield from _effort(verdicts)


def _by_metric(found: Sequence[Mapping[str, float]]) -> Iterator[str]:
    yield METRIC.format(
        "metric", "cases", "median", "90 %", "97 %", "99 %", "max", "<= 1 %", "<= 5 %"
    )
    for name in found[0] if found else ():
        errors = np.array([one[name] for one in found])
        counted = name in COUNTS
        values = [
            _figure(float(e), counted) for e in np.quantile(errors, QUANTILES, method="higher")
        ]
        within = [errors <= (1 if counted else level) for level in (0.01, 0.05)]
        shares = [f"{100 * float(np.mean(close)):.1f} %" for close in within]
        yield METRIC.format(name, len(errors), *values, *shares)


def _figure(error: float, counted: bool) -> str:
    if error == inf:
        return "only one"
    return f"{error:g}" if counted else f"{100 * error:.3g} %"


def _by_kind(verdicts: Sequence[Verdict]) -> Iterator[str]:
    yield "Cases with every metric within 1 % and within 5 %, of those that are not chaotic"
    for place, what in enumerate(("law", "actuator", "controller")):
        names = sorted({v.kind.split()[place] for v in verdicts})
        for name in names:
            of = [v for v in verdicts if v.errors and v.kind.split()[place] == name]
            chaotic = sum(
                v.state is State.CHAOTIC and v.kind.split()[place] == name for v in verdicts
            )
            close, near = (sum(v.worst <= level for v in of) for level in (0.01, 0.05))
            yield (
                f"{what:10} {name:18} {close:4} and {near:4} of {len(of):4}, {chaotic:3} chaotic"
            )


def _worst(verdicts: Sequence[Verdict], seed: int) -> Iterator[str]:
    yield f"Worst; alone: python -m tests.accuracy --seed {seed} --case NUMBER"
    for v in sorted(verdicts, key=lambda v: -v.worst)[:WORST]:
        errors = max((v.errors, v.solved), key=lambda e: worst_of(e) if e else -1.0)
        name = max(errors, key=lambda n: errors[n] - (n in COUNTS), default="")
        if name:
            error = _figure(errors[name], name in COUNTS)
            yield f"{v.number:6} {v.kind:42} {name:26} {error:>9} {v.steps:6} steps, {v.state}"


def _chaotic(verdicts: Sequence[Verdict]) -> Iterator[str]:
    for state in (State.CHAOTIC, State.UNRESOLVED):
        of = [v for v in verdicts if v.state is state]
        named = ", ".join(str(v.number) for v in of)
        yield f"{state}: {len(of)} of {len(verdicts)}{': ' if of else ''}{named}"
    for v in verdicts:
        if v.unlike:
            names = ", ".join(f"{name} by {gap:.2f}" for name, gap in v.unlike.items())
            yield f"{v.number:6} {v.kind:42} is distributed otherwise at finer steps: {names}"


def _effort(verdicts: Sequence[Verdict]) -> Iterator[str]:
    steps = sum(v.steps * v.samples for v in verdicts)
    walls = [sum(v.default_wall_s for v in verdicts), sum(v.wall_s for v in verdicts)]
    yield f"{steps:.4g} steps at the default in {walls[0]:.3g} s; with references {walls[1]:.4g} s"


def report_impacts(impacts: Sequence[Impact]) -> Iterator[str]:
    """Say how far peaks are from their closed form."""
    errors = np.array([one.error for one in impacts])
    close = int(np.sum(errors <= CLOSE_PEAK))
    yield f"Peaks of impacts, tools of 0.1 to 50 kg: {close} of {len(errors)} within 1 %"
    for one in sorted(impacts, key=lambda one: -one.error)[:5]:
        yield (
            f"{one.tool_kg:6g} kg on {one.contact_n_per_m:g} N/m, T_s = {one.period_s:g} s, "
            f"{one.steps} steps: {100 * one.error:.3g} %"
        )
