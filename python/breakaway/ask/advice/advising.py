"""Advise: try what a rig can do on the parts that are meant, and say what follows."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from breakaway.ask.advice.measurement import design_measurement
from breakaway.ask.advice.outcome import Bounds
from breakaway.ask.advice.parts import parts_of, with_guide
from breakaway.ask.advice.ranking import difference, ranked
from breakaway.ask.advice.result import Advice, NotJudged
from breakaway.ask.advice.trying import FIRST_ROUND, Deadline, Trying, try_ways
from breakaway.ask.advice.wanted import ENOUGH, wanted_rigs
from breakaway.ask.advice.ways import ways_of
from breakaway.ask.advice.wording import rests_on, sentences_of
from breakaway.ask.advice.worth import worths
from breakaway.ask.durable.progress import Progress
from breakaway.base.arguments import check_arguments
from breakaway.base.threads import thread_count
from breakaway.errors import StudyError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.files import load_limits, load_rig
from breakaway.model.scenario.harm import HarmLimits
from breakaway.model.scenario.population import PartPopulation

USUAL_RIG = "electric_cylinder"
"""The rig that is asked where none is named."""
USUAL_BUDGET_S = 120.0
PARTS_MAX = 2000


def advise(
    parts: str | Path | PartPopulation | JointFile,
    rig: str | Path | ExtractionRig = USUAL_RIG,
    limits: str | Path | HarmLimits | None = None,
    *,
    engagement_length_m: float | None = None,
    budget_s: float = USUAL_BUDGET_S,
    parts_max: int = PARTS_MAX,
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Advice:
    """Advise how to get parts out with a rig: with what, set to what, and what it does to them.

    Every way that the rig's drive and sensors allow is tried on the same parts, under every
    friction law that a log of one pull leaves open. Settings are chosen on 16 parts and judged on
    others, in rounds, each with as many parts as all before it. A way is ranked by the share of
    parts that come out within all limits, under the law where that is least.

    Parameters
    ----------
    parts : str, Path, PartPopulation or JointFile
        A joint file, a population, or the name of a preset of populations. What a joint file does
        not tell has the ranges of ``seized_parts``, which are assumed.
    rig : str, Path or ExtractionRig
        A rig file, or the name of a preset.
    limits : str, Path or HarmLimits, optional
        What the part and its host may suffer. Left out: the gentle limits of the population, which
        are assumed.
    engagement_length_m : float, optional
        Length of the guide in m, > 0 and <= 10, which no log tells. Left out: as the population
        says, or 20 to 100 mm of a joint file, which is assumed.
    budget_s : float
        Time that trying may take, in s, > 0; the first 16 parts are tried whatever it is. How many
        parts are judged depends on it, and on the machine; the parts themselves do not.
    parts_max : int
        Most parts that are judged, at least 16. With enough time this number decides, and the same
        call gives the same bits.
    seed : int
        Seed of parts, disturbances and noise.
    threads : int, optional
        Left out: one for each processor.
    progress : callable, optional
        Called about 20 times a second with a `Progress` in seconds of the budget.

    Returns
    -------
    Advice
        After Ctrl-C with the parts that were judged until then, and says so.

    Raises
    ------
    ScenarioError
        A file is missing or not valid, the joint file tells no level of friction, or the length is
        out of range.
    StudyError
        A number is out of range.
    KeyboardInterrupt
        Ctrl-C before the first round was done.

    Notes
    -----
    Not checked: wear, heat, bonds that break for good, and ways of shops that have no model
    (``not_judged``). Intervals are those of a share of parts drawn from what is known; they do not
    know what is wrong with that.

    Examples
    --------
    >>> import breakaway as bk
    >>> advice = bk.advise("seized_parts", "screw_jack", parts_max=16, threads=1)
    >>> advice.best.way, advice.best.parts
    ('steady_feed', 16)

    """
    check_arguments(advise, locals(), StudyError)
    thread_count(threads)
    if not 0.0 < budget_s < float("inf"):
        raise StudyError(f"budget_s: {budget_s!r} is not > 0 and finite; give the seconds")
    if parts_max < FIRST_ROUND:
        raise StudyError(f"parts_max: {parts_max} is not >= {FIRST_ROUND}; give more parts")
    asked = parts_of(parts)
    if engagement_length_m is not None:
        asked = with_guide(asked, engagement_length_m)
    bounds = Bounds(
        limits if limits is None or isinstance(limits, HarmLimits) else load_limits(limits),
        asked.population.gentle,
        rig if isinstance(rig, ExtractionRig) else load_rig(rig),
    )
    trying = Trying(asked, bounds, seed, threads, Deadline(budget_s, progress))
    ways = ways_of(bounds.rig, asked.population)
    if not ways:
        raise StudyError(
            f"rig: {bounds.rig.name!r} does not even close its gap in the "
            f"{asked.population.duration_s:g} s that a part is given; raise duration_s of the parts"
        )
    tried = try_ways(ways, trying, parts_max)
    rows = ranked(tried)
    between = difference(tried, rows[0], rows[1]) if len(rows) > 1 else None
    worth = worths(tried)
    is_short = rows[0].unharmed < ENOUGH and tried.ended != "interrupted"
    wanted = wanted_rigs(rows[0], trying) if is_short else []
    measurement = design_measurement(tried, bounds)
    return Advice(
        parts=asked,
        bounds=bounds,
        tried=tried,
        ranking=tuple(rows),
        difference=between,
        worths=tuple(worth),
        wanted=tuple(wanted),
        measurement=measurement,
        not_judged=not_judged(),
        sentences=tuple(sentences_of(tried, rows, between, worth, wanted, measurement, bounds)),
        rests_on=tuple(rests_on(asked, tried, bounds, seed)),
        seed=seed,
    )


def not_judged() -> tuple[NotJudged, ...]:
    """Give the ways of shops that no model here covers."""
    text = (files("breakaway.model.presets.tables") / "not_judged.toml").read_text(encoding="utf-8")
    return tuple(NotJudged(**way) for way in tomllib.loads(text)["way"])
