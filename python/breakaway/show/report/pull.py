"""The report of a pull, or of a log that gave no fit: one page, whatever came out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isinf
from pathlib import Path

from markupsafe import Markup

from breakaway._core import __version__
from breakaway.base.output import write_atomically
from breakaway.errors import LogError
from breakaway.measure.identification.events import BreakawayReport
from breakaway.measure.identification.joint_file import JointFile
from breakaway.measure.logs.log import Log
from breakaway.model.units import unit_of, words_of
from breakaway.show.plots.events import plot_breakaway
from breakaway.show.report.page import drawn_svg, render


@dataclass(frozen=True)
class Row:
    """A figure with its interval, or an assumed value with its range, as text."""

    words: str
    bound: str
    value: str
    low: str
    high: str
    unit: str
    why: str


def save_pull_report(
    path: Path,
    log: Log,
    *,
    report: BreakawayReport | None = None,
    joint: JointFile | None = None,
    because: str = "",
) -> None:
    """Write what a log showed of a joint, or ``because`` of what it showed none.

    Raises
    ------
    OutputError
        The folder cannot be made or not be written to, or the disk is full.

    """
    title = "no joint identified" if joint is None else "a pull from rest to slip"
    refused = () if report is None else report.refused
    notes = () if joint is None else joint.provenance.notes
    findings = (str(finding) for finding in log.findings)
    page = render(
        "pull.html.j2",
        version=__version__,
        log=log.name,
        title=title,
        headline=because or _headline(joint),
        digest=log.sha256,
        seen=list(_seen(joint)),
        assumed=list(_assumed(joint)),
        figure=_figure(log, report),
        lines=[*refused, *notes, *log.history, *findings],
    )
    write_atomically(path, page.encode())


def _headline(joint: JointFile | None) -> str:
    if joint is None or joint.joint.stiction_n is None:
        return ""
    at_least = "at least " if "joint.stiction_n" in joint.at_least else ""
    held = f"The joint held {at_least}{joint.joint.stiction_n:.4g} N"
    if "joint.coulomb_n" in joint.assumed:
        return f"{held}."
    return f"{held}, and slid at {joint.joint.coulomb_n:.4g} N."


def _seen(joint: JointFile | None) -> Iterator[Row]:
    if joint is None:
        return
    known: dict[str, float] = {
        path.split(".")[1]: value for path, value in joint.scenario_changes().items()
    }
    if joint.pull is not None and joint.pull.release_speed_m_per_s is not None:
        known["release_speed_m_per_s"] = joint.pull.release_speed_m_per_s
    for name, (low, high) in joint.interval.items():
        why = joint.at_least.get(f"joint.{name}", "")
        end = "" if isinf(high) else _number(high)
        bound = "at least" if why else ""
        yield Row(words_of(name), bound, _number(known[name]), _number(low), end,
                  unit_of(name).symbol, why)  # fmt: skip


def _assumed(joint: JointFile | None) -> Iterator[Row]:
    for path, one in joint.assumed.items() if joint else ():
        name = path.split(".")[1]
        usual, low, high = (_number(value) for value in (one.value, one.low, one.high))
        yield Row(words_of(name), "", usual, low, high, unit_of(name).symbol, one.why)


def _number(value: float) -> str:
    return f"{value:.5g}"


def _figure(log: Log, report: BreakawayReport | None) -> Markup | None:
    """Draw the first start; nothing where the log has too little for a drawing."""
    if report is None:
        return None
    try:
        return drawn_svg(plot_breakaway(log, report), "start")
    except LogError:
        return None
