"""How much bolts may differ, and whether another damping spares them."""

from pathlib import Path

from breakaway.ask.studies import load_study, run_study

HERE = Path(__file__).parent


def main() -> None:
    """Run both studies into out/, or go on with them, and print what they found."""
    for name in ("spread", "dampings"):
        done = run_study(load_study(HERE / f"{name}.toml"), out=Path("out") / name, resume=True)
        print("\n".join(done.summary["result"]))
    for row in done.summary["tables"]["differences"]:
        if row["metric"] == "largest_jump_m":
            change, low, high = (1e6 * row[f"difference{end}"] for end in ("", "_low", "_high"))
            print(
                f"{row['controller']}: largest jump {change:+.1f} µm, {low:+.1f} to {high:+.1f} at "
                f"95 %; smaller in {row['lower_share']:.0%} of {row['pairs']} bolts"
            )


if __name__ == "__main__":
    main()
