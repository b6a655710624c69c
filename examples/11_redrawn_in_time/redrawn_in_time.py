"""What a factor does that is redrawn by the clock: to who waits, and to what counts as a jump."""

import numpy as np

import breakaway as bk

VAR = 0.3
REDRAWN = bk.UniformDisturbance(var=VAR, hold_s=1e-3, acts_on="friction_level")
ALONG_THE_WAY = bk.FieldDisturbance(var=VAR, correlation_length_m=1e-3)
UNDISTURBED = bk.UniformDisturbance()


def rigid(push_n: float, wait_s: float, disturbance: object) -> bk.Scenario:
    """Give a constant push on rigid friction of 450 N."""
    joint = bk.CoulombStiction(
        stiction_n=450.0, coulomb_n=360.0, stribeck_velocity_m_per_s=0.09, engagement_length_m=0.1
    )
    return bk.load_scenario("paper_as_computed").with_(
        joint=joint,
        disturbance=disturbance,
        reference=bk.StepReference(distance_m=0.2),
        actuator=bk.PushOnlyActuator(force_max_n=push_n),
        controller=bk.ForceRamp(rate_n_per_s=1e7, travel_m=0.1),
        timing={"duration_s": wait_s, "control_period_s": 5e-5},
        limits={"diverged_error_m": 1.0},
        trace={"every_samples": 0},
    )


def smallest_push_n(wait_s: float, disturbance: object) -> float:
    """Find the smallest push at which the joint lets go within a time, to 0.1 N."""
    low, high = 300.0, 600.0
    while high - low > 0.1:
        push_n = 0.5 * (low + high)
        run = bk.simulate(rigid(push_n, wait_s, disturbance))
        low, high = (low, push_n) if run.metrics.time_to_breakaway_s > 0.0 else (push_n, high)
    return high


def one_part(hold_s: float = 1e-3, correlation_length_m: float = 1e-3) -> bk.PartPopulation:
    """Give a population of one part: the middle one of `seized_parts`, but of 2000 and 900 N."""
    whole = bk.load_population("seized_parts")
    part = {name: whole.nominal[name] for name in type(whole.parts).model_fields} | {
        "stiction_n": 2000.0,
        "stiction_ratio": 2000.0 / 900.0,
        "var": VAR,
        "hold_s": hold_s,
        "correlation_length_m": correlation_length_m,
    }
    parts = {name: bk.Uniform(low=value, high=value) for name, value in part.items()}
    return whole.model_copy(update={"parts": bk.PartDistributions(**parts)})


def longest_jump(run: bk.Run, speed_m_per_s: float) -> tuple[float, float]:
    """Give how long the largest jump of a run lasts, and its top speed over that of the feed."""
    excess = np.diff(run.trace["position_m"]) - speed_m_per_s * np.diff(run.trace["t_s"])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], excess > 0.0, [0]])))
    starts, ends = edges[::2], edges[1::2]
    travelled = np.concatenate([[0.0], np.cumsum(excess)])
    largest = int(np.argmax(travelled[ends] - travelled[starts]))
    start, end = starts[largest], ends[largest]
    lasts_s = run.trace["t_s"][end] - run.trace["t_s"][start]
    return lasts_s, run.trace["velocity_m_per_s"][start : end + 1].max() / speed_m_per_s


def jumps(name: str, variation: str, population: bk.PartPopulation) -> str:
    """Say how far the part jumps with a method, and how."""
    method = bk.load_method(name)
    trial = bk.run_trial(population, method, variation=variation, runs=32, seed=1)
    run = trial.replay(0)
    controller = run.scenario.controller
    speed_m_per_s = getattr(controller, "feed", controller).speed_m_per_s
    lasts_s, speeds = longest_jump(run, speed_m_per_s)
    middle_mm = 1e3 * np.median(trial.metrics["largest_jump_m"])
    return f"{middle_mm:.3f} mm; in {lasts_s:.2g} s, up to {speeds:.3g} times the feed"


def main() -> None:
    """Print both tables."""
    print("smallest push that rigid friction of 450 N lets go at, within 0.25 and 4 s:")
    for words, disturbance in (
        ("undisturbed", UNDISTURBED),
        ("along the way", ALONG_THE_WAY),
        ("redrawn every 1 ms", REDRAWN),
    ):
        pushes = [smallest_push_n(wait_s, disturbance) for wait_s in (0.25, 4.0)]
        print(f"  {words}: {pushes[0]:.1f} N, {pushes[1]:.1f} N")
    for name in ("vibrated_feed_soft_at_rest", "steady_feed_soft"):
        print(f"largest jump of a part of 2000 and 900 N by {name}:")
        for words, variation, numbers in (
            ("undisturbed", "none", {}),
            ("drawn once", "part", {}),
            ("along the way, 10 mm", "field", {"correlation_length_m": 1e-2}),
            ("along the way, 1 mm", "field", {"correlation_length_m": 1e-3}),
            ("along the way, 0.1 mm", "field", {"correlation_length_m": 1e-4}),
            ("redrawn every 10 ms", "paper_random_factor", {"hold_s": 1e-2}),
            ("redrawn every 1 ms", "paper_random_factor", {"hold_s": 1e-3}),
        ):
            print(f"  {words}: {jumps(name, variation, one_part(**numbers))}")


if __name__ == "__main__":
    main()
