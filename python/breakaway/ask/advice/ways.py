"""The ways in which a rig can free parts, and the settings of each that are tried."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from breakaway.model.scenario.actuator import FeedAxis, ForceActuator
from breakaway.model.scenario.extraction_rig import ExtractionRig
from breakaway.model.scenario.method import Method
from breakaway.model.scenario.population import PartPopulation

APPROACH_M_PER_S = 1e-3
"""Speed at which a tool closes its gap: one that closes it fast strikes the part."""
STRONG = 0.95
"""Quantile of the breakaway force at which a ramp ends in the time that it is given."""
STACK_HZ, STACK_PULSE_S = 250.0, 2e-3
"""Pulses of a stack, as in the preset `vibrated_feed`."""


@dataclass(frozen=True)
class Way:
    """A way to free parts, and its settings, each a method."""

    name: str
    """A name for tables, such as ``steady_feed``."""
    words: str
    """What is done, in a sentence."""
    settings: tuple[Method, ...]
    """What is tried of it, each by a name that says how it is set."""


def ways_of(rig: ExtractionRig, parts: PartPopulation) -> list[Way]:
    """Give the ways that a rig's drive and sensors allow, in the time that the parts are given."""
    built = (build(rig, parts) for build in BUILDERS)
    return [way for way in built if way is not None and way.settings]


def _force_ramp(rig: ExtractionRig, parts: PartPopulation) -> Way | None:
    if not isinstance(rig.actuator, ForceActuator):
        return None
    strong_n = float(parts.parts.stiction_n.quantile(np.array([STRONG]))[0])
    rates = [
        min(rig.actuator.force_max_n, strong_n) / (share * parts.duration_s)
        for share in (0.9, 0.45, 0.15)
    ]
    return Way(
        "force_ramp",
        "The force grows steadily until the part is out; nothing is read.",
        tuple(
            _method(
                rig,
                f"force ramp, {rate:.3g} N/s",
                {"kind": "force_ramp", "rate_n_per_s": rate, "travel_m": 1.0},
                {"controller.travel_m": "engagement_length_m"},
            )
            for rate in rates
        ),
    )


def _timed_impacts(rig: ExtractionRig, parts: PartPopulation) -> Way | None:
    if not isinstance(rig.actuator, ForceActuator) or "position" not in rig.reads:
        return None
    own = {
        "kind": "timed_impacts",
        "travel_m": 1.0,
        "target_s": 0.46 * parts.duration_s,
        "latest_s": 0.9 * parts.duration_s,
        "actuator_lag_s": 1.0 / (2.0 * pi * rig.actuator.bandwidth_hz),
        "noise_rms_m": rig.sensors.position.noise_rms_m,
    }
    settings: dict[str, dict[str, float]] = {
        "timed impacts": {},
        "timed impacts, steps of at most 50 µm": {"step_max_m": 50e-6},
        "timed impacts, a slow search": {"search_time_constant_s": 120e-3},
    }
    return Way(
        "timed_impacts",
        "Impacts that end as soon as the part slips; the position is read.",
        tuple(
            _method(
                rig,
                name,
                own | changes,
                {"controller.travel_m": "engagement_length_m"},
            )
            for name, changes in settings.items()
        ),
    )


def _steady_feed(rig: ExtractionRig, parts: PartPopulation) -> Way | None:
    if not isinstance(rig.actuator, FeedAxis):
        return None
    return Way(
        "steady_feed",
        "The axis moves at constant speed; nothing is read.",
        tuple(
            _method(
                rig,
                f"steady feed, out in {1.0 / share:.3g} s",
                {"kind": "steady_feed", **_approach(rig.actuator)},
                {"controller.speed_m_per_s": {"of": "engagement_length_m", "times": share}},
            )
            for share in _feed_shares(rig.actuator, parts.duration_s)
        ),
    )


def _vibrated_feed(rig: ExtractionRig, parts: PartPopulation) -> Way | None:
    axis = rig.actuator
    if not isinstance(axis, FeedAxis) or axis.tip.kind != "piezo" or "force" not in rig.reads:
        return None
    pulses = {
        "frequency_hz": STACK_HZ,
        "pulse_width_s": STACK_PULSE_S,
        "stack_force_n": axis.tip.stiffness_n_per_m * axis.tip.stroke_m,
    }
    return Way(
        "vibrated_feed",
        "The axis moves at constant speed and the stack vibrates in proportion to the force.",
        tuple(
            _method(
                rig,
                f"vibrated feed, out in {1.0 / share:.3g} s, pulses of {ratio:g} times the force",
                {
                    "kind": "vibrated_feed",
                    "feed": _approach(axis),
                    "pulses": {**pulses, "amplitude_ratio": ratio},
                },
                {"controller.feed.speed_m_per_s": {"of": "engagement_length_m", "times": share}},
            )
            for share in _feed_shares(axis, parts.duration_s)[:1]
            for ratio in (0.3, 0.6)
        ),
    )


BUILDERS: tuple[Callable[[ExtractionRig, PartPopulation], Way | None], ...] = (
    _force_ramp,
    _timed_impacts,
    _steady_feed,
    _vibrated_feed,
)
"""What makes a way of a rig, or None where the rig cannot."""


def _feed_shares(axis: FeedAxis, duration_s: float) -> tuple[float, ...]:
    """Give feed speeds over the length of the guide, in 1/s: the slowest uses the time allowed.

    There is none where the approach alone takes that time.
    """
    left_s = duration_s - _approach(axis)["approach_s"]
    return tuple(factor / left_s for factor in (1.1, 3.0, 8.0)) if left_s > 0.0 else ()


def _approach(axis: FeedAxis) -> dict[str, float]:
    """Give the approach that closes the gap, with a fifth to spare; the speed is set by part."""
    return {
        "speed_m_per_s": 1.0,
        "approach_m_per_s": APPROACH_M_PER_S,
        "approach_s": 1.2 * axis.contact.gap_m / APPROACH_M_PER_S,
    }


def _method(
    rig: ExtractionRig, name: str, controller: dict[str, Any], knows: dict[str, Any]
) -> Method:
    return Method.parse(
        {
            "name": name,
            "actuator": rig.actuator.model_dump(),
            "controller": controller,
            "knows": knows,
        }
    )
