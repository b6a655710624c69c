"""Which conclusions about vibration and disturbance hold under more than one friction law."""

from argparse import ArgumentParser
from pathlib import Path

from breakaway.ask.studies import AgreementStudy, load_study, run_study
from breakaway.ask.studies.files import parse_study

HERE = Path(__file__).parent
SHARES = {"vibration": (0.5, 0.7, 0.99), "disturbance": (0.7,), "waiting": (0.7,)}
"""Study -> elastic shares of the elasto-plastic bristle; what vibration is worth depends on it."""


def asked(name: str, duration_s: float, until: str, elastic_share: float) -> AgreementStudy:
    """Give a study of this folder, changed as the command line says."""
    values = load_study(HERE / f"{name}.toml").model_dump(exclude_none=True)
    if name != "waiting":  # which compares durations
        values["changes"]["timing"]["duration_s"] = duration_s
    values["agreement"]["numbers"] = {"elasto_plastic": {"elastic_share": elastic_share}}
    if name == "disturbance":
        values["agreement"]["smallest"]["until"] = until
    return parse_study(values)


def ask(name: str, duration_s: float, until: str, elastic_share: float) -> None:
    """Run a study into out/, or go on with it, and print what it found."""
    study = asked(name, duration_s, until, elastic_share)
    told = f"{duration_s:g}s_{until}_{elastic_share:g}"
    done = run_study(study, out=Path("out") / f"{name}_{told}", resume=True)
    print(f"smallest force, N ({name}, {duration_s:g} s, elastic share {elastic_share:g})")
    for row in done.summary["tables"]["smallest"]:
        spread = f" ({row['p05']:g} to {row['p95']:g})" if row["runs"] > 1 else ""
        with_ = f"{row['disturbance']:15} " if name == "waiting" else ""
        print(f"  {row['law']:17} {with_}{row['variant']:18} {row['median']:g}{spread}")
    print("\n".join(done.summary["result"]), end="\n\n")


def main() -> None:
    """Run all studies, or one, as the command line says."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=SHARES, help="run one study alone")
    parser.add_argument("--duration-s", type=float, default=4.0, help="how long is pushed")
    parser.add_argument("--until", choices=("loose", "released"), default="loose")
    parser.add_argument("--elastic-share", type=float, help="of the bristle, instead of several")
    given = parser.parse_args()
    for name in [given.only] if given.only else SHARES:
        share = given.elastic_share
        for elastic_share in SHARES[name] if share is None else [share]:
            ask(name, given.duration_s, given.until, elastic_share)


if __name__ == "__main__":
    main()
