"""How often do 95 % intervals hold the truth? Identifies many rigs whose truth is known."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import NamedTuple

from families import FAMILIES, log_of, rig_of

import breakaway as bk
from breakaway.measure.identification.verdicts import AT_ONE_SPEED
from friction import LAWS

REFUSED = "(refused)"


class Judged(NamedTuple):
    """What one identification said: of each parameter, and of faults."""

    family: str
    parameters: tuple[tuple[str, str], ...]
    named: tuple[str, ...]


def judged(family: str, law: str, case: int) -> Judged:
    """Identify one rig; say of each parameter whether its interval holds the truth."""
    truth, log = log_of(family, law, case)
    try:
        found = bk.identify(log, law="lugre", starts=2, rig=rig_of(family, truth, case))
    except bk.LogError:
        return Judged(family, ((REFUSED, "not told"),), ())
    named = tuple(one.kind for one in found.faults)
    out = []
    for one in (*found.estimates, *found.combined):
        true = getattr(truth, one.name)
        if one.remark.startswith(AT_ONE_SPEED):
            true += truth.above_coulomb_n(found.excitation.fast_speed_m_per_s)
        inside = one.low <= true <= one.high
        verdict = ("inside" if inside else "outside") if one.identifiable else "not told"
        out.append((one.name, verdict))
    fitted = {one.name for one in found.estimates}
    held = [one.parameter for one in found.verdicts if one.parameter not in fitted]
    out += [(name, "not told") for name in held if hasattr(truth, name)]
    return Judged(family, tuple(out), named)


def work(args: argparse.Namespace) -> list[tuple[str, str, int]]:
    """Return family, law and case of each log."""
    chosen = args.family or list(FAMILIES)
    cases = range(args.seed, args.seed + args.cases)
    return [(family, law, case) for family in chosen for case in cases for law in LAWS]


def results(args: argparse.Namespace) -> Iterator[Judged]:
    """Judge all logs in parallel; Ctrl-C ends it with what is done."""
    todo = work(args)
    with ProcessPoolExecutor() as pool:
        running = [pool.submit(judged, *one) for one in todo]
        try:
            for done, one in enumerate(as_completed(running), start=1):
                yield one.result()
                print(f"\r{done} of {len(todo)} logs", end="", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
    print(file=sys.stderr)


def show(family: str, done: list[Judged]) -> None:
    """Print the table of one family."""
    counts = Counter(one for each in done for one in each.parameters)
    print(f"\n{family}: {len(done)} logs")
    print(f"  {'parameter':28} {'inside':>7} {'outside':>8} {'not told':>9} {'coverage':>9}")
    inside = outside = 0
    for name in dict.fromkeys(name for name, _ in counts):
        held, missed, open_ = (counts[name, word] for word in ("inside", "outside", "not told"))
        share = f"{100 * held / (held + missed):.1f} %" if held + missed else ""
        print(f"  {name:28} {held:7} {missed:8} {open_:9} {share:>9}")
        inside, outside = inside + held, outside + missed
    share = f"{100 * inside / (inside + outside):.1f} %" if inside + outside else ""
    print(f"  {'all that were told':28} {inside:7} {outside:8} {'':9} {share:>9}")
    fault = FAMILIES[family].fault
    falsely = Counter(kind for one in done for kind in set(one.named) - {fault})
    if fault:
        print(f"  {fault} named in {sum(fault in one.named for one in done)} of {len(done)} logs")
    for kind, count in falsely.items():
        print(f"  {kind} named falsely in {count} of {len(done)} logs")


def main() -> None:
    """Print a table for each family."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1, help="rigs of each law in each family")
    parser.add_argument("--seed", type=int, default=0, help="number of the first rig")
    parser.add_argument("--family", action="append", choices=list(FAMILIES), help="only this one")
    args = parser.parse_args()
    done: dict[str, list[Judged]] = {name: [] for name in args.family or FAMILIES}
    for one in results(args):
        done[one.family].append(one)
    for family, each in done.items():
        if each:
            show(family, each)


if __name__ == "__main__":
    main()
