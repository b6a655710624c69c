"""``breakaway identify`` on a pull from rest to slip, and what it writes where no fit comes out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from breakaway.base.reading import is_file
from breakaway.cli.pulled import joint_tables
from breakaway.cli.show import busy, say, say_aside, say_json, say_written
from breakaway.errors import LogError

if TYPE_CHECKING:
    from breakaway.measure.identification import BreakawayReport, JointFile, RigFile
    from breakaway.measure.logs import Log


def pull_in(log: Log, rig: RigFile | None) -> BreakawayReport | None:
    """Give what was found of a pull from rest to slip; None where the log is something else."""
    from breakaway.measure.identification import find_breakaway_events
    from breakaway.measure.identification.pull import is_pull

    try:
        report = find_breakaway_events(log, rig=rig)
    except LogError:
        return None  # whoever fits the log says what is wrong with it
    return report if is_pull(report) else None


def tell_pull(
    log: Log, report: BreakawayReport, path: Path, out: Path | None, page: Path | None, json: bool
) -> None:
    """Show the joint of a pull, and write its file and its page."""
    from breakaway.measure.identification import joint_from_pull

    joint = joint_from_pull(log, report=report)
    if not json:
        say(f"{path}: one pull from rest to slip; the joint is that of `breakaway events --out`")
        say(*joint_tables(joint))
    if out is not None:
        joint.save(out)
    if page is not None:
        write_page(page, log, report, joint)
    if json:
        told = joint.model_dump(mode="json", exclude={"draws"})
        say_json({"log": str(path), **told, "file": str(out) if out else None})
    else:
        say_written([one for one in (out, page) if one is not None])


def write_page(
    page: Path,
    log: Log,
    report: BreakawayReport | None,
    joint: JointFile | None,
    because: str = "",
) -> None:
    """Write the page of a pull, or of a log of which no joint comes."""
    from breakaway.show.report.pull import save_pull_report

    with busy("writing the report ..."):
        save_pull_report(page, log, report=report, joint=joint, because=because)


@contextmanager
def page_anyway(page: Path | None, log: Log, report: BreakawayReport | None) -> Iterator[None]:
    """Write a page with the reason where a log cannot be fitted, and so has none.

    An error that is the options' leaves no page: then the plainest fit of the log works.
    """
    before = None if page is None or not is_file(page) else page.stat().st_mtime_ns
    try:
        yield
    except LogError as error:
        unwritten = page is not None and (not is_file(page) or page.stat().st_mtime_ns == before)
        if page is not None and unwritten and not _can_be_fitted(log):
            write_page(page, log, report, None, because=str(error))
            say_aside(f"wrote {page}")
        raise


def _can_be_fitted(log: Log) -> bool:
    from breakaway.measure.identification import identify

    try:
        identify(log, law="coulomb", method="least_squares")
    except LogError:
        return False
    return True
