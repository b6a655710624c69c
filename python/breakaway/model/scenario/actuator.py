"""What turns a command into a push on the part."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.model.scenario.magnitudes import (
    Acceleration,
    Damping,
    Force,
    ForceOrZero,
    ForceRate,
    Frequency,
    Length,
    LengthOrZero,
    Mass,
    Speed,
    Stiffness,
)
from breakaway.model.scenario.model import Model


class IdealActuator(Model):
    """Delivers every commanded force, pushing or pulling."""

    kind: Literal["ideal"] = "ideal"
    """The kind of actuator."""


class PushOnlyActuator(Model):
    """A tip that pushes up to a limit and cannot pull."""

    kind: Literal["push_only"] = "push_only"
    """The kind of actuator."""
    force_max_n: Force
    """Largest force, in N."""


class ForceActuator(Model):
    """A tip that pushes behind a lag and a limit of its rate.

    ``dF/dt = clip((u - F) / tau, -rate, rate)`` with ``tau = 1 / (2 pi bandwidth_hz)`` and the
    command ``u`` limited to 0 ... ``force_max_n``: a fast hydraulic, voice-coil or pneumatic drive.

    Examples
    --------
    >>> ForceActuator(force_max_n=8000.0, bandwidth_hz=1000.0, force_rate_max_n_per_s=1e8).kind
    'force'

    """

    kind: Literal["force"] = "force"
    """The kind of actuator."""
    force_max_n: Force
    """Largest force, in N."""
    bandwidth_hz: Frequency
    """Frequency at which the force is 3 dB down, in Hz."""
    force_rate_max_n_per_s: ForceRate
    """Largest rate of the force, in N/s."""


class Contact(Model):
    """The contact between the tip and the part: a face that pushes, and in a grip one that pulls.

    Each face is a spring and a damper. With ``d`` how far the tip reaches into the part, the force
    is ``max(0, k d + c d') + min(0, k (d + backlash_m) + c d')``; without a grip, the first term.

    Examples
    --------
    >>> Contact(stiffness_n_per_m=2e8, damping_n_s_per_m=2e3).backlash_m is None
    True
    >>> Contact(stiffness_n_per_m=2e8, damping_n_s_per_m=2e3, gap_m=1e-5, backlash_m=2e-5).gap_m
    1e-05

    """

    stiffness_n_per_m: Stiffness
    """Stiffness of a face, in N/m."""
    damping_n_s_per_m: Damping
    """Damping of a face, in N s/m."""
    gap_m: LengthOrZero = 0.0
    """Distance of the tip from the part at the start, in m; in a grip at most backlash_m."""
    backlash_m: LengthOrZero | None = None
    """Play of a grip, in m: the tip pulls once the part is ahead of it by more than this. 0: it
    holds both ways without play. Left out: it only pushes."""

    @model_validator(mode="after")
    def _starts_within_its_play(self) -> Self:
        if self.backlash_m is not None and self.gap_m > self.backlash_m:
            raise ValueError(
                f"gap_m: {self.gap_m!r} is not <= backlash_m = {self.backlash_m!r}; a tip that "
                "grips starts within its play"
            )
        return self


class RigidTip(Model):
    """The tool itself touches the part."""

    kind: Literal["rigid"] = "rigid"
    """The kind of tip."""


class Piezo(Model):
    """A preloaded piezo stack on the tool, with its amplifier.

    Its rest length follows the voltage with hysteresis (Prandtl and Ishlinskii, four play operators
    at 1/16 to 4/16 of the full voltage). Blocking force: ``stiffness_n_per_m * stroke_m``; first
    resonance, foot held: ``sqrt(stiffness / tip mass) / (2 pi)``. Not modeled: creep, the
    temperature of the ceramic, depolarization.
    """

    kind: Literal["piezo"] = "piezo"
    """The kind of tip."""
    stroke_m: Length
    """Free stroke at the full voltage, in m."""
    stiffness_n_per_m: Stiffness
    """Stiffness of stack and preload spring, in N/m."""
    tip_mass_kg: Mass
    """Effective mass at the tip, which gives the first resonance, in kg."""
    damping_n_s_per_m: Damping
    """Damping of the stack, in N s/m."""
    hysteresis_share: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """Share of the stroke that lags; 0 for none."""
    preload_n: ForceOrZero
    """Preload of the relaxed stack, in N: the tension that it can bear before it is stretched."""
    capacitance_f: Annotated[float, Field(gt=0.0, le=1.0)]
    """Capacitance at large signals, in F."""
    loss_tangent: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    """Dielectric loss at 1 kHz; it heats the stack and does not act on the motion."""
    voltage_max_v: Annotated[float, Field(gt=0.0, le=1e6)]
    """Full voltage, in V."""
    current_max_a: Annotated[float, Field(gt=0.0, le=1e6)]
    """Largest current of the amplifier, in A; with the capacitance it limits the slew."""
    amplifier_bandwidth_hz: Frequency
    """Bandwidth of the amplifier on this load, in Hz."""


class FeedAxis(Model):
    """A feed axis that moves a tool against the part, with or without a piezo stack.

    The drive follows the commanded speed within its acceleration; the axis, the stack and the
    contact yield. The tip pulls only where its contact has a ``backlash_m``.

    Examples
    --------
    >>> axis = FeedAxis(
    ...     speed_max_m_per_s=0.05, acceleration_max_m_per_s2=2.0, stiffness_n_per_m=3e7,
    ...     damping_n_s_per_m=5e3, tool_mass_kg=5.0,
    ...     contact=Contact(stiffness_n_per_m=2e8, damping_n_s_per_m=2e3),
    ... )
    >>> axis.tip.kind
    'rigid'

    """

    kind: Literal["feed_axis"] = "feed_axis"
    """The kind of actuator."""
    speed_max_m_per_s: Speed
    """Largest speed of the drive, in m/s."""
    acceleration_max_m_per_s2: Acceleration
    """Largest acceleration of the drive, in m/s^2."""
    stiffness_n_per_m: Stiffness
    """Stiffness of the axis between drive and tool, in N/m."""
    damping_n_s_per_m: Damping
    """Damping of the axis, in N s/m."""
    tool_mass_kg: Mass
    """Mass of the tool, in kg."""
    tip: Annotated[RigidTip | Piezo, Field(discriminator="kind")] = RigidTip()
    """What touches the part."""
    contact: Contact
    """How it touches."""


Actuator = Annotated[
    IdealActuator | PushOnlyActuator | ForceActuator | FeedAxis, Field(discriminator="kind")
]
"""Any actuator."""
