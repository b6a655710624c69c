"""Names that a shell completes: presets, methods, populations and friction laws."""

from __future__ import annotations

from collections.abc import Callable

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
any_preset = _presets("", "populations", "methods")


def friction_laws(incomplete: str) -> list[str]:
    """Complete the last of several laws with commas between them.

    Examples
    --------
    >>> friction_laws("lugre,elas")
    ['lugre,elasto_plastic']

    """
    from breakaway.model.scenario import LAWS

    *done, last = incomplete.split(",")
    return [",".join([*done, law]) for law in LAWS if law.startswith(last)]
