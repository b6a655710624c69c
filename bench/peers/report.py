"""What was measured, as tables for the terminal and for Markdown."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from rich.console import Console
from rich.table import Table

import breakaway as bk

from .loop import oracle_iae_m_s, scenario

Measurement = dict[str, Any]

SAME_WORK = 1e-3
"""Largest relative error in IAE, of any run checked; ours is up to 7e-4 off."""
SAME_RULE = 1e-6
"""Largest relative difference to our IAE for a peer that has our rule. Rounding alone makes 1e-12,
and 1e-8 in runs that touch the end of the guide."""

RATE = "wall_s_per_simulated_s_and_run"


@cache
def _oracle(duration_s: float, run: int) -> float:
    return oracle_iae_m_s(duration_s, run)


@cache
def _ours(duration_s: float, run: int) -> float:
    return bk.simulate(scenario(duration_s), run_index=run).metrics.iae_m_s


def largest_difference(measurement: Measurement, known: Callable[[float, int], float]) -> float:
    """Of the IAE of the checked runs, relative to what is known."""
    expected = [known(measurement["duration_s"], k) for k in range(len(measurement["iae_m_s"]))]
    pairs = zip(measurement["iae_m_s"], expected, strict=True)
    return max(abs(found / iae - 1.0) for found, iae in pairs)


@dataclass
class Row:
    """One way of one peer: its single run, its batch on one thread and on all cores."""

    name: str
    integrates: str
    settings: str
    rule: str | None
    modes: dict[str, Measurement] = field(default_factory=dict)

    def rate(self, mode: str) -> float | None:
        """Wall seconds per simulated second and run; run after run, a batch is as a single run."""
        one_by_one = mode == "batch" and "batch" not in self.modes and "single" in self.modes
        return self.modes.get("single" if one_by_one else mode, {}).get(RATE)

    @property
    def measured(self) -> list[Measurement]:
        return [m for m in self.modes.values() if RATE in m]

    def error(self) -> float:
        return max(largest_difference(m, _oracle) for m in self.measured)

    def from_ours(self) -> float:
        return max(largest_difference(m, _ours) for m in self.measured)

    def faults(self) -> list[str]:
        """What failed, and whether it was the same work."""
        found = list(dict.fromkeys(m["why"] for m in self.modes.values() if "why" in m))
        # Said the other way round, a run that is not a number would pass.
        if self.measured and not self.error() <= SAME_WORK:
            found.append(f"NOT the same work: IAE off by more than {SAME_WORK:g}")
        if self.measured and self.rule == "ours" and not self.from_ours() <= SAME_RULE:
            found.append(f"NOT our rule: IAE differs from ours by more than {SAME_RULE:g}")
        return found

    def how(self) -> str:
        """Settings, and what was really simulated."""
        if not self.measured:
            return "not measured."
        spans = (f"{mode} {m['runs']} x {m['duration_s']:g} s" for mode, m in self.modes.items())
        import_s = max(m["import_s"] for m in self.measured)
        prepare_s = max(m["prepare_s"] for m in self.measured)
        not_counted = f"import {import_s:.1f} s, prepare {prepare_s:.1f} s"
        return f"{self.settings}. Measured: {', '.join(spans)}. Not counted: {not_counted}."


def rows(measurements: Iterable[Measurement]) -> list[Row]:
    """Measurements gathered into rows in the order in which they came; the faster of two counts."""
    found: dict[tuple[str, str], Row] = {}
    for m in measurements:
        key = (m["name"], m["integrates"])
        row = found.setdefault(key, Row(*key, m["settings"], m["rule"]))
        mode = m["mode"] if m["threads"] == 1 else "batch, all cores"
        row.modes[mode] = min(row.modes.get(mode, m), m, key=lambda one: one.get(RATE, math.inf))
    return list(found.values())


MODES = ("single", "batch", "batch, all cores")


def number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.2g}"


def ratio(value: float | None, to: float | None) -> float | None:
    return None if value is None or to is None else value / to


def main_table(found: list[Row], threads: int) -> list[list[str]]:
    """A line for each row, after one of headings."""
    ours = next(row for row in found if row.name == "breakaway" and row.rule == "ours")
    heads = ["single", "batch, 1 thread", f"batch, {threads} threads"]
    heading = ["peer", "what integrates, in a control period"]
    heading += [cell for head in heads for cell in (head, "÷ ours")]
    lines = [[*heading, "IAE error", "IAE from ours", "same work"]]
    for row in found:
        line = [row.name, row.integrates]
        for mode in MODES:
            line += [number(row.rate(mode)), number(ratio(row.rate(mode), ours.rate(mode)))]
        checks = [f"{row.error():.0e}", f"{row.from_ours():.0e}"] if row.measured else ["-", "-"]
        lines.append([*line, *checks, "; ".join(row.faults()) or "yes"])
    return lines


def split_table(found: list[Row]) -> list[list[str]]:
    """Lead = rule x code: what a rule takes in the same code, and the same rule in other code.

    The rules are compared in our single run, and for batches in numba's lanes: ours has
    Runge-Kutta for checking only, and it is not made for lanes.
    """
    by_name = {(row.name, row.rule): row for row in found}
    ours = by_name["breakaway", "ours"]
    heading = ["peer", "what integrates"]
    lines = [heading + [f"{mode}: {part}" for mode in MODES for part in ("lead", "rule", "code")]]
    for row in found:
        if row is ours or row.rule is None:
            continue
        line = [row.name, row.integrates]
        for mode in MODES:
            code = "breakaway" if mode == "single" else "numba, lanes"
            same, best = by_name.get((code, row.rule)), by_name.get((code, "ours"))
            lead = ratio(row.rate(mode), ours.rate(mode))
            rule = ratio(same.rate(mode), best.rate(mode)) if same and best else None
            known = lead is not None and rule is not None
            line += [number(part) for part in (lead, rule if known else None, ratio(lead, rule))]
        lines.append(line)
    return lines


def settings_lines(found: list[Row]) -> Iterator[str]:
    for row in found:
        yield f"{row.name}, {row.integrates}: {row.how()}"


def markdown_table(lines: list[list[str]]) -> str:
    """With numbers to the right."""
    rule = ["---" if k < 2 else "---:" for k in range(len(lines[0]))]
    return "\n".join(f"| {' | '.join(line)} |" for line in [lines[0], rule, *lines[1:]])


def print_table(console: Console, title: str, lines: list[list[str]]) -> None:
    table = Table(title=title, title_justify="left")
    for k, head in enumerate(lines[0]):
        table.add_column(head, justify="left" if k < 2 else "right")
    for line in lines[1:]:
        table.add_row(*line)
    console.print(table)
