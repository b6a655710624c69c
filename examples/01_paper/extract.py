"""The paper's extraction, and how much damping it would have needed."""

import breakaway as bk


def main() -> None:
    """Simulate three dampings, undisturbed and disturbed, and print a table."""
    scenario = bk.resolve(bk.load_scenario("paper_as_computed"))
    disturbed = bk.UniformDisturbance(var=0.05, hold_s=1e-4)
    print(f"{'kd (N s/m)':>10} {'var':>5} {'outcome':>9} {'peak (N)':>9} {'IAE (m s)':>10}")
    for kd in (scenario.controller.gains.kd_n_s_per_m, 1500.0, 2500.0):
        damped = scenario.with_({"controller.gains.kd_n_s_per_m": kd})
        for variant in (damped, damped.with_(disturbance=disturbed)):
            run = bk.simulate(variant)
            print(
                f"{kd:10.0f} {variant.disturbance.var:5.2f} {run.outcome:>9} "
                f"{run.metrics.peak_force_n:9.1f} {run.metrics.iae_m_s:10.2e}"
            )


if __name__ == "__main__":
    main()
