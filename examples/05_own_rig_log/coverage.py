"""How often do 95 % intervals hold the truth? Identifies many rigs whose truth is known."""

import argparse
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

from rig import drawn, measured

import breakaway as bk


def judged(case: int) -> list[tuple[str, str]]:
    """Identify one rig; say of each parameter whether its interval holds the truth."""
    truth = drawn(case)
    found = bk.identify(measured(truth, case), law="lugre", starts=2)
    out = []
    for one in found.estimates:
        inside = one.low <= getattr(truth, one.name) <= one.high
        verdict = ("inside" if inside else "outside") if one.identifiable else "not told"
        out.append((one.name, verdict))
    fitted = {one.name for one in found.estimates}
    held = [one for one in found.verdicts if one.parameter not in fitted | {"mass_kg"}]
    return out + [(one.parameter, "not told") for one in held]


def main() -> None:
    """Print one row for each parameter."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=8)
    cases = parser.parse_args().cases
    counts: Counter[tuple[str, str]] = Counter()
    with ProcessPoolExecutor() as pool:
        for verdicts in pool.map(judged, range(cases), chunksize=2):
            counts.update(verdicts)
    print(f"{'parameter':28} {'inside':>7} {'outside':>8} {'not told':>9} {'coverage':>9}")
    inside = outside = 0
    for name in dict.fromkeys(name for name, _ in counts):
        held, missed, open_ = (counts[name, word] for word in ("inside", "outside", "not told"))
        share = f"{100 * held / (held + missed):.1f} %" if held + missed else ""
        print(f"{name:28} {held:7} {missed:8} {open_:9} {share:>9}")
        inside, outside = inside + held, outside + missed
    print(f"{'all that were told':28} {inside:7} {outside:8} {'':9}", end="")
    print(f" {100 * inside / (inside + outside):7.1f} %")


if __name__ == "__main__":
    main()
