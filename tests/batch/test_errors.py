"""What cannot be run is refused before anything runs."""

import re
import subprocess
import sys

import numpy as np
import pytest

import breakaway as bk
from breakaway import _core
from breakaway.run.batch import METRICS
from breakaway.run.batch.columns import core_columns, number_paths

STICTION = "joint.stiction_n"


@pytest.fixture
def refusal(quick, monkeypatch):
    """Give the message with which a batch of three runs is refused, and let nothing run."""

    def of(scenario=quick, runs=3, **options):
        with monkeypatch.context() as patch:
            patch.setattr(_core, "run_many", lambda *_: pytest.fail("a batch was run"))
            with pytest.raises(bk.StudyError) as caught:
                bk.simulate_many(scenario, runs, **options)
        return str(caught.value)

    return of


@pytest.mark.parametrize("options", [{}, {"vary": {STICTION: bk.Uniform(low=400.0, high=500.0)}}])
def test_a_batch_beyond_the_memory(refusal, options):
    message = refusal(runs=2**32 - 1, **options)
    assert re.fullmatch(
        r"runs: 4,294,967,295 need \d{4}\.\d GiB of memory, but only \d+\.\d GiB are free; "
        r"ask for fewer metrics, or for fewer runs at a time",
        message,
    )


def test_columns_beyond_the_memory():
    vary = {STICTION: bk.Uniform(low=400.0, high=500.0)}
    population, method = bk.load_population("seized_parts"), bk.load_method("steady_feed")
    levels, many, more = [0.0] * 10**5, 10**15, 10**20
    for take, words in (
        (lambda: bk.draw_columns(vary, range(more), seed=0), "runs: 100,000,000,000,000,000,000"),
        (lambda: bk.draw_columns(vary, range(many), seed=0, design="sobol"), "runs: 1,000,000,"),
        (lambda: bk.draw_columns(vary, range(9), seed=0, design="sobol", total=many), "runs: 1,0"),
        (lambda: bk.grid_columns(dict.fromkeys("abc", levels)), "levels: 1,000,000,000,000,000 "),
        (lambda: bk.run_trial(population, method, runs=range(more), seed=0), "runs: 100,000,000"),
    ):
        with pytest.raises(bk.StudyError, match=f"^{words}.* GiB are free; "):
            take()


@pytest.mark.parametrize(
    "path",
    ["joint.stiction", "stiction_n", "joint.stiction_n.low", "", ".", "disturbance.bandwidth_hz"],
)
def test_unknown_paths_list_the_known(quick, refusal, path):
    message = refusal(vary={path: [1.0, 1.0, 1.0]})
    assert message.startswith(f"{path}: is not a number of the scenario; its numbers are ")
    known = message.partition("numbers are ")[2].split(", ")
    assert known == number_paths(quick)
    batch = bk.simulate_many(quick, 1, vary={known[0]: [450.0]})
    assert list(batch.varied) == known[:1]


def test_designed_gains_are_numbers_and_their_design_is_not(quick, refusal):
    assert quick.controller.gains.kind == "pole_placement"
    message = refusal(vary={"controller.gains.settling_time_s": [1.0, 1.0, 1.0]})
    assert "controller.gains.kp_n_per_m" in message


@pytest.mark.parametrize(
    "path",
    [
        "name",
        "seed",
        "joint",
        "joint.law",
        "controller.kind",
        "controller.gains.kind",
        "controller.anti_windup",
        "disturbance.acts_on",
        "timing.one_sample_delay",
        "timing.steps_per_period",
        "trace.every_samples",
    ],
)
def test_what_is_not_a_number_can_not_differ(refusal, path):
    message = refusal(vary={path: [1.0, 1.0, 1.0]})
    assert message == f"{path}: is not a number that can differ from run to run"


@pytest.mark.parametrize("path", ["timing.duration_s", "timing.control_period_s"])
def test_timing_is_shared(refusal, path):
    message = refusal(vary={path: [1e-5, 1e-5, 1e-5]})
    assert message.startswith(f"{path}: all runs of a batch share it; sweep it in a study")


@pytest.mark.parametrize(
    ("values", "shape"),
    [
        ([450.0] * 2, "(2,)"),
        ([450.0] * 4, "(4,)"),
        ([], "(0,)"),
        (450.0, "()"),
        ([[1.0] * 3], "(1, 3)"),
    ],
)
def test_one_value_for_each_run(refusal, values, shape):
    message = refusal(vary={STICTION: values})
    assert message == (
        f"vary['{STICTION}']: has the shape {shape}; give one value for each of 3 runs"
    )


@pytest.mark.parametrize("values", ["text", {"distribution": "uniform"}, [object()], [[1.0], 2.0]])
def test_neither_a_distribution_nor_numbers(refusal, values):
    message = refusal(vary={STICTION: values})
    assert message == (f"vary['{STICTION}']: {values!r} is neither a distribution nor numbers")


@pytest.mark.parametrize("value", [bk.Part(mass_kg=1.0), 3.0, None])
def test_not_a_distribution(refusal, value):
    with pytest.raises(
        bk.StudyError, match=r"^vary\['joint.stiction_n'\]: .* is not a distribution$"
    ):
        bk.draw_columns({STICTION: value}, range(3), seed=1)
    if isinstance(value, bk.Part):
        assert refusal(vary={STICTION: value}).endswith(" is not a distribution")


@pytest.mark.parametrize("bad", [-450.0, 0.0, -0.0, float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("row", [0, 1, 2])
def test_values_out_of_range(refusal, bad, row):
    values = [450.0, 460.0, 440.0]
    values[row] = bad
    message = refusal(vary={"part.mass_kg": [1.0, 1.0, 1.0], STICTION: values})
    reason = "> 0" if np.isfinite(bad) else "finite"
    assert message.startswith(f"run {row}: {STICTION}: {bad!r} is not {reason}; give a number > 0")
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("disturbance.var", 1.0, "is not < 1; give a number >= 0 and < 1"),
        ("limits.peak_force_max_n", 0.0, "is not > 0; give a number > 0"),
        ("controller.derivative_filter_s", -1e-9, "is not >= 0; give a number >= 0"),
        ("joint.residual_n", -1.0, "is not > 0; give a number > 0"),
    ],
)
def test_every_range_is_looked_at(quick, refusal, path, value, reason):
    middle = {"disturbance.var": 0.1, "controller.derivative_filter_s": 1e-4}.get(path, 1e3)
    message = refusal(vary={path: [middle, value, middle]})
    assert message.startswith(f"run 1: {path}: {value!r} {reason}")
    assert len(bk.simulate_many(quick, 2, vary={path: [middle, middle]})) == 2


def test_a_distribution_may_leave_the_range(quick, refusal):
    message = refusal(runs=2000, vary={STICTION: bk.Normal(mean=450.0, std=200.0)})
    drawn = bk.draw_columns(
        {STICTION: bk.Normal(mean=450.0, std=200.0)}, range(2000), seed=quick.seed
    )[STICTION]
    first = int(np.argmax(drawn <= 0.0))
    assert drawn[first] < 0.0
    assert message.startswith(f"run {first}: {STICTION}: {float(drawn[first])!r} is not > 0")


def test_rules_between_fields(quick, refusal):
    """Each number is within its range; together, those of a run in the middle are not."""
    fine = np.full(9, 1e-4)
    fine[5] = 1e-6
    message = refusal(runs=9, vary={"disturbance.hold_s": fine})
    assert message.startswith("run 5: disturbance.hold_s: 1e-06 is not >= timing.control_period_s")

    stiff = {"joint.stiffness_n_per_m": np.full(9, 3.6e7), "part.mass_kg": np.ones(9)}
    stiff["part.mass_kg"][4] = 0.01
    message = refusal(quick.with_({"timing.steps_per_period": 1}), runs=9, vary=stiff)
    assert message.startswith("run 4: timing.steps_per_period: 1 makes steps of 1e-05 s")

    law = quick.with_(
        joint=bk.TwoRegion(
            stiction_n=450.0,
            coulomb_n=360.0,
            stiffness_n_per_m=3.6e7,
            damping_n_s_per_m=9000.0,
            engagement_length_m=0.1,
        )
    )
    levels = {STICTION: [450.0, 350.0, 450.0], "joint.coulomb_n": [360.0, 360.0, 340.0]}
    message = refusal(law, vary=levels)
    assert message.startswith("run 1: joint.coulomb_n: 360.0 is not <= stiction_n = 350.0")


def test_more_numbers_than_corners(refusal):
    """So many that not every combination of extremes is tried."""
    scenario = bk.load_scenario("paper_as_computed_vibration_bounded").with_(
        {"timing.duration_s": 0.001}
    )
    resolved = bk.resolve(scenario)
    vary = {}
    for path in number_paths(scenario)[:-3]:
        value = resolved
        for name in path.split("."):
            value = getattr(value, name)
        if value is not None:
            vary[path] = [value] * 3
    assert len(vary) > 25
    assert len(bk.simulate_many(resolved, 3, vary=vary)) == 3
    vary["part.mass_kg"] = [1.0, 1.0, -1.0]
    assert refusal(resolved, vary=vary).startswith("run 2: part.mass_kg: -1.0 is not > 0")


def test_values_that_belong_together_are_accepted(quick):
    """Stiff with heavy and soft with light are fine; stiff with light would not be."""
    vary = {"joint.stiffness_n_per_m": [3.6e7, 3.6e8, 3.6e9], "part.mass_kg": [0.1, 1.0, 10.0]}
    batch = bk.simulate_many(quick, 3, vary=vary)
    assert batch["part.mass_kg"].tolist() == vary["part.mass_kg"]
    stated = quick.with_({"timing.steps_per_period": 1})
    batch = bk.simulate_many(stated, 3, vary=vary)
    with pytest.raises(bk.ScenarioError, match=r"^timing\.steps_per_period: "):
        stated.with_({"joint.stiffness_n_per_m": 3.6e9, "part.mass_kg": 0.1})


NO_RUNS = [0, -1, 1.0, True, None, "3", 2**32]
NO_RANGES = [range(0), range(5, 2), range(-1, 3), range(0, 6, 2), range(2**63, 2**63 + 3)]


@pytest.mark.parametrize("runs", [*NO_RUNS, *NO_RANGES, range(1, 2**32 + 1)])
def test_numbers_of_runs(refusal, runs):
    message = refusal(runs=runs)
    kind = isinstance(runs, range) or type(runs) is int
    wanted = (
        "a whole number from 1 to 4294967295, nor a " if kind else "a whole number or a range; "
    )
    assert message.startswith(f"runs: {runs!r} is not {wanted}")


@pytest.mark.parametrize("runs", [*NO_RUNS[:-1], *NO_RANGES])
def test_numbers_of_parts(runs):
    population, method = bk.load_population("seized_parts"), bk.load_method("steady_feed")
    with pytest.raises(bk.StudyError, match=r"^runs: .* is not a whole number .*or a range"):
        bk.run_trial(population, method, runs=runs, seed=0)


@pytest.mark.parametrize("metrics", ["iae_m_s", 5, iter(["iae_m_s"]), ["iae_m_s", 3], [None]])
def test_metrics_that_are_no_list(refusal, metrics):
    message = refusal(metrics=metrics)
    assert message == f"metrics: {metrics!r} is not a list of names; give one"


@pytest.mark.parametrize("metrics", [[], ()])
def test_metrics_that_are_none(refusal, metrics):
    assert refusal(metrics=metrics).startswith(f"metrics: {metrics!r} is empty; give some of ")


@pytest.mark.parametrize("name", ["iae", ""])
def test_metrics_that_are_unknown(refusal, name):
    message = refusal(metrics=["iae_m_s", name])
    assert message == f"metrics: {name!r} is not one of {', '.join(METRICS)}"


@pytest.mark.parametrize("vary", [None, {}, {STICTION: bk.Uniform(low=1.0, high=2.0)}])
@pytest.mark.parametrize("design", ["halton", None, ""])
def test_designs(refusal, design, vary):
    message = refusal(design=design, vary=vary)
    assert message.startswith(f"design: {design!r} is not one of random, sobol, ")


def test_shared_samples_of_different_length(refusal):
    vary = {
        STICTION: bk.Samples(values=[400.0, 450.0], rows="shared"),
        "part.mass_kg": bk.Samples(values=[1.0, 1.1, 1.2], rows="shared"),
    }
    message = refusal(vary=vary)
    assert message.startswith("vary: shared samples have different numbers of rows: ")
    assert message.endswith("they are columns of one table")


def test_a_joint_without_a_design(quick):
    """The controller is designed before the parts differ; what that says is a scenario's error."""
    heavy = quick.with_({"part.mass_kg": 450.0 / 9.81})
    with pytest.raises(bk.ScenarioError, match=r"^joint\.coulomb_n: "):
        bk.simulate(heavy)
    with pytest.raises(bk.ScenarioError, match=r"^joint\.coulomb_n: "):
        bk.simulate_many(heavy, 3)


def test_instructions_that_are_not_there(quick):
    with pytest.raises(bk.StudyError, match=r"^instructions: .abacus. is not one of "):
        bk.simulate_many(quick, 3, instructions="abacus")


THREADS_BEYOND_MEMORY = """
import resource
import breakaway as bk
scenario = bk.load_scenario("paper_as_computed").with_({"timing.duration_s": 0.01})
bk.simulate_many(scenario, 4, threads=2)
pages = int(open("/proc/self/statm").read().split()[0])
room = pages * resource.getpagesize() + 2**28  # for about a hundred stacks of 2 MiB
resource.setrlimit(resource.RLIMIT_AS, (room, room))
try:
    bk.simulate_many(scenario, 1000, threads=1000)
except bk.StudyError as error:
    print(error)
print(len(bk.simulate_many(scenario, 4, threads=2)))
"""


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks the kernel for few threads")
def test_threads_that_do_not_start_are_told_and_the_next_batch_runs():
    done = subprocess.run(
        [sys.executable, "-c", THREADS_BEYOND_MEMORY], capture_output=True, text=True, check=False
    )
    said, after = done.stdout.splitlines()
    assert said.startswith("threads: 1000 cannot be started (")
    assert said.endswith("); give a smaller number")
    assert (after, done.stderr, done.returncode) == ("4", "", 0)


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, "all", 1025, 10**20])
def test_numbers_of_threads(refusal, threads):
    end = " >= 1 and <= 1024" if type(threads) is int else "; give one"
    assert refusal(threads=threads) == f"threads: {threads!r} is not a whole number{end}"


def test_places_beyond_the_numbers_are_refused_by_the_binding(quick):
    shared, _ = core_columns(quick, {})
    runs = np.arange(3, dtype=np.uint64)
    for place, count in ((10**6, 3), (0, 2), (0, 4)):
        varied = [(place, np.zeros(count))]
        with pytest.raises(bk.BreakawayError, match=f"number {place} of .* has {count} values"):
            _core.run_many(shared, runs, varied, ["iae_m_s"], False, 1, "portable", print)
