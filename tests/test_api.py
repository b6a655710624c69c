"""The public face: its names, their documentation, and that runs can be reproduced."""

import inspect
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from math import ceil

import numpy as np
import pytest

import breakaway as bk

COLUMNS = (
    "t_s",
    "reference_m",
    "position_m",
    "velocity_m_per_s",
    "bristle_m",
    "applied_force_n",
    "joint_force_n",
)


@pytest.fixture(scope="module")
def scenario():
    return bk.load_scenario("paper_as_computed")


@pytest.fixture(scope="module")
def rough(scenario):
    """Disturbed, short, and every sample traced."""
    return scenario.with_(
        {"timing.duration_s": 0.05, "trace.every_samples": 1},
        disturbance=bk.UniformDisturbance(var=0.2, hold_s=1e-4),
        seed=3,
    )


def assert_same_bits(one, other):
    assert one.outcome == other.outcome
    assert repr(one.metrics) == repr(other.metrics)  # repr, since 0.0 equals -0.0
    for name in COLUMNS:
        assert one.trace[name].tobytes() == other.trace[name].tobytes(), name


# Results are equal where their values are


def test_equal_runs_are_equal(rough):
    one, other = bk.simulate(rough), bk.simulate(rough)
    assert np.isnan(one.metrics.time_to_release_s)
    assert one.metrics == other.metrics
    assert one == other
    assert one != bk.simulate(rough, run_index=1)
    assert one != bk.simulate(rough.with_(name="another"))
    assert one.metrics != one


def test_equal_batches_and_motions_are_equal(rough):
    columns = {"joint.stiction_n": [400.0, 450.0]}
    one = bk.simulate_many(rough, 2, vary=columns)
    assert one == bk.simulate_many(rough, 2, vary=columns)
    assert one != bk.simulate_many(rough, 2)
    assert one != bk.simulate_many(rough, 2, vary={"joint.stiction_n": [400.0, 451.0]})
    joint = bk.resolve(rough).joint
    moves = [bk.impose_motion(joint, np.full(5, v), period_s=1e-5) for v in (0.1, 0.1, 0.2)]
    assert moves[0] == moves[1] != moves[2]


# The words that a user writes


def test_simulating():
    scenario = bk.load_scenario("paper_as_computed")
    run = bk.simulate(scenario)
    assert run.outcome == bk.Outcome.RELEASED == "released"
    assert run.metrics.iae_m_s == pytest.approx(3.036e-6, rel=1e-3)
    assert run.metrics.peak_force_n == pytest.approx(601.3, abs=0.2)
    assert run.seed == scenario.seed
    assert tuple(run.trace) == COLUMNS
    for name in COLUMNS:
        column = run.trace[name]
        assert (column.dtype, column.shape) == (np.float64, (5001,))
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 1.0
    with pytest.raises(TypeError):
        run.trace["t_s"] = np.zeros(3)


@pytest.mark.slow
def test_dataset(rough):
    run = bk.simulate(rough)
    data = run.to_xarray()
    assert set(data.data_vars) == set(COLUMNS) - {"t_s"}
    assert data["position_m"].dims == ("t_s",)
    for name in COLUMNS:
        np.testing.assert_array_equal(data[name].values, run.trace[name])
        unit = {"n": "N", "s": "m/s" if "velocity" in name else "s", "m": "m"}
        assert data[name].attrs["units"] == unit[name.rpartition("_")[2]]
    assert data.attrs["seed"] == 3
    assert data.attrs["outcome"] == run.outcome


def test_a_frame(rough, monkeypatch):
    run = bk.simulate(rough)
    frame = run.to_pandas()
    assert frame.index.name == "t_s"
    for name in COLUMNS[1:]:
        np.testing.assert_array_equal(frame[name], run.trace[name])
    with pytest.raises(bk.ScenarioError, match=r"^trace\.every_samples: is 0"):
        bk.simulate(rough.with_({"trace.every_samples": 0})).to_pandas()
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(bk.StudyError, match=r"pip install 'breakaway\[pandas\]'"):
        run.to_pandas()


def too_fast(run):
    return [said for said in run.warnings if said.startswith("the part moved at")]


def test_a_run_beyond_the_passive_speed_is_warned_of(scenario):
    """The reference peaks at 15/8 of 0.1 m in 0.5 s, and 4 F_c0 / c is 0.16 m/s."""
    (said,) = bk.simulate(scenario).warnings
    assert said == (
        "the part moved at 0.375 m/s, above 4 g / c = 0.16 m/s at the seat: there bristles of "
        "constant damping may push it; give joint.damping_velocity_m_per_s"
    )
    damped = bk.resolve(scenario).with_({"controller.gains.kd_n_s_per_m": 2500.0})  # no limit cycle
    slow = {"reference.duration_s": 1.5, "timing.duration_s": 1.5}  # peaks at 0.125 m/s
    silent = {"trace.every_samples": 0}
    for held, changes in (
        (scenario, {"joint.damping_velocity_m_per_s": 0.3}),
        (scenario, silent),
        (damped, slow),
    ):
        assert not too_fast(bk.simulate(held.with_(changes)))
    assert too_fast(bk.simulate(damped))


def test_a_part_that_is_free_may_be_fast(scenario):
    damped = bk.resolve(scenario).with_(
        {"controller.gains.kd_n_s_per_m": 2500.0, "joint.engagement_length_m": 0.005}
    )
    run = bk.simulate(damped)
    velocity, held = run.trace["velocity_m_per_s"], run.trace["position_m"] < 0.005
    assert abs(velocity).max() > 0.3 and abs(velocity[held]).max() > 0.13
    assert not too_fast(run)


def test_elements_that_attract_too_fast_are_warned_of(scenario):
    """k_e F_c0 / c is 1.44e6 N/s."""
    numbers = scenario.joint.model_dump(exclude={"law"})
    for attraction, warned in ((1.4e6, False), (1.5e6, True)):
        joint = bk.Gms(**numbers, attraction_n_per_s=attraction)
        short = scenario.with_({"timing.duration_s": 0.01}, joint=joint)
        said = bk.simulate(short).warnings
        assert [one.startswith("joint.attraction_n_per_s = 1.5e+06") for one in said] == [
            True
        ] * warned


def test_warnings(scenario):
    changes = {
        "limits.diverged_force_n": 400.0,
        "limits.breakaway_travel_m": 1e-5,
        "controller.gains": bk.Gains(kp_n_per_m=-1.0, ki_n_per_m_s=1e9, kd_n_s_per_m=700.0),
    }
    said = bk.simulate(scenario.with_(changes)).warnings
    starts = (
        "diverged at ",
        "limits.breakaway_travel_m = 10 µm is within the presliding travel 12.5 µm",
        "controller.gains: a gain is negative: kp = -1 N/m",
        "the joint let go at ",
    )
    assert len(said) >= 3
    for sentence in said:
        assert sentence.startswith(starts) and len(sentence.splitlines()) == 1


def test_results_are_shown_in_a_line(scenario):
    named = scenario.with_(name="<b>5 & 6")
    for result in (bk.simulate(named), bk.simulate_many(named, 3)):
        line = repr(result)
        assert "<b>5 & 6" in line
        assert "released" in line
        assert len(line) < 200 and len(line.splitlines()) == 1
        assert "&lt;b&gt;5 &amp; 6" in result._repr_html_()
        assert "<b>" not in result._repr_html_()
    assert len(repr(bk.Samples(values=[1.0] * 100_000))) < 200
    assert "peak_force_n=" in repr(bk.simulate(named).metrics)


def test_designing(scenario):
    gains = bk.design.pole_placement(
        scenario.joint, mass_kg=1.0, settling_time_s=5e-4, damping_ratio=1.0, pole_per_s=200.0
    )
    for part in (gains.static, gains.dynamic, gains.total):
        assert all(np.isfinite([part.kp, part.ki, part.kd]))
    run = bk.simulate(scenario)
    given = run.scenario.controller.gains
    assert (given.kp_n_per_m, given.ki_n_per_m_s, given.kd_n_s_per_m) == (
        gains.total.kp,
        gains.total.ki,
        gains.total.kd,
    )


def test_changing(scenario):
    changed = scenario.with_(disturbance=bk.UniformDisturbance(var=0.05, hold_s=1e-4), seed=7)
    assert (changed.disturbance.var, changed.seed) == (0.05, 7)
    assert bk.simulate(changed).seed == 7


@pytest.mark.slow
def test_importing_is_quick_and_a_star_gives_every_name():
    """Numbers and tables are loaded with the first name that needs them."""
    code = (
        "import sys, breakaway\n"
        "heavy = {'numpy', 'pyarrow', 'pydantic', 'scipy'} & sys.modules.keys()\n"
        "assert not heavy, heavy\n"
        "from breakaway import *\n"
        "missing = set(breakaway.__all__) - globals().keys()\n"
        "assert not missing, missing\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("first", ["simulate", "resolve", "impose_motion"])
def test_names_are_functions_whatever_is_used_first(first):
    """Importing a module must not put it in the place of a function."""
    code = (
        f"import breakaway as bk; bk.{first}\n"
        "import breakaway.run.simulation, breakaway.run.resolution\n"
        "scenario = bk.load_scenario('paper_as_computed')\n"
        "assert bk.simulate(bk.resolve(scenario)).outcome == 'released'\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# Names and their documentation

HOMES = [(bk, name) for name in bk.__all__] + [(bk.design, name) for name in bk.design.__all__]


@pytest.mark.parametrize(("home", "name"), HOMES, ids=[name for _, name in HOMES])
def test_every_name_resolves_and_is_documented(home, name):
    value = getattr(home, name)
    if name == "__version__":
        assert re.fullmatch(r"\d+\.\d+\.\d+.*", value)
        return
    assert inspect.isclass(value) or inspect.isfunction(value) or inspect.ismodule(value)
    assert len(value.__doc__ or "") > 10
    inherited = (base.__doc__ for base in getattr(value, "__mro__", ())[1:])
    assert value.__doc__ not in inherited


def test_names_are_sorted_and_unique():
    assert bk.__all__ == sorted(set(bk.__all__))
    assert bk.__dir__() == bk.__all__
    with pytest.raises(AttributeError, match="simulat"):
        _ = bk.simulat


def test_every_figure_is_documented_with_its_unit():
    source = inspect.getsource(bk.RunMetrics)
    for name in bk.RunMetrics.__dataclass_fields__:
        assert re.search(rf'{name}: float\n    """.+', source), name


# Reproducibility


def test_same_seed_and_run_give_the_same_bits(rough):
    assert_same_bits(bk.simulate(rough, run_index=5), bk.simulate(rough, run_index=5))


def test_other_seeds_and_runs_differ(rough):
    def mark(scenario, run_index=0):
        return bk.simulate(scenario, run_index=run_index).metrics.iae_m_s

    runs = {mark(rough, index) for index in (0, 1, 2, 2**32, 2**64 - 1)}
    seeds = {mark(rough.with_(seed=seed)) for seed in (0, 1, 2**32, 2**63 - 1)}
    assert len(runs | seeds) == 9


def test_without_a_disturbance_seeds_do_not_matter(rough):
    calm = rough.with_({"disturbance.var": 0.0})
    assert_same_bits(bk.simulate(calm), bk.simulate(calm.with_(seed=8), run_index=3))


def test_threads_do_not_matter(rough):
    alone = [bk.simulate(rough, run_index=index) for index in range(8)]
    with ThreadPoolExecutor(max_workers=4) as pool:
        together = list(pool.map(lambda index: bk.simulate(rough, run_index=index), range(8)))
    for one, other in zip(alone, together, strict=True):
        assert_same_bits(one, other)


# Trace and figures


@pytest.mark.parametrize("every", [2, 7, 10, 4999, 5000, 100_000])
def test_traces_agree_row_by_row(rough, every):
    full = bk.simulate(rough)
    sparse = bk.simulate(rough.with_({"trace.every_samples": every}))
    rows = np.append(np.arange(0, 5000, every), 5000)  # the end is always there
    for name in COLUMNS:
        np.testing.assert_array_equal(sparse.trace[name], full.trace[name][rows], err_msg=name)
    assert repr(sparse.metrics) == repr(full.metrics)


def test_without_a_trace_the_figures_are_the_same(rough):
    silent = bk.simulate(rough.with_({"trace.every_samples": 0}))
    assert all(column.size == 0 for column in silent.trace.values())
    assert repr(silent.metrics) == repr(bk.simulate(rough).metrics)


@pytest.mark.parametrize("method", ["steady_feed", "vibrated_feed"])
def test_the_trace_of_a_feed_axis_has_drive_tool_and_tip(method):
    population, method = bk.load_population("seized_parts"), bk.load_method(method)
    part = bk.run_trial(population, method, runs=range(1), seed=0).scenario(0)
    run = bk.simulate(part.with_({"timing.duration_s": 0.3}))
    assert tuple(run.trace) == (*COLUMNS, "feed_m", "tool_m", "tip_m")
    assert set(run.to_xarray().data_vars) == set(run.trace) - {"t_s"}
    feed, tool, tip = (run.trace[name] for name in ("feed_m", "tool_m", "tip_m"))
    assert feed[0] == tool[0] == tip[0] == -method.actuator.contact.gap_m
    assert method.actuator.tip.kind == "piezo" or np.array_equal(tool, tip)
    shorter = bk.simulate(part.with_({"timing.duration_s": 0.2}))
    sparse = bk.simulate(part.with_({"timing.duration_s": 0.3, "trace.every_samples": 10}))
    for name, values in run.trace.items():
        if "force" not in name:  # of the period that the last row ends
            assert shorter.trace[name][-1] == values[len(shorter.trace[name]) - 1], name
        np.testing.assert_array_equal(sparse.trace[name][:600], values[:6000:10], err_msg=name)


@pytest.mark.parametrize("every", [1, 7])
def test_a_feed_axis_that_diverges_has_a_row_of_everything(every):
    population, method = bk.load_population("seized_parts"), bk.load_method("vibrated_feed")
    part = bk.run_trial(population, method, runs=range(1), seed=0).scenario(0)
    run = bk.simulate(part.with_({"limits.diverged_force_n": 50.0, "trace.every_samples": every}))
    assert run.outcome == "diverged"
    assert len({column.shape for column in run.trace.values()}) == 1
    assert (np.diff(run.trace["feed_m"]) >= 0.0).all()


@pytest.mark.parametrize("every", [10, 1000])
def test_the_trace_of_a_run_that_diverges_ends_where_it_does(scenario, every):
    unstable = scenario.with_(
        {
            "controller.gains": bk.Gains(  # Table II with vibration
                kp_n_per_m=828.2e3, ki_n_per_m_s=823940e3, kd_n_s_per_m=662.5
            ),
            "trace.every_samples": 1,
            "timing.duration_s": 0.25,
        }
    )
    full = bk.simulate(unstable)
    assert full.outcome == "diverged"
    assert full.metrics.simulated_s < 0.249
    sparse = bk.simulate(unstable.with_({"trace.every_samples": every}))
    assert repr(sparse.metrics) == repr(full.metrics)
    for run in (full, sparse):
        t_s = run.trace["t_s"]
        assert np.all(np.diff(t_s) > 0)
        assert t_s[-1] <= run.metrics.simulated_s + 2 * 1e-5
    rows = np.rint(sparse.trace["t_s"] / 1e-5).astype(int)
    shared = rows < full.trace["t_s"].size - 1
    assert shared.sum() >= 20
    for name in COLUMNS:
        np.testing.assert_array_equal(
            sparse.trace[name][shared], full.trace[name][rows[shared]], err_msg=name
        )


def test_figures_follow_from_a_full_trace(rough):
    """By numpy's sums over the samples; the last row is the state at the end, not a sample."""
    run = bk.simulate(rough)
    period = 1e-5
    t, r, x, _, _, force, joint_force = (run.trace[name][:-1] for name in COLUMNS)
    error, travel = np.abs(r - x), np.diff(run.trace["position_m"])
    expected = {
        "iae_m_s": np.sum(error) * period,
        "ise_m2_s": np.sum(error**2) * period,
        "itae_m_s2": np.sum(t * error) * period,
        "largest_error_m": error.max(),
        "peak_over_breakaway": np.abs(force).max() / 450.0,
        "mean_force_n": force.mean(),
        "rms_force_n": np.sqrt(np.mean(force**2)),
        "impulse_n_s": np.sum(force) * period,
        "work_j": np.sum(force * travel),
        "friction_loss_j": np.sum(joint_force * travel)
        - 0.5 * 3.6e7 * run.trace["bristle_m"][-1] ** 2,
        "contact_time_s": np.sum(force > 0) * period,
        "simulated_s": 0.05,
    }
    for name, value in expected.items():
        assert getattr(run.metrics, name) == pytest.approx(value, rel=1e-9), name
    assert run.metrics.peak_force_n == np.abs(force).max()
    assert run.metrics.final_position_m == run.trace["position_m"][-1]
    pushes = np.diff(np.r_[0, (force > 0).astype(int)]) == 1
    assert run.metrics.impacts == pushes.sum()
    loose = run.trace["position_m"] > 2 * 450.0 / 3.6e7
    after = loose.argmax()
    before_s, after_s = run.trace["t_s"][after - 1 : after + 1]
    assert before_s < run.metrics.time_to_breakaway_s <= after_s
    assert np.isnan(run.metrics.time_to_release_s)
    assert run.metrics.to_dict()["time_to_release_s"] is None


def test_energy_is_conserved(rough):
    """Work of the actuator = kinetic energy + work on the joint, exactly so for held forces."""
    run = bk.simulate(rough)
    x, v = run.trace["position_m"], run.trace["velocity_m_per_s"]
    work = np.cumsum(run.trace["applied_force_n"][:-1] * np.diff(x))
    on_joint = np.cumsum(run.trace["joint_force_n"][:-1] * np.diff(x))
    np.testing.assert_allclose(work - on_joint, 0.5 * v[1:] ** 2, rtol=0, atol=1e-12 * work[-1])


# Random draws


def philox4x32(counter, key):
    """Philox4x32-10 from its paper: Salmon, Moraes, Dror and Shaw, SC 2011."""
    c, k, mask = list(counter), list(key), 0xFFFFFFFF
    for _ in range(10):
        low, high = c[0] * 0xD2511F53, c[2] * 0xCD9E8D57
        c = [(high >> 32) ^ c[1] ^ k[0], high & mask, (low >> 32) ^ c[3] ^ k[1], low & mask]
        k = [(k[0] + 0x9E3779B9) & mask, (k[1] + 0xBB67AE85) & mask]
    return c


def uniform(seed, run, index):
    """Draw number `index` of the disturbance (stream 0): uniform on [-1, 1), 53 bits."""
    words = philox4x32([index, 0, run & 0xFFFFFFFF, run >> 32], [seed & 0xFFFFFFFF, seed >> 32])
    return (((words[1] << 32) | words[0]) >> 11) * 2.0**-52 - 1.0


def test_philox_known_answers():
    """Vectors published with Random123."""
    ones = 0xFFFFFFFF
    assert philox4x32([0] * 4, [0] * 2) == [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]
    assert philox4x32([ones] * 4, [ones] * 2) == [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]


@pytest.mark.parametrize("hold_s", [1e-5, 1e-4, 3.7e-5])
@pytest.mark.parametrize(("seed", "run_index"), [(0, 0), (7, 3), (2**63 - 1, 2**64 - 2)])
def test_draws_are_philox(scenario, seed, run_index, hold_s):
    """The factor on the joint force, from the trace of a midpoint step: R = k_e z + c dz/dt."""
    var, samples = 0.3, 400
    run = bk.simulate(
        scenario.with_(
            {"timing.duration_s": samples * 1e-5, "trace.every_samples": 1},
            disturbance=bk.UniformDisturbance(var=var, hold_s=hold_s),
            reference=bk.StepReference(distance_m=1e-4),
            seed=seed,
        ),
        run_index=run_index,
    )
    z = run.trace["bristle_m"]
    undisturbed = 3.6e7 * (z[1:] + z[:-1]) / 2 + 9000.0 * np.diff(z) / 1e-5
    factor = run.trace["joint_force_n"][:-1] / undisturbed
    first_samples = [ceil(j * hold_s / 1e-5 - 1e-6) for j in range(samples + 1)]
    draws = np.searchsorted(first_samples, np.arange(samples), side="right") - 1
    expected = [1.0 + var * uniform(seed, run_index, int(j)) for j in draws]
    clear = np.abs(undisturbed) > 1.0  # elsewhere rounding is divided by little
    assert clear.sum() > 0.9 * samples
    np.testing.assert_allclose(factor[clear], np.array(expected)[clear], rtol=1e-9)


def test_a_disturbed_friction_level_leaves_a_stuck_joint_at_rest(scenario):
    """What multiplies the joint force jolts it; what multiplies the friction level does not."""

    def travel(acts_on):
        held = scenario.with_(
            {
                "controller.gains": bk.Gains(kp_n_per_m=100.0, ki_n_per_m_s=0.0, kd_n_s_per_m=0.0),
                "limits.diverged_error_m": 10.0,
                "timing.duration_s": 0.2,
            },
            reference=bk.StepReference(distance_m=1.0),  # 100 N of the 450 N that it takes
            disturbance=bk.UniformDisturbance(var=0.3, hold_s=1e-3, acts_on=acts_on),
        )
        run = bk.simulate(held)
        late = run.trace["t_s"] > 0.01
        return np.ptp(run.trace["position_m"][late])

    assert travel("friction_level") < 1e-9
    assert travel("joint_force") > 1e-6
