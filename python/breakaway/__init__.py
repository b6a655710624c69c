"""Free seized parts: identify a joint, design a controller, simulate the extraction.

>>> import breakaway as bk
>>> run = bk.simulate(bk.load_scenario("paper_as_computed"))
>>> str(run.outcome)
'released'
"""

from __future__ import annotations

import importlib
from typing import Any


def _homes() -> dict[str, str]:
    """Read where each public name lives: the stub lists them once, for type checkers and for this.

    Each of its lines reads ``from HOME import NAME as NAME``.
    """
    with open(f"{__path__[0]}/__init__.pyi", encoding="utf-8") as stub:  # noqa: PTH123 - quicker
        words = [line.split() for line in stub if line.startswith("from ")]
    return {name: home for _, home, _, name, *_ in words}


_HOME_OF = _homes()

__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever the name stands for
    """Load a name on its first use, so that ``import breakaway`` stays quick."""
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module 'breakaway' has no attribute {name!r}")
    if home == __name__:
        return importlib.import_module(f"{home}.{name}")
    value = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
