"""Some of the cases of a comparison in words: laws, and how friction varies."""

from __future__ import annotations

from collections.abc import Sequence

from breakaway.run.trials import Case


def cases_in_words(cases: Sequence[Case], everyone: Sequence[Case]) -> str:
    """Name some of the cases that were asked, as short as it can be said.

    Variations are named where more than one was asked.

    Parameters
    ----------
    cases : sequence of Case
        What is named.
    everyone : sequence of Case
        All that were asked: every law with every variation.

    Examples
    --------
    >>> asked = [Case(law, how) for law in ("lugre", "gms") for how in ("field", "none")]
    >>> cases_in_words(asked, asked)
    'every law with every variation'
    >>> cases_in_words(asked[:2], asked), cases_in_words(asked[::2], asked)
    ('lugre with every variation', 'every law with field')
    >>> cases_in_words(asked[:3], asked)
    'lugre with field, lugre with none and gms with field'
    >>> cases_in_words(asked[:1], asked[::2])
    'lugre'

    """
    if len({case.variation for case in everyone}) == 1:
        return _named([case.law for case in cases], [case.law for case in everyone], "law")
    laws, variations = _both(cases)
    if len(cases) != len(laws) * len(variations):
        return listing([f"{case.law} with {case.variation}" for case in cases])
    all_laws, all_variations = _both(everyone)
    return f"{_named(laws, all_laws, 'law')} with {_named(variations, all_variations, 'variation')}"


def _both(cases: Sequence[Case]) -> tuple[list[str], list[str]]:
    """Give the laws and the variations of some cases, each once."""
    laws = dict.fromkeys(case.law for case in cases)
    return list(laws), list(dict.fromkeys(case.variation for case in cases))


def _named(words: Sequence[str], everyone: Sequence[str], kind: str) -> str:
    return f"every {kind}" if len(words) == len(everyone) > 1 else listing(words)


def listing(words: Sequence[str]) -> str:
    """Give words as a list: with commas, and an "and" before the last.

    Examples
    --------
    >>> listing(["a", "b", "c"]), listing(["a"])
    ('a, b and c', 'a')

    """
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"
