"""Refuse logs and settings from which inertia and friction cannot be identified."""

from __future__ import annotations

import math

import numpy as np

from breakaway.errors import LogError
from breakaway.measure.identification.regression import TRIM_PER_DECIMATION
from breakaway.measure.logs.derived import Motion, check_even
from breakaway.measure.logs.log import Log

MINIMUM_SAMPLES = 50
"""Fewest samples that must be left after trimming and decimation."""

TRAVEL_OVER_NOISE = 20.0
"""Smallest travel, over the standard deviation of the position's noise, that counts as motion."""

MOVING = 0.05
"""A sample moves if its speed exceeds this share of the largest speed."""

MINIMUM_SHARE = 0.05
"""Smallest share of the samples that must move in either direction."""

SIGNIFICANCE = 3.0
"""An estimate differs from 0 if it exceeds this many standard errors."""


def check_settings(log: Log, lowpass_hz: float, decimation: int) -> None:
    """Raise `LogError` for stamps that do not increase, or for settings outside their range."""
    log.check_increasing()
    if isinstance(decimation, bool) or not isinstance(decimation, int) or decimation < 1:
        raise LogError(f"decimation is {decimation!r}; it must be a whole number of at least 1")
    rate = log.sample_rate_hz
    low, high = 0.4 * rate / decimation, 0.5 * rate
    if not (math.isfinite(lowpass_hz) and low <= lowpass_hz < high):
        raise LogError(
            f"lowpass_hz is {lowpass_hz:g}; for {log.name} ({rate:.6g} Hz) and decimation "
            f"{decimation} it must be at least {low:.6g} Hz (0.4 of the decimated rate, the band "
            f"that is fitted) and below {high:.6g} Hz (half of the sample rate): change "
            "--lowpass-hz or --decimation (lowpass_hz, decimation)"
        )


def check_sampling(log: Log, decimation: int) -> None:
    """Raise `LogError` for uneven sampling, or for too few samples to filter."""
    check_even(log)
    need = 2 * TRIM_PER_DECIMATION * decimation + MINIMUM_SAMPLES * decimation
    if log.rows < need:
        raise LogError(
            f"{log.name}: {log.rows} rows; with decimation {decimation} at least {need} are needed "
            f"({2 * TRIM_PER_DECIMATION * decimation} are trimmed at the ends and "
            f"{MINIMUM_SAMPLES} must be left): record for longer, or lower decimation"
        )


def check_motion(log: Log, motion: Motion) -> None:
    """Raise `LogError` for a part that never moves, or that moves in one direction only."""
    travel = float(np.ptp(motion.position_m))
    if not travel > max(TRAVEL_OVER_NOISE * motion.noise_m, 1e-12 * np.abs(log.position_m).max()):
        raise LogError(
            f"{log.name}: column 'position_m': the part never moves (travel {travel:.3g} m, noise "
            f"{motion.noise_m:.3g} m above lowpass_hz; travel must exceed {TRAVEL_OVER_NOISE:g} "
            "times the noise), so neither mass nor friction shows: record a log in which it moves"
        )
    speed = motion.velocity_m_per_s / np.abs(motion.velocity_m_per_s).max()
    for share, word in ((np.mean(speed > MOVING), "up"), (np.mean(speed < -MOVING), "down")):
        if share < MINIMUM_SHARE:
            raise LogError(
                f"{log.name}: column 'position_m' goes {word} in {100 * share:.2g} % of the rows; "
                f"at least {100 * MINIMUM_SHARE:g} % are needed in each direction, or Coulomb "
                "friction cannot be told apart from a constant force: record both directions"
            )
    if not np.any(log.force_n):
        raise LogError(
            f"{log.name}: column 'force_n' is 0 in every row; record the force that moves the part"
        )


def check_mass(log: Log, mass_kg: float, error_kg: float) -> None:
    """Raise `LogError` for a mass that is not significantly positive."""
    if mass_kg > SIGNIFICANCE * error_kg:
        return
    if mass_kg < -SIGNIFICANCE * error_kg:
        raise LogError(
            f"{log.name}: the mass comes out as {mass_kg:.4g} ± {error_kg:.2g} kg; it must be "
            "positive: force_n and position_m count in opposite directions, or are delayed "
            "against each other; flip the sign of one, or synchronize them"
        )
    raise LogError(
        f"{log.name}: the mass cannot be determined ({mass_kg:.4g} ± {error_kg:.2g} kg, it must "
        f"exceed {SIGNIFICANCE:g} standard errors): accelerate harder, or measure the force "
        "with less noise; or name a law (--law), which can do without the mass"
    )
