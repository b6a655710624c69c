"""What nobody knows of the joint force."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from breakaway.scenario.model import Model, Positive


class UniformDisturbance(Model):
    """Joint force times ``1 + var w``, w uniform on [-1, 1] and redrawn every hold time.

    The paper says only "a random number (1 +- var)": neither distribution nor rate. Draws are
    keyed by seed, run and number of the draw.

    Examples
    --------
    >>> UniformDisturbance(var=0.05, hold_s=1e-4).acts_on
    'joint_force'

    """

    law: Literal["uniform"] = "uniform"
    """The law of the draws."""
    var: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """Relative half width of the disturbance."""
    hold_s: Positive = 1e-4
    """Time between redraws, in s; at least one control period."""
    acts_on: Literal["joint_force", "friction_level"] = "joint_force"
    """What is multiplied: the whole joint force as in the paper, which jolts a stuck joint at
    every redraw, or the friction level g only, which does not."""
