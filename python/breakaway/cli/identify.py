"""``breakaway identify``: a joint from a measured log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from breakaway.base.reading import is_file
from breakaway.cli import identify_options as options
from breakaway.cli.identified import law_tables, regression_tables
from breakaway.cli.identify_options import LawChoice, LossChoice, MotionChoice
from breakaway.cli.identify_pull import page_anyway, pull_in, tell_pull
from breakaway.cli.measured import measured, pair, rig_of
from breakaway.cli.options import (
    Between,
    DropBadRows,
    Json,
    MappingFile,
    MemoryGib,
    ResampleHz,
    Rig,
    Use,
)
from breakaway.cli.progress import counted
from breakaway.cli.show import busy, say, say_aside, say_json, say_written
from breakaway.cli.targets import check_target

if TYPE_CHECKING:
    from breakaway.measure.identification import (
        BreakawayReport,
        Identification,
        JointFile,
        Posterior,
    )
    from breakaway.measure.identification.comparison import ComparedLaw
    from breakaway.measure.logs import Log


def identify(
    log: Annotated[Path, typer.Argument(help="The measured log.")],
    law: options.Law = None,
    motion: options.Motion = MotionChoice.IMPOSED,
    asymmetric: options.Asymmetric = False,
    position_dependent: options.PositionDependent = False,
    controller: options.Controller = None,
    repeat: options.Repeat = None,
    held_out: options.HeldOut = None,
    fix: options.Fix = None,
    free: options.Free = None,
    loss: options.Loss = LossChoice.LINEAR,
    starts: options.Starts = 8,
    seed: options.Seed = 0,
    posterior: options.Posterior = 0,
    format: options.Format = None,
    mapping: MappingFile = None,
    memory_gib: MemoryGib = None,
    use: Use = None,
    out: options.Out = None,
    report: options.Report = False,
    drop_bad_rows: DropBadRows = False,
    between: Between = None,
    resample_hz: ResampleHz = None,
    rig: Rig = None,
    lowpass_hz: options.LowpassHz = None,
    decimation: options.Decimation = None,
    json: Json = False,
) -> None:
    """Identify a joint from a log of position and force.

    Without --law: mass, Coulomb and viscous friction by regression, once with
    equal friction in both directions and once with separate levels for each.
    A log of one pull from rest to slip tells neither: it gives the joint that
    `breakaway events --out` gives.
    With --law: that law is fitted by simulation, with intervals, and with what
    the log cannot tell. Ctrl-C ends a fit and shows the best so far.
    """
    if out is not None:
        from breakaway.measure.identification import JointFile

        check_target([log], out, JointFile.load, "joint file")
    page = _page(log, out) if report else None
    only_laws = {
        "--fix": fix,
        "--free": free,
        "--repeat": repeat,
        "--held-out": held_out,
        "--posterior": posterior,
        "--controller": controller,
        "--asymmetric": asymmetric,
        "--position-dependent": position_dependent,
        "--motion": motion is not MotionChoice.IMPOSED,
    }
    _refuse_unused(law, only_laws, decimation)
    read = measured(
        log,
        mapping=mapping,
        format=format.value if format else None,
        memory_gib=memory_gib,
        drop_bad_rows=drop_bad_rows,
        between=between,
        resample_hz=resample_hz,
        use=use,
    )
    stands = rig_of(rig)
    pull = pull_in(read, stands)
    if law is None and pull is not None:
        tell_pull(read, pull, log, out, page, json)
        return
    if law is None:
        _refuse_unused(law, {"--rig": rig}, decimation)
        with page_anyway(page, read, pull):
            _regress(read, log, lowpass_hz, decimation, out, page, json)
        return
    settings: dict[str, Any] = {
        "motion": motion.value,
        "asymmetric": asymmetric,
        "position_dependent": position_dependent,
        "controller": _controller(controller),
        "repeats": [_span(text, "--repeat") for text in repeat or []],
        "fixed": _fixed(fix or []),
        "free": tuple(free or ()),
        "lowpass_hz": lowpass_hz,
        "rig": stands,
        "loss": loss.value,
        "starts": starts,
        "seed": seed,
    }
    span = None if held_out is None else _span(held_out, "--held-out")
    with page_anyway(page, read, pull):
        _fit(read, law, settings, span, posterior, out, page, pull, json)


def _regress(
    measured: Log,
    path: Path,
    lowpass_hz: float | None,
    decimation: int | None,
    out: Path | None,
    page: Path | None,
    json: bool,
) -> None:
    from breakaway.measure.identification import JointFile, identify_inertia_friction
    from breakaway.measure.identification import identify as fit_law

    settings: dict[str, Any] = {"lowpass_hz": lowpass_hz, "decimation": decimation}
    given = {name: value for name, value in settings.items() if value is not None}
    with busy("identifying ..."):
        fit = identify_inertia_friction(measured, **given)
    if not json:
        say(*regression_tables(fit, measured, path))
    if page is not None:
        found = fit_law(measured, law="coulomb", method="least_squares", lowpass_hz=lowpass_hz)
        _write_report(page, found)
    if out is not None:
        JointFile.from_fit(fit, measured).save(out)
    if json:
        say_json({"log": str(path), **asdict(fit), "file": str(out) if out else None})
    if not json:
        say_written([path for path in (out, page) if path is not None])


def _fit(
    measured: Log,
    law: LawChoice,
    settings: dict[str, Any],
    held_out: tuple[float, float] | None,
    samples: int,
    out: Path | None,
    page: Path | None,
    pull: BreakawayReport | None,
    json: bool,
) -> None:
    from breakaway.errors import LogError
    from breakaway.measure.identification import compare_laws
    from breakaway.measure.identification import identify as fit_law
    from breakaway.measure.identification.result import as_dict

    compared: tuple[ComparedLaw, ...] = ()
    if law is LawChoice.COMPARE:
        if held_out is None:
            raise LogError("--law compare: needs --held-out START:END, to judge the laws by")
        if not settings["repeats"]:
            del settings["repeats"]
        with busy("comparing laws ..."):
            compared = compare_laws(measured, held_out=held_out, **settings)
        found = [one.fit for one in compared if one.pays][-1]
    else:
        with counted("fitting", "starts") as progress:
            settings["law"] = law.value
            found = fit_law(measured, progress=progress, **settings)
    predicted = None if held_out is None else found.predict(spans=[held_out])
    draws = None
    if samples:
        with counted("sampling the posterior", "steps") as progress:
            draws = found.posterior(samples, seed=settings["seed"], progress=progress)
    if not json:
        say(*law_tables(found, compared, predicted))
    if page is not None:
        _write_report(
            page, found, posterior=draws, compared=compared, held_out=predicted, events=pull
        )
    if out is not None:
        _joint(found, draws, settings["seed"], measured, pull).save(out)
    if json:
        shown = as_dict(found) | {
            "held_out_rms_error": None if predicted is None else predicted.rms_error,
            "compared": [
                {"law": one.fit.law.name, "held_out_error": one.held_out_error, "pays": one.pays}
                for one in compared
            ],
            "file": None if out is None else str(out),
        }
        say_json(shown)
    if not json:
        say_written([path for path in (out, page) if path is not None])


def _joint(
    found: Identification,
    draws: Posterior | None,
    seed: int,
    log: Log,
    pull: BreakawayReport | None,
) -> JointFile:
    """Give the joint of a fit; where it tells none, that of the pull if the log is one."""
    from breakaway.errors import LogError
    from breakaway.measure.identification import JointFile, joint_from_pull

    try:
        return JointFile.from_identification(found, draws, seed=seed)
    except LogError as error:
        if pull is None:
            raise
        say_aside(f"{error}; the joint is that of the pull, as by `breakaway events --out`")
        return joint_from_pull(log, report=pull, seed=seed)


def _write_report(path: Path, found: Identification, **parts: Any) -> None:  # noqa: ANN401
    from breakaway.show.report.identification import save_identification_report

    with busy("writing the report ..."):
        save_identification_report(path, found, **parts)


def _refuse_unused(
    law: LawChoice | None, given: Mapping[str, object], decimation: int | None
) -> None:
    """Refuse options that the way that was chosen does not use."""
    from breakaway.errors import LogError

    unused = [name for name, value in given.items() if value]
    if law is None and unused:
        raise LogError(f"{', '.join(unused)}: only for --law; give --law, or leave them out")
    if law is not None and decimation is not None:
        raise LogError("--decimation: only for the regression; leave out --decimation or --law")


def _page(log: Path, out: Path | None) -> Path:
    """Name the report's file; refuse to write over anything but another report."""
    from breakaway.errors import OutputError

    page = Path(f"{log.stem}.html") if out is None else out.with_suffix(".html")
    if page == out:
        raise OutputError(f"{out}: the report goes there; give --out another suffix")
    if is_file(page) and not _is_report(page):
        raise OutputError(f"{page}: exists and is not a report; move it, or give another --out")
    return page


def _is_report(page: Path) -> bool:
    from breakaway.base.reading import open_regular

    try:
        with open_regular(page) as file:
            return b"breakaway" in file.read(4096)
    except OSError:
        return False  # not ours to write over


def _controller(path: Path | None) -> Any:  # noqa: ANN401 - a Cascade or a Pid
    """Read the controller of a rig: a cascade, or a PID whose gains are given."""
    if path is None:
        return None
    from breakaway.base.reading import table_of, text_of
    from breakaway.errors import ScenarioError
    from breakaway.measure.identification import Cascade
    from breakaway.model.scenario import Pid
    from breakaway.model.scenario.files import parse_toml

    text = text_of(path, ScenarioError)
    kind = table_of(text, path, ScenarioError).get("kind")
    if kind not in ("cascade", "pid"):
        raise ScenarioError(f"{path}: kind: {kind!r} is not one of 'cascade', 'pid'")
    return parse_toml(Cascade if kind == "cascade" else Pid, text, path.name)


def _span(text: str, option: str) -> tuple[float, float]:
    start, end = pair(text.replace(":", "=", 1), option, "START:END")
    return _number(start, option), _number(end, option)


def _fixed(pairs: list[str]) -> dict[str, float]:
    named = (pair(text, "--fix", "NAME=VALUE") for text in pairs)
    return {name: _number(value, "--fix") for name, value in named}


def _number(text: str, option: str) -> float:
    import math

    from breakaway.errors import LogError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LogError(f"{option}: {text!r} is not a finite number")
    return value
