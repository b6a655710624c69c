"""The controller of a rig with cascaded loops."""

from __future__ import annotations

from typing import Literal

from breakaway.model.scenario.model import Model, Positive


class Cascade(Model):
    """A position loop that sets the speed of a velocity loop, both proportional.

    ::

        F = clip(K_v (K_p (r - x) - v̂), ± F_max),    v̂ = (x_k - x_{k-2}) / (2 T_s)

    Source: A. Janot, M. Gautier, M. Brunot, "Data Set and Reference Models of EMPS", Workshop on
    Nonlinear System Identification Benchmarks, 2019; the velocity gain here includes the drive's
    gain in N/V.

    Examples
    --------
    >>> drive_gain_n_per_v = 35.15065
    >>> Cascade(
    ...     position_gain_per_s=160.18,
    ...     velocity_gain_n_s_per_m=243.45 * drive_gain_n_per_v,
    ...     force_limit_n=10.0 * drive_gain_n_per_v,
    ... ).kind
    'cascade'

    """

    kind: Literal["cascade"] = "cascade"
    """The kind of controller."""
    position_gain_per_s: Positive
    """K_p, in 1/s."""
    velocity_gain_n_s_per_m: Positive
    """K_v, in N s/m."""
    force_limit_n: Positive
    """F_max, where the drive saturates, in N."""
