"""What decides how hard to push."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from breakaway.model.scenario.model import Fraction, Model, NotNegative, Positive


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

    ``f = f_min + (f_max - f_min) min(|e| / e_full, 1)``. The paper prints the range of frequencies,
    but not full scale, width or shape.
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
    """Shape of the force during a pulse."""

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


class ForceRamp(Model):
    """The naive way: a force that grows at a constant rate until the part is out.

    The force keeps growing after breakaway and throws the part out: the baseline that shows why
    force alone is not gentle.
    """

    kind: Literal["force_ramp"] = "force_ramp"
    """The kind of controller."""
    rate_n_per_s: Positive
    """Rate of the force, in N/s."""
    travel_m: Positive
    """Travel at which the part is out, in m."""


class FeedSettings(Model):
    """A slow approach for a set time, then a constant speed."""

    speed_m_per_s: Positive
    """Speed of the feed, in m/s."""
    approach_m_per_s: Positive
    """Speed of the approach, in m/s: a tool that closes its gap fast strikes the part."""
    approach_s: NotNegative
    """Duration of the approach, in s."""


class SteadyFeed(FeedSettings):
    """The stiff way: an approach, then a constant feed speed, without any sensing."""

    kind: Literal["steady_feed"] = "steady_feed"
    """The kind of controller."""


class TimedImpacts(Model):
    """Impacts that end as soon as the part slips, or at a ceiling. No friction parameter is needed.

    The force grows exponentially, so that an overshoot is relative, and is cut when
    ``(x - x0) + lead * velocity`` reaches the step, or the force reaches a ceiling that creeps up
    until the part slips: what slips at the peak slips under a force that already falls. The part
    coasts to rest before the next impact. Impacts rise as quickly as slips of this part go.

    Above the force of the first slip an impact first dwells and then is raised: a part that is slow
    for its mass needs time. A rough slip lowers the ceiling, puts the target off and makes steps
    smaller; so does a ceiling that has become low, where little is left to stop a heavy part. A
    part that is late is given larger ones.

    Examples
    --------
    >>> TimedImpacts(travel_m=0.1, target_s=5.0).restart_ratio
    0.93

    """

    kind: Literal["timed_impacts"] = "timed_impacts"
    """The kind of controller."""
    travel_m: Positive
    """Travel at which the part is out, in m."""
    target_s: Positive
    """When the part should be out, in s: steps grow, within their limits, to meet this time."""
    force_start_n: Positive = 30.0
    """Force at which the first search begins, in N."""
    search_time_constant_s: Positive = 60e-3
    """Time in which the force grows by e while the joint is searched for, in s."""
    rise_time_constant_s: Positive = 30e-3
    """Longest time in which the force grows by e once the part has slipped, in s."""
    rise_min_s: Positive = 1e-3
    """Shortest such time, in s."""
    rise_per_slip: Positive = 28.0
    """That time over the mean duration of a slip: a part that slips quickly is not pushed for
    long."""
    slowing_m_per_s: NotNegative = 0.004
    """Velocity above which the force grows more slowly, in m/s."""
    holding_m_per_s: Positive = 0.01
    """Velocity above which the force does not grow, in m/s."""
    step_min_m: Positive = 30e-6
    """Smallest step, in m."""
    step_max_m: Positive = 100e-6
    """Largest step while the part is not late, in m."""
    travel_min_m: NotNegative = 3e-6
    """Travel below which nothing counts as a slip, in m."""
    restart_ratio: Fraction = 0.93
    """Share of the ceiling at which an impact begins."""
    probe_ratio: NotNegative = 0.025
    """Share by which an impact without a slip raises the ceiling."""
    breakaway_share: Fraction = 0.2
    """Share by which the ceiling follows the force of an observed slip."""
    dwell_from_ratio: NotNegative = 1.0
    """Ratio of the ceiling to the force of the first slip above which an impact without a slip
    first dwells longer, before the ceiling rises."""
    dwell_step_s: NotNegative = 2e-4
    """What each such impact adds to the dwell, in s."""
    dwell_max_s: NotNegative = 4e-4
    """Longest dwell, in s; after it, the ceiling rises. 0 for none."""
    dwell_kept_share: Fraction = 0.9
    """Share of the dwell that remains after an observed slip."""
    rough_slip_m: Positive = 150e-6
    """Travel beyond which a slip is rough, and largest step while the part is late, in m."""
    rough_cut_ratio: Fraction = 0.1
    """Share by which a rough slip lowers the ceiling."""
    patience_s: NotNegative = 0.6
    """Time by which a rough slip postpones target_s, in s."""
    patience_max_s: NotNegative = 3.2
    """Longest time by which target_s is postponed in all, in s."""
    caution_per_s: NotNegative = 1.0 / 6.0
    """Share of step_max_m that is lost for each second by which target_s is postponed, in 1/s."""
    low_force_ratio: NotNegative = 0.3
    """Ratio of the ceiling to the force of the first slip below which the largest step falls with
    it. 0 for never."""
    low_step_ratio: Fraction = 0.6
    """Share of step_max_m below which it does not fall."""
    latest_s: Positive = 9.0
    """When the part should be out despite all caution, in s: caution and a low force never make
    steps smaller than this time requires, and steps exceed step_max_m where it requires them. Where
    target_s is later, neither has an effect."""
    coast_min_s: NotNegative = 1e-3
    """Shortest coast, in s."""
    settled_m: Positive = 2e-6
    """Difference of two means over ten samples below which the part is at rest, in m."""
    lead_start_s: NotNegative = 1e-3
    """Lead at the start, in s."""
    lead_min_s: NotNegative = 1e-4
    """Smallest lead, in s."""
    lead_max_s: NotNegative = 4e-3
    """Largest lead, in s."""
    noise_rms_m: NotNegative = 1e-6
    """Standard deviation of the position sensor's noise, as the controller assumes it, in m."""
    noise_margin: NotNegative = 1.0
    """Standard deviations of noise that a slope must exceed to count."""
    free_margin_m: NotNegative = 3e-6
    """Distance beyond travel_m at which the part counts as free, in m; it must exceed the
    noise."""
    actuator_lag_s: NotNegative = 1.6e-4
    """Lag of the actuator, as the controller assumes it, in s."""

    @model_validator(mode="after")
    def _is_in_order(self) -> Self:
        for low, high in (
            ("rise_min_s", "rise_time_constant_s"),
            ("step_min_m", "step_max_m"),
            ("lead_min_s", "lead_max_s"),
            ("slowing_m_per_s", "holding_m_per_s"),
        ):
            a, b = getattr(self, low), getattr(self, high)
            if a > b or (low == "slowing_m_per_s" and a == b):
                raise ValueError(f"{low}: {a!r} is not below {high} = {b!r}; swap them")
        return self


class TwoStep(Model):
    """The paper's supervisor: one controller until the joint breaks loose, then one that vibrates.

    The switch is without a bump: FM vibration continues from the force of step 1 as its amplitude;
    timed impacts begin afresh where the part is, with a clock that starts then. It never switches
    back.

    Examples
    --------
    >>> import breakaway as bk
    >>> bk.load_scenario("paper_as_computed_vibration").controller.breakaway.kind
    'pid'
    >>> bk.TwoStep(
    ...     breakaway=bk.ForceRamp(rate_n_per_s=1e4, travel_m=0.1),
    ...     vibration=bk.TimedImpacts(travel_m=0.1, target_s=8.0),
    ...     breakaway_travel_m=3e-5,
    ... ).vibration.kind
    'timed_impacts'

    """

    kind: Literal["two_step"] = "two_step"
    """The kind of controller."""
    breakaway: Annotated[Pid | ForceRamp, Field(discriminator="kind")]
    """Step 1."""
    vibration: Annotated[FmVibration | TimedImpacts, Field(discriminator="kind")]
    """Step 2."""
    breakaway_travel_m: Positive
    """Travel at which the joint counts as loose, in m; above stiction_n / stiffness_n_per_m."""

    @model_validator(mode="after")
    def _breaks_loose_before_it_is_out(self) -> Self:
        steps = {"breakaway": self.breakaway, "vibration": self.vibration}
        for name, step in steps.items():
            if not isinstance(step, ForceRamp | TimedImpacts):
                continue
            if self.breakaway_travel_m >= step.travel_m:
                raise ValueError(
                    f"breakaway_travel_m: {self.breakaway_travel_m!r} is not below "
                    f"{name}.travel_m = {step.travel_m!r}; give less than the travel at which the "
                    "part is out"
                )
        return self


class StackPulses(Model):
    """Pulses of a piezo stack, in proportion to the mean of the measured force."""

    frequency_hz: Positive
    """Pulses in a second, in Hz."""
    pulse_width_s: Positive
    """Duration of a pulse, in s; at most 1 / frequency_hz."""
    amplitude_ratio: NotNegative
    """Force of a pulse over the mean of the measured force."""
    stack_force_n: Positive
    """Force of the full stroke against a part that does not move, as assumed, in N."""
    force_filter_s: Positive = 0.02
    """Time constant of the mean of the force, in s."""

    @model_validator(mode="after")
    def _pulses_fit(self) -> Self:
        if self.pulse_width_s * self.frequency_hz > 1.0 + 1e-9:
            raise ValueError(
                f"pulse_width_s: {self.pulse_width_s!r} makes pulses overlap at frequency_hz = "
                f"{self.frequency_hz!r}; give a width <= {1.0 / self.frequency_hz:.6g}"
            )
        return self


class VibratedFeed(Model):
    """A constant feed, on which a piezo stack superimposes pulses in proportion to the force.

    The pulses break the part loose while the mean force is only ``F_s / (1 + amplitude_ratio)``;
    where that is below the sliding friction, a slip ends with its pulse whatever a soft axis has
    stored. It knows nothing about the part.

    Examples
    --------
    >>> import breakaway as bk
    >>> bk.load_method("vibrated_feed_soft").controller.kind
    'vibrated_feed'

    """

    kind: Literal["vibrated_feed"] = "vibrated_feed"
    """The kind of controller."""
    feed: FeedSettings
    """The feed."""
    pulses: StackPulses
    """The pulses of the stack."""


ReferenceController = Pid | FmVibration | TwoStep
"""Controllers that follow the reference."""
AnyController = ReferenceController | ForceRamp | SteadyFeed | TimedImpacts | VibratedFeed

Controller = Annotated[AnyController, Field(discriminator="kind")]


def gain_sets(controller: AnyController) -> dict[str, Gains | PolePlacement]:
    """Every set of gains of a controller, by its path within it; none where it has no PID."""
    return {f"{path}gains": pid.gains for path, pid in pids(controller).items()}


def pids(controller: AnyController) -> dict[str, PidSettings]:
    """Every PID of a controller, by its path within it with a dot after each name.

    Examples
    --------
    >>> import breakaway as bk
    >>> list(pids(bk.load_scenario("paper_as_computed_vibration").controller))
    ['breakaway.', 'vibration.pid.']

    """
    if isinstance(controller, TwoStep):
        steps: dict[str, AnyController] = {
            "breakaway.": controller.breakaway,
            "vibration.": controller.vibration,
        }
        return {
            f"{name}{path}": pid for name, step in steps.items() for path, pid in pids(step).items()
        }
    if isinstance(controller, FmVibration):
        return {"pid.": controller.pid}
    return {"": controller} if isinstance(controller, Pid) else {}
