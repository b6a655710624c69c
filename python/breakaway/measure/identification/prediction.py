"""What an identified model says of rows of a log, beside what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.base.one_line import OneLine, counted
from breakaway.measure.identification.lag import Lag
from breakaway.measure.identification.laws import SHARED, Law
from breakaway.measure.identification.record import (
    Rows,
    RunSettings,
    Span,
    core_record,
    predicted_channel,
    segments_of,
)
from breakaway.measure.logs.log import Array


@dataclass(frozen=True, eq=False)
class Prediction(OneLine):
    """Simulated and measured rows. ``segment`` says which segment a row is of.

    ``channel`` is the one that the motion does not impose: ``position_m`` where the part moves
    freely, else ``force_n``.
    """

    t_s: Array
    position_m: Array
    force_n: Array
    measured_position_m: Array
    measured_velocity_m_per_s: Array
    measured_force_n: Array
    segment: NDArray[np.int64]
    channel: str

    def __repr__(self) -> str:
        rows = counted(len(self.t_s), "row")
        return f"<prediction of {self.channel}: {rows}, RMS error {self.rms_error:.3g}>"

    @property
    def error(self) -> Array:
        """Simulated less measured, of the channel."""
        if self.channel == "position_m":
            return self.position_m - self.measured_position_m
        return self.force_n - self.measured_force_n

    @property
    def rms_error(self) -> float:
        """Root of the mean squared error of the channel, in its unit."""
        return float(np.sqrt(np.mean(self.error**2)))

    @property
    def relative_force_error_percent(self) -> float:
        """100 ‖F - F_measured‖ / ‖F_measured‖."""
        off = np.linalg.norm(self.force_n - self.measured_force_n)
        return 100.0 * float(off / np.linalg.norm(self.measured_force_n))


def predict_rows(
    rows: Rows,
    spans: Sequence[Span],
    law: Law,
    settings: RunSettings,
    numbers: Array,
    *,
    delay_s: float = 0.0,
    same: bool = False,
) -> Prediction:
    """Simulate spans of rows with the core's numbers.

    ``same`` takes the offsets as they are, for the very segments that were fitted; else the last
    offset holds for all. ``delay_s`` is the delay of the measured position.
    """
    _, segments, _ = segments_of(rows, spans)
    if not same:
        shared = len(SHARED)
        numbers = np.concatenate([numbers[:shared], np.full(len(segments), numbers[-1])])
    out = core_record(rows, segments, law, settings).simulate(numbers.tolist())
    position, force = (np.frombuffer(values) for values in out)
    channel = predicted_channel(settings.motion)
    lag = Lag.of(rows.log.t_s, segments, position=channel == "position_m")
    position, force = (lag.shifted(values, delay_s) for values in (position, force))
    places = np.concatenate([np.arange(first, end) for first, end in segments])
    owner = np.concatenate([np.full(end - first, i) for i, (first, end) in enumerate(segments)])
    return Prediction(
        t_s=rows.log.t_s[places],
        position_m=position + settings.origin_m,
        force_n=rows.columns[3][places] if settings.motion == "free" else force,
        measured_position_m=rows.log.position_m[places],
        measured_velocity_m_per_s=rows.columns[1][places],
        measured_force_n=rows.columns[3][places],
        segment=owner,
        channel=channel,
    )
