"""What public functions take: documented, and refused in one line where it is of a wrong kind."""

import inspect
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import breakaway as bk


@pytest.fixture(scope="module")
def scenario():
    return bk.load_scenario("paper_as_computed")


HOMES = [(bk, name) for name in bk.__all__] + [(bk.design, name) for name in bk.design.__all__]


def public_functions():
    for home, name in HOMES:
        value = getattr(home, name)
        if inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value):
            for inner, method in vars(value).items():
                function = getattr(method, "__func__", method)
                if not inner.startswith("_") and inspect.isfunction(function):
                    yield f"{name}.{inner}", function


FUNCTIONS = dict(public_functions())


def parameters_of(function):
    stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    return {
        name: stars.get(parameter.kind, "")
        for name, parameter in inspect.signature(function).parameters.items()
        if name not in ("self", "cls")
    }


def test_functions_are_found():
    assert {"simulate", "resolve", "pole_placement", "Scenario.with_", "Run.to_xarray"} <= set(
        FUNCTIONS
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_parameter_is_documented(name):
    """In a section of its own, as `numpydoc` has it; and no parameter that is not there."""
    text = inspect.getdoc(FUNCTIONS[name]) or ""
    assert text, name
    _, _, after = text.partition("Parameters\n----------\n")
    section = re.split(r"\n\w+\n-+\n", after)[0]
    documented = re.findall(r"^(\*{0,2}\w+)(?: : .+)?$", section, re.MULTILINE)
    expected = [stars + parameter for parameter, stars in parameters_of(FUNCTIONS[name]).items()]
    assert documented == expected


@pytest.mark.parametrize("name", FUNCTIONS)
def test_unknown_arguments_are_refused(name):
    if name in ("Scenario.with_", "Log.using"):  # by name, in tests/scenario and tests/logs
        return
    if name == "compare_laws":  # hands its settings on to identify
        with pytest.raises(TypeError, match="no_such_argument"):
            bk.compare_laws(
                bk.Log(t_s=range(10), force_n=range(10)), held_out=(0, 1), no_such_argument=1
            )
        return
    with pytest.raises(TypeError, match="no_such_argument"):
        inspect.signature(FUNCTIONS[name]).bind_partial(no_such_argument=1)
    with pytest.raises(TypeError, match=r"no_such_argument|missing|argument"):
        FUNCTIONS[name](no_such_argument=1)


def test_whole_numbers_of_numpy_are_whole_numbers(scenario):
    one = bk.simulate(scenario, run_index=np.int64(3))
    assert type(one.run_index) is int
    assert one == bk.simulate(scenario, run_index=3)
    batch = bk.simulate_many(scenario, np.uint32(2), threads=np.int8(1), metrics=["iae_m_s"])
    assert len(batch) == 2
    assert batch.replay(np.int64(1)).metrics.iae_m_s == batch["iae_m_s"][1]


@pytest.mark.parametrize("run_index", [-1, 2**64, 1.5, "0", None])
def test_a_run_index_out_of_range_is_refused(scenario, run_index):
    with pytest.raises(bk.ScenarioError, match=rf"^run_index: {run_index!r} is not"):
        bk.simulate(scenario, run_index=run_index)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("velocity_m_per_s", [[1e-3]]),
        ("velocity_m_per_s", [float("nan")]),
        ("velocity_m_per_s", [float("inf")]),
        ("period_s", 0.0),
        ("period_s", -1e-3),
        ("period_s", float("nan")),
        ("period_s", float("inf")),
        ("start_m", float("nan")),
        ("start_m", float("inf")),
    ],
)
def test_an_imposed_motion_out_of_range_is_refused(scenario, name, value):
    joint = scenario.joint.model_copy(update={"residual_n": 9.81})
    good = {"velocity_m_per_s": [1e-3] * 3, "period_s": 1e-3, "start_m": 0.0}
    assert bk.impose_motion(joint, **good).joint_force_n.size == 3
    with pytest.raises(bk.ScenarioError, match=rf"^{name}: "):
        bk.impose_motion(joint, **{**good, name: value})
    with pytest.raises(bk.ScenarioError, match=r"^joint\.residual_n: is missing; give"):
        bk.impose_motion(scenario.joint, **good)


@pytest.mark.parametrize("given", ["paper_as_computed", Path("mine.toml"), None])
def test_what_is_no_scenario_is_refused(given, tmp_path):
    takers = (
        bk.resolve,
        bk.simulate,
        lambda given: bk.simulate_many(given, runs=2),
        lambda given: bk.export_c(given, out=tmp_path / "c"),
        lambda given: bk.export_fmu(given, out=tmp_path / "rig.fmu"),
    )
    for take in takers:
        with pytest.raises(bk.ScenarioError, match=r"^scenario: .* is not a Scenario; load a "):
            take(given)
    assert not list(tmp_path.iterdir())


# Arguments of a wrong kind, function by function

WRONG = (None, 5, "x", object(), [], {})


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """One of everything that public functions take, as small as it may be."""
    folder = tmp_path_factory.mktemp("world")
    scenario = bk.load_scenario("paper_as_computed").with_(
        {"timing.duration_s": 0.002, "trace.every_samples": 10}
    )
    population = bk.load_population("seized_parts").model_copy(update={"duration_s": 0.01})
    method = bk.load_method("steady_feed")
    log = sliding_log()
    found = bk.identify(log, law="coulomb", starts=1)
    changes = {"disturbance.var": 0.1, "timing.duration_s": 0.002}
    study = bk.SweepStudy(scenario="paper_as_computed", changes=changes, runs=2)
    tuning = small_tuning(population)
    joint = bk.JointFile.from_identification(found)
    joint.save(folder / "joint.toml")
    rig = bk.RigFile(stiffness_n_per_m=1e6)
    rig.save(folder / "rig.toml")
    (folder / "limits.toml").write_text("jump_max_m = 1e-4\n")
    rows = "".join(f"{k / 100},{k / 1000},2.5\n" for k in range(20))
    (folder / "log.csv").write_text("t_s,position_m,force_n\n" + rows)
    comparison = bk.compare_methods(population, [method], laws="lugre", runs=2, baselines=[])
    return SimpleNamespace(
        folder=folder,
        scenario=scenario,
        population=population,
        method=method,
        log=log,
        starts=[breakaway_log(force_n) for force_n in (80.0, 100.0, 130.0)],
        found=found,
        joint=joint,
        rig=rig,
        fit=bk.identify_inertia_friction(log),
        parts=bk.fit_population(breakaway_log(force_n) for force_n in (80.0, 100.0, 130.0)),
        run=bk.simulate(scenario),
        batch=bk.simulate_many(scenario, 2),
        trial=bk.run_trial(population, method, runs=2, seed=0),
        study=study,
        tuning=tuning,
        studied=bk.run_study(study, out=folder / "study"),
        tuned=bk.tune(tuning, out=folder / "tuning"),
        comparison=comparison,
        advised=bk.advise(population, "fast_force", parts_max=16, budget_s=1e6),
        pid=bk.design.SampledPid(bk.design.PidGains(kp=3.1e6, ki=1.3e9, kd=724.0), period_s=1e-5),
    )


def sliding_log():
    t_s = np.arange(1500) / 1000.0
    x = 0.1 * np.sin(9 * t_s) + 0.02 * np.sin(33 * t_s)
    v = 0.9 * np.cos(9 * t_s) + 0.66 * np.cos(33 * t_s)
    a = -8.1 * np.sin(9 * t_s) - 21.78 * np.sin(33 * t_s)
    noise_n = 0.1 * np.random.default_rng(0).standard_normal(1500)
    force_n = 2.0 * a + 5.0 * np.sign(v) + 20.0 * v + noise_n
    return bk.Log(t_s=t_s, position_m=x, force_n=force_n)


def breakaway_log(force_n):
    t_s = np.arange(400) / 100.0
    slip = 0.4 + 0.5 * np.exp(-(t_s - 1.0) / 0.02)
    load = force_n * np.where(t_s <= 1.0, 0.9 * t_s, slip)
    return bk.Log(t_s=t_s, position_m=0.01 * np.maximum(t_s - 1.0, 0.0), force_n=load)


def small_tuning(population):
    return bk.Tuning(
        population=population,
        method="steady_feed",
        objectives=["strict_share"],
        tune={"controller.speed_m_per_s": {"low": 0.01, "high": 0.03}},
        training_runs=2,
        test_runs={"first": 100, "runs": 2},
        evaluations=1,
    )


def calls(w):
    """A valid call of every public function and method: the function, and its arguments."""
    joint, t_s = w.scenario.joint, np.arange(50) / 1e3
    trace = {"t_s": t_s, "reference_m": 0.1 * t_s, "velocity_m_per_s": 0.1 + 0.01 * np.sin(t_s)}
    distribution = bk.Uniform(low=400.0, high=500.0)
    loop = bk.design.open_loop(w.pid, bk.design.sliding_plant(joint, 1.0))
    imposed = joint.model_copy(update={"residual_n": 9.81})
    poles = {"settling_time_s": 5e-4, "damping_ratio": 1.0, "pole_per_s": 200.0}
    vary = {"vary": {"joint.stiction_n": distribution}, "runs": 2, "seed": 0}
    return {
        "Batch.replay": (w.batch.replay, {"i": 0}),
        "Batch.scenario_of": (w.batch.scenario_of, {"i": 0}),
        "Channel": (bk.Channel, {"name": "force_n", "t_s": t_s, "values": t_s}),
        "ComparedController.applied_to": (
            bk.ComparedController(name="one").applied_to,
            {"base": w.scenario},
        ),
        "Comparison.row": (w.comparison.row, {"law": "lugre", "method": w.method.name}),
        "Comparison.trial": (w.comparison.trial, {"law": "lugre", "method": w.method.name}),
        "Identification.aic_for": (w.found.aic_for, {"rows": 10.0}),
        "Identification.draws": (w.found.draws, {"samples": 2}),
        "Identification.posterior": (w.found.posterior, {"samples": 2}),
        "Identification.predict": (w.found.predict, {}),
        "Identification.profile": (w.found.profile, {"name": "coulomb_n"}),
        "JointFile.from_fit": (bk.JointFile.from_fit, {"fit": w.fit, "log": w.log}),
        "JointFile.from_identification": (bk.JointFile.from_identification, {"found": w.found}),
        "JointFile.load": (bk.JointFile.load, {"path": w.folder / "joint.toml"}),
        "JointFile.origin": (w.joint.origin, {"field": "joint.coulomb_n"}),
        "JointFile.save": (w.joint.save, {"path": w.folder / "joint.toml"}),
        "Log": (bk.Log, {"t_s": t_s, "position_m": t_s}),
        "Log.between": (w.log.between, {"start_s": 0.1, "end_s": 0.9}),
        "Log.channel": (w.log.channel, {"name": "force_n"}),
        "Log.from_channels": (bk.Log.from_channels, {"channels": [*w.log.channels.values()]}),
        "Log.noted": (w.log.noted, {"note": "a line"}),
        "Log.resampled": (w.log.resampled, {"rate_hz": 100.0}),
        "Log.using": (w.log.using, {"pull_n": "force_n"}),
        "LogNormal.quantile": (bk.LogNormal(median=1.0, sigma=0.1).quantile, {"u": t_s}),
        "LogNormal.scaled": (bk.LogNormal(median=1.0, sigma=0.1).scaled, {"factor": 1.0}),
        "LogUniform.quantile": (bk.LogUniform(low=1.0, high=2.0).quantile, {"u": t_s}),
        "LogUniform.scaled": (bk.LogUniform(low=1.0, high=2.0).scaled, {"factor": 1.0}),
        "Method.told": (w.method.told, {"engagement_length_m": t_s + 1.0}),
        "Method.tuned_among": (w.method.tuned_among, {"seed": 0, "numbers": range(4)}),
        "Normal.quantile": (bk.Normal(mean=1.0, std=0.1).quantile, {"u": t_s}),
        "Normal.scaled": (bk.Normal(mean=1.0, std=0.1).scaled, {"factor": 1.0}),
        "PidGains": (bk.design.PidGains, {"kp": 1.0, "ki": 1.0, "kd": 1.0}),
        "Population.correlated": (w.parts.correlated, {"count": 2}),
        "RigFile.at_part": (w.rig.at_part, {"log": w.log}),
        "RigFile.load": (bk.RigFile.load, {"path": w.folder / "rig.toml"}),
        "RigFile.save": (w.rig.save, {"path": w.folder / "rig.toml"}),
        "SampledPid": (bk.design.SampledPid, {"gains": w.pid.gains, "period_s": 1e-5}),
        "Samples.quantile": (bk.Samples(values=(1.0, 2.0)).quantile, {"u": t_s}),
        "Samples.scaled": (bk.Samples(values=(1.0, 2.0)).scaled, {"factor": 1.0}),
        "Scenario.with_": (w.scenario.with_, {"changes": {}, "seed": 3}),
        "StudyResult.replay": (w.studied.replay, {"point": 0, "run_index": 0}),
        "StudyResult.scan": (w.studied.scan, {}),
        "Trial.replay": (w.trial.replay, {"i": 0}),
        "Trial.scenario": (w.trial.scenario, {"i": 0}),
        "Trial.within": (w.trial.within, {"limits": w.population.strict}),
        "Tuning.tuned": (w.tuning.tuned, {"numbers": {"controller.speed_m_per_s": 0.02}}),
        "Uniform.quantile": (distribution.quantile, {"u": t_s}),
        "Uniform.scaled": (distribution.scaled, {"factor": 1.0}),
        "compare_laws": (
            bk.compare_laws,
            {"log": w.log, "held_out": (1.0, 1.4), "laws": ["coulomb"], "starts": 1},
        ),
        "compare_limit_cycle": (
            bk.design.compare_limit_cycle,
            {"pid": w.pid, "joint": joint, "mass_kg": 1.0, **trace},
        ),
        "compare_methods": (
            bk.compare_methods,
            {"population": w.population, "methods": [w.method], "runs": 2, "laws": "lugre"},
        ),
        "derive_motion": (bk.derive_motion, {"log": w.log}),
        "describing_function": (
            bk.design.describing_function,
            {"force": np.sign, "amplitude": 2.0},
        ),
        "draw_columns": (bk.draw_columns, vary),
        "draw_parts": (bk.draw_parts, {"population": w.population, "runs": 2, "seed": 0}),
        "export_c": (bk.export_c, {"scenario": w.scenario, "out": w.folder / "c"}),
        "export_fmu": (bk.export_fmu, {"scenario": w.scenario, "out": w.folder / "rig.fmu"}),
        "find_breakaway_events": (bk.find_breakaway_events, {"log": w.starts[0]}),
        "advise": (
            bk.advise,
            {"parts": w.population, "rig": "fast_force", "parts_max": 16, "budget_s": 1e-3},
        ),
        "check_accuracy": (
            bk.check_accuracy,
            {"scenario": w.scenario, "run_index": 0, "progress": None},
        ),
        "friction_field": (
            bk.friction_field,
            {
                "scenario": w.scenario.with_(
                    disturbance=bk.FieldDisturbance(correlation_length_m=1e-3)
                ),
                "position_m": t_s,
            },
        ),
        "fit_population": (bk.fit_population, {"logs": w.starts}),
        "grid_columns": (bk.grid_columns, {"levels": {"part.mass_kg": [1.0, 2.0]}}),
        "identifiability": (bk.identifiability, {"log": w.log, "law": "coulomb"}),
        "identify": (bk.identify, {"log": w.log, "law": "coulomb", "starts": 1}),
        "identify_inertia_friction": (bk.identify_inertia_friction, {"log": w.log}),
        "impose_motion": (
            bk.impose_motion,
            {"joint": imposed, "velocity_m_per_s": t_s, "period_s": 1e-3},
        ),
        "joint_from_pull": (bk.joint_from_pull, {"log": w.starts[0]}),
        "lay_over": (
            bk.lay_over,
            {"scenario": w.scenario, "joint": w.folder / "joint.toml"},
        ),
        "limit_cycles": (
            bk.design.limit_cycles,
            {"pid": w.pid, "joint": joint, "mass_kg": 1.0, "speed_m_per_s": 0.06},
        ),
        "load_limits": (bk.load_limits, {"path": w.folder / "limits.toml"}),
        "load_method": (bk.load_method, {"source": "steady_feed"}),
        "load_population": (bk.load_population, {"source": "seized_parts"}),
        "load_rig": (bk.load_rig, {"source": "screw_jack"}),
        "load_scenario": (bk.load_scenario, {"source": "paper_as_computed"}),
        "load_stack": (bk.load_stack, {"source": "pi_p888_91_pd200"}),
        "load_study": (bk.load_study, {"path": "no.toml"}),
        "load_tuning": (bk.load_tuning, {"path": "no.toml"}),
        "parts_of_pulls": (bk.parts_of_pulls, {"found": w.parts}),
        "margins": (bk.design.margins, {"loop": loop}),
        "measured_cycles": (
            bk.design.measured_cycles,
            {"t_s": t_s, "velocity_m_per_s": np.sin(900 * t_s), "mean_m_per_s": 0.0 * t_s},
        ),
        "noise_floor": (bk.noise_floor, {"log": w.log, "channel": "force_n"}),
        "open_loop": (
            bk.design.open_loop,
            {"pid": w.pid, "plant": bk.design.sliding_plant(joint, 1.0)},
        ),
        "open_study": (bk.open_study, {"folder": w.folder / "study"}),
        "open_tuning": (bk.open_tuning, {"folder": w.folder / "tuning"}),
        "pole_placement": (bk.design.pole_placement, {"joint": joint, "mass_kg": 1.0, **poles}),
        "preset_names": (bk.preset_names, {}),
        "list_channels": (bk.list_channels, {"path": w.folder / "log.csv"}),
        "read_log": (bk.read_log, {"path": w.folder / "log.csv"}),
        "resolve": (bk.resolve, {"scenario": w.scenario}),
        "rig_from_blank": (
            bk.rig_from_blank,
            {"logs": [bk.Log(t_s=t_s, position_m=1e-6 * t_s, force_n=t_s)]},
        ),
        "run_study": (bk.run_study, {"study": w.study, "out": w.folder / "again"}),
        "run_trial": (
            bk.run_trial,
            {"population": w.population, "method": w.method, "runs": 2, "seed": 0},
        ),
        "sampled_loops": (
            bk.design.sampled_loops,
            {"pid": w.pid, "joint": joint, "mass_kg": 1.0},
        ),
        "sampled_pid": (
            bk.design.sampled_pid,
            {
                "gains": w.pid.gains,
                "settings": w.scenario.controller,
                "timing": w.scenario.timing,
            },
        ),
        "save_population": (
            bk.save_population,
            {"population": w.population, "path": w.folder / "parts.toml"},
        ),
        "save_scenario": (
            bk.save_scenario,
            {"scenario": w.scenario, "path": w.folder / "scenario.toml"},
        ),
        "simulate": (bk.simulate, {"scenario": w.scenario}),
        "simulate_many": (bk.simulate_many, {"scenario": w.scenario, "runs": 2}),
        "sliding_plant": (bk.design.sliding_plant, {"joint": joint, "mass_kg": 1.0}),
        "stability": (
            bk.design.stability,
            {"gains": w.pid.gains, "joint": joint, "mass_kg": 1.0},
        ),
        "steepest_fall_velocity": (bk.design.steepest_fall_velocity, {"joint": joint}),
        "stribeck_slope": (
            bk.design.stribeck_slope,
            {"joint": joint, "velocity_m_per_s": 0.1},
        ),
        "stuck_plant": (bk.design.stuck_plant, {"joint": joint, "mass_kg": 1.0}),
        "tune": (bk.tune, {"tuning": w.tuning, "out": w.folder / "tuned"}),
        "write_advice": (bk.write_advice, {"advice": w.advised, "folder": w.folder / "advice"}),
    }


CONSTRUCTORS = {
    name: getattr(home, name)
    for home, name in HOMES
    if name in ("Channel", "Log", "PidGains", "SampledPid")
}
TAKERS = {
    name: function
    for name, function in {**FUNCTIONS, **CONSTRUCTORS}.items()
    if parameters_of(function)
}


@pytest.mark.slow
def test_every_function_has_a_valid_call(world):
    assert calls(world).keys() == TAKERS.keys()


def test_everything_is_shown_in_a_line(world):
    results = (
        *("log", "found", "parts", "run", "batch", "trial", "studied", "tuned", "comparison"),
        *("prediction", "report", "law", "posterior", "advised"),
    )
    found = world.found
    shown = vars(world) | {
        "prediction": found.fit,
        "report": bk.find_breakaway_events(world.starts[0]),
        "law": bk.compare_laws(world.log, held_out=(1.0, 1.4), laws=["coulomb"], starts=1)[0],
        "posterior": bk.Posterior({"coulomb_n": np.ones(10**5)}, 1.0, 0.5, 8, 100, 1.0),
    }
    for name in results:
        line = repr(shown[name])
        assert re.fullmatch(r"<.{10,200}>", line), line
        assert shown[name]._repr_html_().startswith("<code>&lt;"), name
    assert len(repr(world.joint)) < 5000


def outcome_of(function, arguments):
    """What is wrong with how a call ends: nothing, if it works or is refused in one line."""
    signature = inspect.signature(function)
    first = [
        arguments[name]
        for name, parameter in signature.parameters.items()
        if parameter.kind is parameter.POSITIONAL_ONLY and name in arguments
    ]
    named = {name: value for name, value in arguments.items() if name not in ("changes",)}
    try:
        function(*first, **(named if first else arguments))
    except bk.BreakawayError as error:
        lines = str(error).splitlines()
        return "refused" if len(lines) == 1 and lines[0] else f"refused in {len(lines)} lines"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "accepted"


def without_variadic(function):
    return [name for name, stars in parameters_of(function).items() if not stars]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:invalid value encountered")  # of emcee, by so few samples
@pytest.mark.parametrize("name", TAKERS)
def test_a_wrong_kind_is_refused_in_one_line(name, world, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("breakaway.measure.identification.uncertainty.BURNED", 50)
    function, valid = calls(world)[name]
    found = []
    for parameter in dict.fromkeys([*without_variadic(function), *valid]):
        for value in WRONG:
            outcome = outcome_of(function, {**valid, parameter: value})
            if outcome == "accepted" and fits(name, parameter, value):
                continue
            if outcome != "refused":
                found.append(f"{parameter}={value!r}: {outcome}")
    assert not found, "\n".join(found)


def fits(name, parameter, value):
    """Whether a value is of a kind that a parameter takes."""
    given = inspect.signature(TAKERS[name]).parameters.get(parameter)
    if value is None and given is not None and given.default is None:
        return True
    taken = ACCEPTED.get(f"{name}.{parameter}", ACCEPTED.get(parameter, ()))
    return any(type(value) is type(one) and value == one for one in taken)


NUMBERS = (
    *("amplitude", "bias", "budget_s", "count", "damping_ratio", "decimation", "delay_samples"),
    *("derivative_filter_s", "end_s", "factor", "force_limit_n", "gap_s", "harmonics", "kd", "ki"),
    *("kp", "lowpass_hz", "mass_kg", "min_rest_s", "min_slip_m", "offset_n", "origin_m"),
    *("period_s", "pole_per_s", "rest_speed_m_per_s", "rows", "run_index", "runs", "samples"),
    *("seed", "settling_time_s", "sliding_window_s", "speed_m_per_s", "start_m", "starts"),
    *(
        "engagement_length_m",
        "steps_per_row",
        "threads",
        "total",
        "trace_every",
        "evaluations",
        "point",
        "position_m",
        "velocity_m_per_s",
    ),
)
TEXTS = (
    "command",
    "folder",
    "note",
    "out",
    "path",
    "sha256",
    "Channel.name",
    "JointFile.origin.field",
    "parts_of_pulls.name",
    "Channel.from_name",
    "Channel.unit",
)
LISTS = ("baselines", "columns", "free", "joints", "made_of", "repeats", "spans")
MAPPINGS = ("changes", "channels", "fixed", "guesses", "levels", "mapping", "numbers", "vary")

ACCEPTED = {
    **dict.fromkeys(NUMBERS, (5,)),
    **dict.fromkeys(TEXTS, ("x",)),
    **dict.fromkeys(LISTS, ([],)),
    **dict.fromkeys(MAPPINGS, ({},)),
    "history": ([], {}),
    "noticed": ([], {}),
    "ignored_columns": ([], {}),
    "list_channels.memory_bytes": (5,),
    "impose_motion.velocity_m_per_s": ([],),
    "measured_cycles.velocity_m_per_s": (),
    "compare_limit_cycle.velocity_m_per_s": (),
}
"""Parameter, maybe of one function -> which of the wrong values it takes."""
