"""Where the joint of a scenario is from."""

from __future__ import annotations

from breakaway.model.scenario.model import Model, Text


class JointSource(Model):
    """The log that a scenario's joint was identified from; for information, not checked.

    `breakaway.lay_over` writes it. A joint that is replaced as a whole has none.

    Examples
    --------
    >>> JointSource(log="motor.csv").dropped
    ''

    """

    log: Text
    """The log."""
    residual: Text = ""
    """Where ``joint.residual_n`` is from, which no log tells. Empty: the scenario states it."""
    dropped: Text = ""
    """What the log told of the joint and no scenario has a place for. Empty: nothing."""
    at_least: Text = ""
    """Which of its numbers are bounds from below, and why. Empty: none."""
