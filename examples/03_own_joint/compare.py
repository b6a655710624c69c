"""A seized bolt under two friction laws."""

from pathlib import Path

import breakaway as bk

SHARED = (
    "stiction_n",
    "coulomb_n",
    "stiffness_n_per_m",
    "damping_n_s_per_m",
    "engagement_length_m",
    "residual_n",
)


def main() -> None:
    """Extract the bolt under both laws and print what happens to it."""
    lugre = bk.load_scenario(Path(__file__).with_name("bolt.toml"))
    shared = {name: getattr(lugre.joint, name) for name in SHARED}
    two_region = lugre.with_(name="two-region law", joint=bk.TwoRegion(**shared))
    for scenario in (lugre.with_(name="LuGre"), two_region):
        run = bk.simulate(scenario)
        m = run.metrics
        print(
            f"{scenario.name:>15}: {run.outcome}, peak {m.peak_force_n:.0f} N "
            f"({m.peak_over_breakaway:.2f} of breakaway), largest jump "
            f"{m.largest_jump_m * 1e3:.3f} mm, release at {m.release_velocity_m_per_s:.3f} m/s"
        )


if __name__ == "__main__":
    main()
