"""Whether the set is as accurate as it is meant to be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tests.accuracy.impacts import CLOSE as CLOSE_PEAK
from tests.accuracy.impacts import Impact
from tests.accuracy.verdict import CLOSE, State, Verdict

SHARE_CLOSE = 0.97
"""Share of cases whose every metric is within 1 %, at least."""
NEAR = 0.05
"""Error that no metric of a case passes that is not chaotic."""
SHARE_CHAOTIC = 0.05
"""Share of cases that are chaotic, at most."""


def missed(verdicts: Sequence[Verdict], impacts: Sequence[Impact]) -> Iterator[str]:
    """Say what is missed, one line each; nothing where all is reached."""
    judged = [v for v in verdicts if v.state is not State.CHAOTIC]
    close = sum(v.worst <= CLOSE for v in judged)
    if close < SHARE_CLOSE * len(judged):
        yield f"every metric within 1 %: {close} of {len(judged)} cases, not {SHARE_CLOSE:.0%}"
    far = [v.number for v in judged if v.worst > NEAR]
    if far:
        yield f"beyond 5 %, or counts beyond one: {len(far)} cases that are not chaotic"
    chaotic = len(verdicts) - len(judged)
    if chaotic > SHARE_CHAOTIC * len(verdicts):
        yield f"chaotic: {chaotic} of {len(verdicts)}, more than {SHARE_CHAOTIC:.0%}"
    unlike = sum(bool(v.unlike) for v in verdicts)
    if unlike:
        yield f"distributed otherwise at finer steps: {unlike} chaotic cases"
    far_peaks = sum(one.error > CLOSE_PEAK for one in impacts)
    if far_peaks:
        yield f"peaks of impacts within {CLOSE_PEAK:.0%}: not for {far_peaks} of {len(impacts)}"
