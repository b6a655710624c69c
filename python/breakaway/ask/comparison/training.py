"""Methods that are compared on parts that they were tuned on: refused, or said loudly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from breakaway.model.scenario.method import Method


def refuse_training_parts(methods: Sequence[Method], seed: int, numbers: range) -> None:
    """Raise a ValueError where a method was tuned on some of the parts."""
    for method in methods:
        seen = method.tuned_among(seed, numbers)
        if seen is not None:
            raise ValueError(
                f"seed: {seed} takes parts {seen.start} to {seen.stop - 1}, which the method "
                f"{method.name!r} was tuned on, so its shares would be too good; give another "
                f"seed (--seed {seed + 1}), or allow_training_parts (--allow-training-parts)"
            )


def training_sentences(methods: Sequence[Method], seed: int, numbers: range) -> Iterator[str]:
    """Say of each method on how many of the parts it was tuned."""
    for method in methods:
        seen = method.tuned_among(seed, numbers)
        if seen is not None:
            yield (
                f"CAUTION: {method.name} was tuned on {len(seen):,} of these {len(numbers):,} "
                "parts, so its shares are too good; another seed has parts that it never saw"
            )
