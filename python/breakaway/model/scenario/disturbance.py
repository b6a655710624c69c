"""How friction varies: along the way, or as the paper draws it anew in time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from breakaway.model.scenario.model import Model, Positive

GAUSSIAN_VAR_MAX = 0.2
"""Where a Gaussian field would no longer keep all levels above zero."""


class HeldDisturbance(Model):
    """The paper's random factor: joint force times ``1 + var w``, w redrawn every hold time.

    The paper says only "a random number (1 +- var)": neither distribution nor rate. Draws are
    keyed by seed, run and number of the draw. A factor that is redrawn by the clock stops a slip at
    the next high draw, and waiting finds the lowest of many: use it to reproduce the paper.
    Friction varies along the way: `FieldDisturbance`.
    """

    kind: Literal["paper_random_factor"] = "paper_random_factor"
    """How friction varies: anew in time, as in the paper."""
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


class FieldDisturbance(Model):
    """Friction that varies along the way: levels times ``1 + s(x)``, s a stationary random field.

    A function of seed, run and place: waiting changes nothing, and a part that goes back meets the
    same friction again. Its correlation is that of a quintic B-spline, 1/e at the correlation
    length and zero from 2.9 times it on; its slope is continuous. By ``law``:

    - ``bounded``: bell-shaped within ``-var <= s <= var``, with a standard deviation of 0.428 var.
    - ``gaussian``: normal with the standard deviation var, but for ``abs(s) < 4.8 var``; var < 0.2.
    - ``log_normal``: ``1 + s = exp(var z - var**2 / 2)``, z normal.

    Examples
    --------
    >>> FieldDisturbance(var=0.3, correlation_length_m=1e-3).law
    'bounded'

    """

    kind: Literal["field"] = "field"
    """How friction varies: along the way."""
    law: Literal["bounded", "gaussian", "log_normal"] = "bounded"
    """The distribution of s."""
    var: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """Size of s: its bound, or its standard deviation; of the logarithm where it is log-normal."""
    correlation_length_m: Annotated[float, Field(ge=1e-6, le=1.0)]
    """Distance at which the correlation has fallen to 1/e, in m; 10 um to 10 mm are usual."""

    @model_validator(mode="after")
    def _stays_above_zero(self) -> Self:
        if self.law == "gaussian" and self.var >= GAUSSIAN_VAR_MAX:
            raise ValueError(
                f"var: {self.var!r} is not < {GAUSSIAN_VAR_MAX:g}, or a level could fall to zero; "
                'give a smaller one, or law = "log_normal"'
            )
        return self


def _defaults_unless_said(values: Any) -> Any:  # noqa: ANN401 - pydantic checks it afterwards
    if not isinstance(values, Mapping) or "correlation_length_m" in values:
        return values
    kind = values.get("kind", "paper_random_factor")
    if kind == "paper_random_factor" and not {"law", "bandwidth_hz"} & set(values):
        return {**values, "kind": kind, "law": "uniform"}
    return {**values, "kind": kind}


Disturbance = Annotated[
    Annotated[
        Annotated[
            UniformDisturbance | GaussianDisturbance | BandLimitedDisturbance,
            Field(discriminator="law"),
        ]
        | FieldDisturbance,
        Field(discriminator="kind"),
    ],
    BeforeValidator(_defaults_unless_said),
]
"""How friction varies."""
