"""Checks of what an identification is asked, each named by its setting."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from breakaway.errors import LogError
from breakaway.measure.identification.laws import Parameter
from breakaway.measure.identification.record import MotionKind, Span

MOST_PARAMETERS = 24
"""Variables that the core differentiates by."""

MOST_STEPS = 10_000
"""Integrator steps from row to row."""


def known(name: str, value: str, allowed: Sequence[str]) -> None:
    """Raise `LogError` for a word that is not one of those allowed."""
    if value not in allowed:
        raise LogError(f"{name}: {value!r} is not one of {', '.join(allowed)}")


def at_least_one(name: str, value: int, most: int = 1_000_000) -> None:
    """Raise `LogError` for what is no whole number from 1 to ``most``."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise LogError(f"{name}: {value!r} is not a whole number from 1 to {most}")


def check_fixed(
    fixed: Mapping[str, float], parameters: Sequence[Parameter], motion: MotionKind
) -> None:
    """Raise `LogError` for a fixed parameter that the law lacks, or out of its range."""
    known = {one.name: one for one in parameters}
    for name, value in fixed.items():
        if name not in known:
            raise LogError(
                f"fixed (--fix): {name!r} is not a parameter of this law; those are "
                f"{', '.join(known)}"
            )
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise LogError(f"fixed.{name}: {value!r} is not a number")
        low, high = known[name].low, known[name].high
        if name == "mass_kg" and motion == "imposed":
            low = 0.0
        if not low <= value <= high:
            raise LogError(f"fixed.{name}: {value!r} is not within {low:g} to {high:g}")


def check_free(free: Sequence[str], fixed: Mapping[str, float], names: Sequence[str]) -> None:
    """Raise `LogError` for a free parameter that the law lacks, or that is fixed too."""
    for name in free:
        if name not in names:
            raise LogError(
                f"free (--free): {name!r} is not a parameter of this law; those are "
                f"{', '.join(names)}"
            )
        if name in fixed:
            raise LogError(f"free (--free): {name!r} is fixed too; name it in only one of the two")


def checked_spans(repeats: Sequence[Span]) -> list[Span]:
    """Return spans as numbers, or raise `LogError`."""
    try:
        spans = [(float(start), float(end)) for start, end in repeats]
    except (TypeError, ValueError):
        spans = [(math.nan, math.nan)]
    if not all(math.isfinite(end) for span in spans for end in span):
        raise LogError(f"repeats: {repeats!r} is not a list of (start_s, end_s), in seconds")
    return spans


def check_seed(seed: int) -> None:
    """Raise `LogError` for what cannot seed draws."""
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise LogError(f"seed: {seed!r} is not a whole number of at least 0")


def check_run(steps: int, force_limit_n: float | None, origin_m: float | None) -> None:
    """Raise `LogError` for numbers that no run can have."""
    at_least_one("steps_per_row", steps, MOST_STEPS)
    if force_limit_n is not None and not 0.0 < force_limit_n < math.inf:
        raise LogError(f"force_limit_n: {force_limit_n!r} is not > 0 and finite")
    if origin_m is not None and not math.isfinite(origin_m):
        raise LogError(f"origin_m: {origin_m!r} is not a finite position")


def check_count(law: str, parameters: Sequence[Parameter], repeats: int) -> None:
    """Raise `LogError` for more parameters than the core differentiates by."""
    if len(parameters) > MOST_PARAMETERS:
        raise LogError(
            f"repeats: {repeats} with law {law!r} make {len(parameters)} parameters, but at most "
            f"{MOST_PARAMETERS} can be fitted; give fewer repeats"
        )
