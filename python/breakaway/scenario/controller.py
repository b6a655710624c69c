"""What decides how hard to push."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.scenario.model import Fraction, Model, NotNegative, Positive


class Gains(Model):
    """PID gains, given as numbers. Negative ones are allowed: the printed paper has some."""

    kind: Literal["given"] = "given"
    """Where the gains come from."""
    kp_n_per_m: float
    """Proportional gain, in N/m."""
    ki_n_per_m_s: float
    """Integral gain, in N/(m s)."""
    kd_n_s_per_m: float
    """Derivative gain, in N s/m."""


class PolePlacement(Model):
    """PID gains from the joint, by pole placement (section 4.1 of the paper)."""

    kind: Literal["pole_placement"] = "pole_placement"
    """Where the gains come from."""
    settling_time_s: Positive
    """t_s, 2 % settling time of the second-order part, in s."""
    damping_ratio: Positive
    """epsilon, damping ratio of the second-order part."""
    pole_per_s: Positive = 200.0
    """a, the third pole, in 1/s."""
    static_share: Fraction = 0.1
    """Share of the static gains in the total; the rest is dynamic."""


AnyGains = Annotated[Gains | PolePlacement, Field(discriminator="kind")]


class PidSettings(Model):
    """A sampled PID: ``F = kp e + I + kd d``, ``I <- I + ki e T_s`` before use."""

    gains: AnyGains
    """Its gains, given or designed."""
    derivative_of: Literal["error", "measurement"] = "error"
    """What the derivative term differentiates."""
    velocity_from: Literal["sensor", "position_difference"] = "sensor"
    """Where the velocity comes from."""
    derivative_filter_s: NotNegative = 0.0
    """Time constant of the first-order filter on the derivative, in s; 0 for none."""
    anti_windup: Literal["off", "conditional", "back_calculation"] = "off"
    """What keeps the integral from winding up while the actuator is at a limit."""
    tracking_time_s: Positive = 1e-3
    """Tracking time of the back calculation, in s."""


class Pid(PidSettings):
    """Step 1 of the paper alone: a continuous force."""

    kind: Literal["pid"] = "pid"
    """The kind of controller."""


class FmPulses(Model):
    """Pulses whose frequency follows the error (section 4.2 of the paper).

    ``f = f_min + (f_max - f_min) min(|e| / e_full, 1)``. The paper prints the range of
    frequencies; full scale, width and shape it does not.
    """

    frequency_min_hz: Positive = 80.0
    """Pulse frequency at no error, in Hz."""
    frequency_max_hz: Positive = 160.0
    """Pulse frequency at full error, in Hz; below half the control frequency."""
    error_full_scale_m: Positive
    """Error at which the frequency is highest, in m."""
    pulse_width_s: Positive
    """Duration of a pulse, in s; at least two control periods, at most 1 / frequency_max_hz."""
    base_fraction: Fraction = 0.0
    """Share of the force that is held between pulses."""
    shape: Literal["rectangular", "half_sine", "raised_cosine"] = "half_sine"
    """Course of the force during a pulse."""

    @model_validator(mode="after")
    def _pulses_fit(self) -> Self:
        low, high, width = self.frequency_min_hz, self.frequency_max_hz, self.pulse_width_s
        if low > high:
            raise ValueError(
                f"frequency_min_hz: {low!r} is not <= frequency_max_hz = {high!r}; swap them"
            )
        if width * high > 1.0:
            raise ValueError(
                f"pulse_width_s: {width!r} makes pulses overlap at frequency_max_hz = {high!r}; "
                f"give a width <= {1.0 / high:.6g}"
            )
        return self


class FmVibration(Model):
    """The paper's vibration controller: a PID whose output is the amplitude of pulses."""

    kind: Literal["fm_vibration"] = "fm_vibration"
    """The kind of controller."""
    pid: PidSettings
    """Sets the amplitude of the pulses."""
    vibration: FmPulses
    """Sets frequency, width and shape of the pulses."""


class TwoStep(Model):
    """The paper's control in two steps: a PID until the joint breaks loose, then vibration."""

    kind: Literal["two_step"] = "two_step"
    """The kind of controller."""
    pid: PidSettings
    """Step 1; its settings but for the gains also hold in step 2."""
    vibration_gains: AnyGains
    """Gains of step 2, taken over without a bump."""
    vibration: FmPulses
    """Pulses of step 2."""
    breakaway_travel_m: Positive
    """Travel at which the joint counts as loose, in m; above stiction_n / stiffness_n_per_m."""


Controller = Annotated[Pid | FmVibration | TwoStep, Field(discriminator="kind")]


def gain_sets(controller: Pid | FmVibration | TwoStep) -> dict[str, Gains | PolePlacement]:
    """Every set of gains of a controller, by its path within it."""
    if isinstance(controller, Pid):
        return {"gains": controller.gains}
    sets: dict[str, Gains | PolePlacement] = {"pid.gains": controller.pid.gains}
    if isinstance(controller, TwoStep):
        sets["vibration_gains"] = controller.vibration_gains
    return sets
