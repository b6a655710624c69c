"""How many of the jumps that are counted are slips: parts on a soft axis whose stack is at rest."""

from argparse import ArgumentParser

import numpy as np
from numpy.typing import NDArray

import breakaway as bk

JUMP_MAX_M = 0.5e-3
"""What counts as gentle."""
SLIP_OVER_FEED = 2.0
"""A part that never gets this much faster than the feed is pushed, and does not slip."""
VARIATIONS = ("none", "part", "field", "paper_random_factor")


def fastest_in_largest_jump(run: bk.Run, feed_m_per_s: float) -> float:
    """Give the largest speed over the feed's in the stretch that is counted as the largest jump."""
    t_s, x_m = run.trace["t_s"], run.trace["position_m"]
    speed = np.diff(x_m) / np.diff(t_s)
    faster = np.concatenate([[0], speed > feed_m_per_s, [0]])
    begins, ends = (np.flatnonzero(np.diff(faster) == sign) for sign in (1, -1))
    jumps_m = x_m[ends] - x_m[begins] - feed_m_per_s * (t_s[ends] - t_s[begins])
    at = int(jumps_m.argmax())
    return float(speed[begins[at] : ends[at]].max() / feed_m_per_s)


def largest_jumps(trial: bk.Trial, most: int) -> NDArray[np.float64]:
    """Give that ratio for the first parts that jump further than is gentle."""
    rough = np.flatnonzero(trial.metrics["largest_jump_m"] > JUMP_MAX_M)[:most]
    known = trial.method.told(trial.parts["engagement_length_m"])
    feeds = known["controller.feed.speed_m_per_s"]
    return np.array([fastest_in_largest_jump(trial.replay(int(i)), feeds[i]) for i in rough])


def main() -> None:
    """Try the method on parts as friction varies this way or that, and look at what is counted."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=12, help="parts of seized_parts")
    parser.add_argument("--look-at", type=int, default=4, help="rough parts that are looked at")
    given = parser.parse_args()
    population = bk.load_population("seized_parts")
    method = bk.load_method("vibrated_feed_soft_at_rest")
    for variation in VARIATIONS:
        trial = bk.run_trial(
            population, method, law="elasto_plastic", runs=given.runs, seed=1, variation=variation
        )
        rough = int((trial.metrics["largest_jump_m"] > JUMP_MAX_M).sum())
        ratios = largest_jumps(trial, given.look_at)
        slow = int((ratios < SLIP_OVER_FEED).sum())
        print(
            f"{variation}: {rough} of {given.runs} parts jump further than 0.5 mm; of "
            f"{len(ratios)} looked at, {slow} are never twice as fast as the feed"
        )


if __name__ == "__main__":
    main()
