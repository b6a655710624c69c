"""Before anything is fitted: what a log excites, and how well it could tell each parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from breakaway.base.arguments import check_arguments
from breakaway.errors import LogError
from breakaway.measure.identification.cascade import Cascade
from breakaway.measure.identification.faults.rig import idle, rig_parameters
from breakaway.measure.identification.guess import Scales, internal_guess, scales, stand_in
from breakaway.measure.identification.lag import Lag
from breakaway.measure.identification.laws import Law, LawName, Layout, check_law
from breakaway.measure.identification.output_error import Problem
from breakaway.measure.identification.record import (
    MOTIONS,
    MotionKind,
    Rows,
    RunSettings,
    Span,
    core_record,
    measured_rows,
    predicted_channel,
    segments_of,
)
from breakaway.measure.identification.settings import (
    check_count,
    check_fixed,
    check_free,
    checked_spans,
    known,
)
from breakaway.measure.identification.verdicts import (
    Excitation,
    Places,
    Verdict,
    excitation,
    unexcited,
)
from breakaway.measure.logs.derived import noise_floor
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.controller import Pid


@dataclass(frozen=True, eq=False)
class Prepared:
    """A problem as it is handed to the optimizer, and what was found out on the way."""

    rows: Rows
    places: Places
    spans: tuple[Span, ...]
    segments: tuple[tuple[int, int], ...]
    owners: tuple[int, ...]
    held: Mapping[str, float]
    neutral: Mapping[str, float]
    held_back: tuple[Verdict, ...]
    excitation: Excitation
    sizes: Scales
    problem: Problem
    guess: Array
    spread: Array
    bounds: tuple[Array, Array]


def prepare(
    log: Log,
    law: Law,
    settings: RunSettings,
    repeats: Sequence[Span],
    fixed: Mapping[str, float],
    free: Sequence[str],
    guesses: Mapping[str, float],
    method: str = "output_error",
) -> Prepared:
    """Cut the rows, hold what they do not excite, and find where a fit would start.

    Raises
    ------
    LogError
        As `breakaway.identify`.

    """
    rows = measured_rows(log, settings)
    spans, segments, owners = segments_of(rows, checked_spans(repeats))
    parameters = (*law.parameters(len(spans)), *rig_parameters(settings.motion))
    names = [one.name for one in parameters]
    check_fixed(fixed, parameters, settings.motion)
    check_free(free, fixed, names)
    check_count(law.name, parameters, len(spans))
    places = np.concatenate([np.arange(first, end) for first, end in segments])
    sizes = scales(rows, places, fixed.get("mass_kg"))
    shown = excitation(rows, places, sizes.mass_kg if sizes.mass_shows else 0.0)
    candidates = [name for name in names if name not in fixed and name not in free]
    mass_shows = sizes.mass_shows or method == "least_squares"
    back = unexcited(candidates, shown, settings, mass_shows)
    resting = idle(names, (*free, *fixed))
    neutral = {name: value for name, (value, _) in back.items()} | {**resting, **fixed}
    numbers = {**stand_in(law, settings, sizes), **neutral}
    layout = Layout.of(parameters, numbers, tuple(owners))
    channel = predicted_channel(settings.motion)
    measured = np.ascontiguousarray(rows.columns[0 if channel == "position_m" else 3][places])
    scale = 0.05 * sizes.force_n if channel == "force_n" else 0.01 * sizes.travel_m
    record = core_record(rows, segments, law, settings)
    lag = Lag.of(log.t_s, segments, position=channel == "position_m")
    guess, spread, bounds = internal_guess(layout, sizes, settings, guesses)
    return Prepared(
        rows=rows,
        places=places,
        spans=tuple(spans),
        segments=tuple(segments),
        owners=tuple(owners),
        held=dict(fixed),
        neutral=neutral,
        held_back=tuple(verdict for _, verdict in back.values()),
        excitation=shown,
        sizes=sizes,
        problem=Problem(record, layout, channel, measured, scale, lag),
        guess=guess,
        spread=spread,
        bounds=bounds,
    )


@dataclass(frozen=True)
class Identifiability:
    """What a log can determine, known before anything is fitted.

    ``expected_error`` are the smallest standard errors that any fit can reach, near the first
    guess, if the law holds and the sensors' white noise is all that disturbs (Cramér and Rao);
    those of positive parameters are relative. ``held`` are the parameters that the log does not
    excite, with the experiment that would tell them.
    """

    excitation: Excitation
    expected_error: Mapping[str, float]
    held: tuple[Verdict, ...]


def identifiability(
    log: Log,
    *,
    law: LawName = "lugre",
    motion: MotionKind = "imposed",
    asymmetric: bool = False,
    position_dependent: bool = False,
    controller: Cascade | Pid | None = None,
    repeats: Sequence[Span] = (),
    fixed: Mapping[str, float] | None = None,
    guesses: Mapping[str, float] | None = None,
) -> Identifiability:
    """Report which parameters a log can determine, without fitting any.

    ::

        error = √(diag((Jᵀ J)⁻¹)) s        J: slopes at the first guess, s: noise of the channel

    Parameters
    ----------
    log : Log
        As for `identify`.
    law : {'coulomb', 'stribeck', 'lugre', 'elasto_plastic'}
        As for `identify`.
    motion : {'imposed', 'free', 'closed_loop'}
        As for `identify`.
    asymmetric : bool
        As for `identify`.
    position_dependent : bool
        As for `identify`.
    controller : Cascade or Pid, optional
        For ``closed_loop``.
    repeats : sequence of (start_s, end_s)
        Spans that would be fitted.
    fixed : mapping of str to float, optional
        Parameters that would be held.
    guesses : mapping of str to float, optional
        Values near which the errors are expected, by parameter; by default a regression's.

    Returns
    -------
    Identifiability

    Raises
    ------
    LogError
        As `identify`.

    Notes
    -----
    Not checked: that the law holds, and that the first guess is near: where it is far, so may the
    errors be; ``guesses`` says what is known better. A direction in which the
    slopes vanish has an infinite error.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(4000) / 1000.0
    >>> x = 0.1 * np.sin(3 * t_s) + 0.02 * np.sin(11 * t_s)
    >>> v = 0.3 * np.cos(3 * t_s) + 0.22 * np.cos(11 * t_s)
    >>> log = Log(t_s=t_s, position_m=x, force_n=5.0 * np.sign(v) + 20.0 * v)
    >>> report = identifiability(log, law="coulomb")
    >>> report.excitation.reversals, [one.parameter for one in report.held]
    (10, ['mass_kg'])

    """
    check_arguments(identifiability, locals(), LogError)
    chosen = check_law(law, asymmetric, position_dependent)
    known("motion", motion, MOTIONS)
    steps = 4 if motion == "imposed" else 1
    settings = RunSettings(motion=motion, controller=controller, steps=steps)
    asked = prepare(log, chosen, settings, repeats, fixed or {}, (), guesses or {})
    floor = noise_floor(log, asked.problem.channel)
    noise = max(floor.white, floor.quantization) / asked.problem.scale
    _, slopes = asked.problem.residual_and_slopes(asked.guess)
    size = np.linalg.norm(slopes, axis=0)
    names = [one.name for one in asked.problem.layout.free]
    errors = np.full(len(names), np.inf)
    told = size > 0.0
    if told.any():
        _, singular, right = np.linalg.svd(slopes[:, told] / size[told], full_matrices=False)
        with np.errstate(divide="ignore"):
            errors[told] = noise * np.linalg.norm(right.T / singular, axis=1) / size[told]
    return Identifiability(
        excitation=asked.excitation,
        expected_error=dict(zip(names, errors.tolist(), strict=True)),
        held=asked.held_back,
    )
