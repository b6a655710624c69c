"""Which conclusions about vibration and disturbance hold under more than one friction law."""

from argparse import ArgumentParser
from pathlib import Path

from breakaway.ask.studies import AgreementStudy, load_study, run_study
from breakaway.ask.studies.files import parse_study

HERE = Path(__file__).parent
EFFECTS = "vibration", "disturbance"


def asked(name: str, duration_s: float, until: str, elastic_share: float) -> AgreementStudy:
    """Give a study of this folder, changed as the command line says."""
    values = load_study(HERE / f"{name}.toml").model_dump(exclude_none=True)
    values["changes"]["timing"]["duration_s"] = duration_s
    values["agreement"]["numbers"] = {"elasto_plastic": {"elastic_share": elastic_share}}
    if name == "disturbance":
        values["agreement"]["smallest"]["until"] = until
    return parse_study(values)


def main() -> None:
    """Run both studies into out/, or go on with them, and print what they found."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=EFFECTS, help="run one study alone")
    parser.add_argument("--duration-s", type=float, default=4.0, help="how long is pushed")
    parser.add_argument("--until", choices=("loose", "released"), default="loose")
    parser.add_argument("--elastic-share", type=float, default=0.7, help="of the bristle")
    given = parser.parse_args()
    for name in [given.only] if given.only else EFFECTS:
        study = asked(name, given.duration_s, given.until, given.elastic_share)
        told = f"{given.duration_s:g}s_{given.until}_{given.elastic_share:g}"
        done = run_study(study, out=Path("out") / f"{name}_{told}", resume=True)
        print(f"smallest force, N ({name}, {given.duration_s:g} s)")
        for row in done.summary["tables"]["smallest"]:
            spread = f" ({row['p05']:g} to {row['p95']:g})" if row["runs"] > 1 else ""
            print(f"  {row['law']:17} {row['variant']:18} {row['median']:g}{spread}")
        print("\n".join(done.summary["result"]), end="\n\n")


if __name__ == "__main__":
    main()
