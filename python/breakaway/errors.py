"""Errors that users meet. Their messages name the field, the value, the range and the remedy."""

from __future__ import annotations


class BreakawayError(Exception):
    """Base of every error that breakaway raises on purpose.

    The command line prints its message without a traceback and exits with ``exit_code``.

    Examples
    --------
    >>> raise LogError("motor.csv: column 'force_n' is missing; its columns are t_s, position_m")
    Traceback (most recent call last):
        ...
    breakaway.errors.LogError: motor.csv: column 'force_n' is missing; its columns are ...
    """

    exit_code = 1


class ScenarioError(BreakawayError):
    """A scenario, or a file that is laid over one, is not valid."""

    exit_code = 2


class StudyError(BreakawayError):
    """A batch or a study cannot be run as asked: its file, its variations or its folder."""

    exit_code = 2


class LogError(BreakawayError):
    """A measured log cannot be read, or cannot carry the analysis that was asked for."""

    exit_code = 2


class OutputError(BreakawayError):
    """A result cannot be written where it was asked to go."""

    exit_code = 3
