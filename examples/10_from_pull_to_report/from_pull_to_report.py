"""A pull becomes a joint, the joint an advice, the advice a report for the person who decides."""

from pathlib import Path

import breakaway as bk

HERE = Path(__file__).parent


def main() -> None:
    """Identify the joint of one pull, advise with a servo cylinder, and write the report."""
    log = bk.read_log(HERE / "part_1.csv")
    joint = bk.joint_from_pull(log, mass_kg=2.0)
    for name, (low, high) in joint.interval.items():
        print(f"{name}: {low:.4g} to {high:.4g}")
    advice = bk.advise(joint, "electric_cylinder", HERE / "limits.toml", budget_s=5.0, parts_max=64)
    for sentence in advice.sentences:
        print(sentence)
    for path in bk.write_advice(advice, "advice", command=f"python {Path(__file__).name}"):
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
