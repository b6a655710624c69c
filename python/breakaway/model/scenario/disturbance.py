"""What is unknown about the joint force."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from breakaway.model.scenario.model import Model, Positive


class HeldDisturbance(Model):
    """What every disturbance has: joint force times ``1 + var w``, w redrawn every hold time.

    The paper says only "a random number (1 +- var)": neither distribution nor rate. Draws are
    keyed by seed, run and number of the draw.
    """

    hold_s: Positive = 1e-4
    """Time between redraws, in s; at least one control period."""
    acts_on: Literal["joint_force", "friction_level"] = "joint_force"
    """What is multiplied: the whole joint force as in the paper, which jolts a stuck joint at
    every redraw, or the friction level g only, which does not."""


class UniformDisturbance(HeldDisturbance):
    """Joint force times ``1 + var w``, w uniform on [-1, 1] and redrawn every hold time.

    Examples
    --------
    >>> UniformDisturbance(var=0.05, hold_s=1e-4).acts_on
    'joint_force'

    """

    law: Literal["uniform"] = "uniform"
    """The law of the draws."""
    var: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """Relative half width of the disturbance."""


class GaussianDisturbance(HeldDisturbance):
    """Joint force times ``1 + var w``, w normal with variance 1 and redrawn every hold time.

    The law is restricted to abs(w) <= 4, so the joint force keeps its sign.

    Examples
    --------
    >>> GaussianDisturbance(var=0.1).law
    'gaussian'

    """

    law: Literal["gaussian"] = "gaussian"
    """The law of the draws."""
    var: Annotated[float, Field(ge=0.0, lt=0.25)] = 0.0
    """Relative standard deviation of the disturbance."""


class BandLimitedDisturbance(HeldDisturbance):
    """Joint force times ``1 + var w``, w normal noise of variance 1 behind a low-pass.

    The low-pass is of first order, ``w <- a w + sqrt(1 - a**2) xi`` with
    ``a = exp(-2 pi bandwidth_hz hold_s)``, from its stationary law on, and limited to abs(w) <= 4.

    Examples
    --------
    >>> BandLimitedDisturbance(var=0.1, bandwidth_hz=50.0).hold_s
    0.0001

    """

    law: Literal["band_limited"] = "band_limited"
    """The law of the draws."""
    var: Annotated[float, Field(ge=0.0, lt=0.25)] = 0.0
    """Relative standard deviation of the disturbance."""
    bandwidth_hz: Positive
    """Corner frequency of the low-pass, in Hz. Above 1 / (2 pi hold_s) the draws are nearly
    independent."""


def _uniform_unless_said(values: Any) -> Any:  # noqa: ANN401 - pydantic checks it afterwards
    if isinstance(values, Mapping) and not {"law", "bandwidth_hz"} & set(values):
        return {**values, "law": "uniform"}
    return values


Disturbance = Annotated[
    Annotated[
        UniformDisturbance | GaussianDisturbance | BandLimitedDisturbance,
        Field(discriminator="law"),
    ],
    BeforeValidator(_uniform_unless_said),
]
