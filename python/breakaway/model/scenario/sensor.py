"""What the controller sees through."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from breakaway.model.scenario.model import Model, NotNegative, Positive


class SensorModel(Model):
    """What every sensor has: bandwidth, noise, steps, delay, in this order."""

    bandwidth_hz: Positive | None = None
    """Corner frequency of a first-order low-pass, in Hz. Left out: no low-pass."""
    delay_samples: Annotated[int, Field(ge=0, le=8)] = 0
    """By how many control samples the reading is late."""


class PositionSensor(SensorModel):
    """Sensor of the part's position.

    Noise is the sum of eight random bytes, scaled: nearly normal, within 4.9 deviations.

    Examples
    --------
    >>> PositionSensor(noise_rms_m=1e-6).delay_samples
    0

    """

    noise_rms_m: NotNegative = 0.0
    """Standard deviation of the noise of a sample, in m."""
    quantum_m: Positive | None = None
    """Step of the reading, in m. Left out: not quantized."""


class ForceSensor(SensorModel):
    """Sensor of the force on the part: it sees the mean over the period before.

    Examples
    --------
    >>> ForceSensor(noise_rms_n=2.0, bandwidth_hz=2000.0).noise_rms_n
    2.0

    """

    noise_rms_n: NotNegative = 0.0
    """Standard deviation of the noise of a sample, in N."""
    quantum_n: Positive | None = None
    """Step of the reading, in N. Left out: not quantized."""


class Sensors(Model):
    """The sensors of a loop. A velocity sensor, if a PID uses one, is ideal."""

    position: PositionSensor = PositionSensor()
    """Sensor of the part's position."""
    force: ForceSensor = ForceSensor()
    """Sensor of the force on the part."""


class Watch(Model):
    """Stops the controller for good at a measurement that cannot be true.

    Then there is no force, no feed, and the stack is relaxed. The reason is the metric
    ``stop_reason``: 1 not a number, 2 the position jumps, 3 it is frozen while the controller
    pushes, 4 the clock stands still.
    """

    jump_max_m: Positive
    """Farthest that the part can move in one sample, in m."""
    frozen_max_s: Positive | None = None
    """Longest time for which a noisy sensor may show the same bits, in s. Left out: no limit."""
