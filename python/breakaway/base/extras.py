"""Packages that are installed on request, as extras of breakaway."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from breakaway.errors import StudyError


def pandas() -> Any:  # noqa: ANN401 - pandas is optional
    """Import pandas.

    Raises
    ------
    StudyError
        It is not installed.

    """
    try:
        return import_module("pandas")
    except ImportError:
        raise StudyError(
            "pandas is not installed; install it with: pip install 'breakaway[pandas]'"
        ) from None
