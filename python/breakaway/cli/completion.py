"""Names that a shell completes: presets, methods, populations, friction laws and variations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

Completion = Callable[[str], list[str]]


def _presets(*folders: str) -> Completion:
    def matching(incomplete: str) -> list[str]:
        from breakaway.model.scenario.files import preset_names

        names = [name for folder in folders for name in preset_names(folder)]
        return [name for name in names if name.startswith(incomplete)]

    return matching


scenario_preset = _presets("")
population_preset = _presets("populations")
method_preset = _presets("methods")
rig_preset = _presets("rigs")
any_preset = _presets("", "populations", "methods")


def friction_laws(incomplete: str) -> list[str]:
    """Complete the last of several laws with commas between them.

    Examples
    --------
    >>> friction_laws("lugre,elas")
    ['lugre,elasto_plastic']

    """
    from breakaway.model.scenario import LAWS

    return _last_of_several(incomplete, LAWS)


def friction_variations(incomplete: str) -> list[str]:
    """Complete the last of several kinds of variation with commas between them.

    Examples
    --------
    >>> friction_variations("field,pap")
    ['field,paper_random_factor']

    """
    from breakaway.model.scenario.variation import VARIATIONS

    return _last_of_several(incomplete, VARIATIONS)


def _last_of_several(incomplete: str, known: Sequence[str]) -> list[str]:
    *done, last = incomplete.split(",")
    return [",".join([*done, word]) for word in known if word.startswith(last)]
