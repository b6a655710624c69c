"""What became of parts, by what they, their host and the rig bear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.harm import HarmLimits
from breakaway.model.scenario.population import Gentleness
from breakaway.run.trials import Trial

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Bounds:
    """What counts as unharmed."""

    limits: HarmLimits | None
    """The part's own terms; None for the limits of the population, which are assumed."""
    gentle: Gentleness
    """Limits of the population."""
    rig: ExtractionRig
    """What pulls."""

    @property
    def words(self) -> list[str]:
        """What a part may suffer, in words."""
        if self.limits is None:
            g = self.gentle
            return [
                f"a peak of at most {g.peak_over_breakaway_max:g} times the force that frees the "
                f"part, jumps of at most {1e3 * g.jump_max_m:g} mm, at most "
                f"{g.release_velocity_max_m_per_s:g} m/s at release: assumed, no limits file stated"
            ]
        weakest = self.limits.weakest
        jump, speed = self.limits.jump_max_m, self.limits.release_velocity_max_m_per_s
        return [
            *(
                [
                    f"{weakest.place} ({weakest.of}) bears {weakest.strength_pa / 1e6:.4g} MPa, "
                    f"which {weakest.force_max_n:.4g} N make there: the weakest of "
                    f"{len(self.limits.stresses)} places stated"
                ]
                if weakest
                else []
            ),
            *([f"jumps of at most {1e3 * jump:g} mm"] if jump else []),
            *([f"at most {speed:g} m/s at release"] if speed else []),
        ]


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of each part, one value for each."""

    freed: Mask
    """Whether it came out, within the rig's force and stroke."""
    within_force: Mask
    """Whether no place was stressed beyond its limit."""
    within_jump: Mask
    """Whether it slipped no farther than it may."""
    within_velocity: Mask
    """Whether it was released no faster than it may."""
    load: Array
    """Peak force over the one that is allowed."""
    time_s: Array
    """Time to release; NaN where it stayed."""
    jump_m: Array
    """Largest uncontrolled travel."""
    velocity_m_per_s: Array
    """Velocity at release; NaN where it stayed."""
    peak_n: Array
    """Peak force."""
    impulse_n_s: Array
    """Impulse of the force."""
    stiction_n: Array
    """The force that holds the part at its seat."""

    @property
    def unharmed(self) -> Mask:
        """Whether it came out within all limits."""
        return self.freed & self.within_force & self.within_jump & self.within_velocity


def outcome_of(trial: Trial, bounds: Bounds) -> Outcome:
    """Judge the parts of a trial."""
    m, rig = trial.metrics, bounds.rig
    reach = (m["peak_force_n"] <= rig.force_max_n) & (
        trial.parts["engagement_length_m"] <= rig.stroke_m
    )
    freed = trial.released & reach
    load, jump_max_m, velocity_max = _bounds_of(trial, bounds)
    velocity = m["release_velocity_m_per_s"]
    return Outcome(
        freed=freed,
        within_force=load <= 1.0,
        within_jump=m["largest_jump_m"] <= jump_max_m,
        within_velocity=~(velocity > velocity_max),
        load=load,
        time_s=m["time_to_release_s"],
        jump_m=m["largest_jump_m"],
        velocity_m_per_s=velocity,
        peak_n=m["peak_force_n"],
        impulse_n_s=m["impulse_n_s"],
        stiction_n=trial.parts["stiction_n"],
    )


def _bounds_of(trial: Trial, bounds: Bounds) -> tuple[Array, float, float]:
    """Give the load of each part, and the largest jump and velocity."""
    if bounds.limits is None:
        g = bounds.gentle
        load = trial.metrics["peak_over_breakaway"] / g.peak_over_breakaway_max
        return load, g.jump_max_m, g.release_velocity_max_m_per_s
    limits = bounds.limits
    load = trial.metrics["peak_force_n"] / limits.force_max_n
    jump, speed = limits.jump_max_m, limits.release_velocity_max_m_per_s
    return load, np.inf if jump is None else jump, np.inf if speed is None else speed


def joined(outcomes: list[Outcome]) -> Outcome:
    """Put outcomes of different parts together."""
    names = Outcome.__dataclass_fields__
    return Outcome(**{n: np.concatenate([getattr(one, n) for one in outcomes]) for n in names})
