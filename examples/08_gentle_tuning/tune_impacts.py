"""Tune timed impacts: a taste on short parts in seconds, or the whole with --full."""

import argparse
from pathlib import Path

import breakaway as bk

HERE = Path(__file__).parent

# Short parts are out in tenths of a second; the ranges of time go with them.
TASTE = {
    "name": "taste",
    "population": bk.load_population(HERE / "quick_parts.toml"),
    "training_runs": 32,
    "test_runs": {"first": 1000, "runs": 96},
    "evaluations": 12,
}
TARGET = {"controller.target_s": {"low": 0.15, "high": 0.5}}


def asked(full: bool) -> bk.Tuning:
    """Give the tuning of the file, or one like it of short parts and few evaluations."""
    tuning = bk.load_tuning(HERE / "timed_impacts.toml")
    if full:
        return tuning
    values = tuning.model_dump()
    return bk.Tuning.parse(values | TASTE | {"tune": values["tune"] | TARGET})


def main() -> None:
    """Tune, or go on with it, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="the whole tuning, which takes hours")
    full = parser.parse_args().full
    tuning = asked(full)
    done = bk.tune(tuning, out=Path("out") / tuning.name, resume=True)
    print("\n".join(done.summary["result"]))
    for row in done.summary["front"]:
        print(
            f"{row['file']}: strictly gentle {row['strict_share_training']:.1%} of training parts, "
            f"{row['strict_share_unseen']:.1%} of unseen ones; "
            f"{row['median_time_to_release_s_unseen']:.2f} s"
        )


if __name__ == "__main__":
    main()
