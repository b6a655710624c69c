"""What a batch gives: columns, tables, and its runs again."""

import builtins
import importlib

import numpy as np
import pyarrow as pa
import pytest

import breakaway as bk
from breakaway import _core
from breakaway.run.batch import METRICS

UNITS = {
    "joint.stiction_n": "N",
    "joint.stiffness_n_per_m": "N/m",
    "joint.viscous_n_s_per_m": "N s/m",
    "joint.stribeck_velocity_m_per_s": "m/s",
    "joint.engagement_length_m": "m",
    "part.mass_kg": "kg",
    "disturbance.var": "1",
    "disturbance.bandwidth_hz": "Hz",
    "disturbance.hold_s": "s",
    "controller.gains.kp_n_per_m": "N/m",
    "controller.gains.ki_n_per_m_s": "N/(m s)",
    "controller.gains.kd_n_s_per_m": "N s/m",
    "simulated_s": "s",
    "iae_m_s": "m s",
    "ise_m2_s": "m^2 s",
    "itae_m_s2": "m s^2",
    "largest_error_m": "m",
    "peak_force_n": "N",
    "peak_over_breakaway": "1",
    "impulse_n_s": "N s",
    "work_j": "J",
    "impacts": "1",
    "largest_jump_m": "m",
    "time_to_release_s": "s",
    "release_velocity_m_per_s": "m/s",
    "outcome": "1",
    "run_index": "1",
}


@pytest.fixture(scope="module")
def batch():
    """Give runs of which some are released and some are not."""
    scenario = bk.load_scenario("paper_as_computed").with_(
        {
            "timing.duration_s": 0.02,
            "reference.duration_s": 0.01,
            "joint.engagement_length_m": 1e-3,
        },
        reference={"distance_m": 1.2e-3},
        disturbance=bk.BandLimitedDisturbance(var=0.05, bandwidth_hz=200.0),
        seed=4,
        name="some",
    )
    value = {
        "joint.stiction_n": 450.0,
        "joint.stiffness_n_per_m": 3.6e7,
        "joint.viscous_n_s_per_m": 1.0,
        "joint.stribeck_velocity_m_per_s": 0.09,
        "part.mass_kg": 1.0,
        "disturbance.var": 0.05,
        "disturbance.bandwidth_hz": 200.0,
        "disturbance.hold_s": 1e-4,
    }
    vary = {name: np.full(9, number) for name, number in value.items()}
    vary["joint.engagement_length_m"] = np.array([1e-3] * 4 + [2e-3] * 5)
    gains = bk.resolve(scenario).controller.gains
    for name in ("kp_n_per_m", "ki_n_per_m_s", "kd_n_s_per_m"):
        vary[f"controller.gains.{name}"] = np.full(9, getattr(gains, name))
    return bk.simulate_many(scenario, range(100, 109), vary=vary)


@pytest.fixture(scope="module")
def plain(batch):
    """Give a batch in which nothing differs but the draws."""
    return bk.simulate_many(batch.scenario, 5, metrics=["iae_m_s", "outcome", "iae_m_s"])


def test_columns(batch, plain):
    assert len(batch) == 9
    assert list(batch.columns) == [*batch.varied, *METRICS]
    assert batch.run_index.tolist() == list(range(100, 109))
    assert batch["outcome"].tolist() == ["released"] * 4 + ["not_released"] * 5
    assert (np.isnan(batch["time_to_release_s"]) == (batch["outcome"] != "released")).all()
    assert (np.isnan(batch["release_velocity_m_per_s"])[4:]).all()
    assert np.isfinite(batch["iae_m_s"]).all()
    assert list(plain.columns) == ["iae_m_s", "outcome"]
    assert plain.varied == {}
    for one in (batch, plain):
        for name, column in one.columns.items():
            assert column.shape == (len(one),), name
            assert one[name] is column or (one[name].tolist() == column.tolist()) or "time" in name


def test_columns_that_are_not_there(plain):
    with pytest.raises(
        KeyError, match="peak_force_n: is not a column; the columns are iae_m_s, out"
    ):
        plain["peak_force_n"]


def test_results_do_not_change(batch):
    for column in batch.metrics.values():
        with pytest.raises(ValueError, match="read-only"):
            column[0] = 1.0
    with pytest.raises(TypeError):
        batch.metrics["iae_m_s"] = np.zeros(9)
    with pytest.raises(TypeError):
        batch.varied["joint.stiction_n"] = np.zeros(9)
    with pytest.raises(AttributeError):
        batch.scenario = None


def test_what_is_given_is_copied(quick):
    values = np.array([450.0, 460.0])
    batch = bk.simulate_many(quick, 2, vary={"joint.stiction_n": values})
    values[:] = 1.0
    assert batch["joint.stiction_n"].tolist() == [450.0, 460.0]


def test_arrow(batch):
    table = batch.to_arrow()
    assert table.column_names == ["run_index", *batch.columns]
    assert table.num_rows == 9
    assert table.schema.metadata == {b"scenario": b"some", b"seed": b"4"}
    for name, unit in UNITS.items():
        field = table.schema.field(name)
        assert field.metadata == {b"unit": unit.encode()}, name
        assert not field.nullable
    assert table["run_index"].to_pylist() == list(range(100, 109))
    outcome = table["outcome"].combine_chunks()
    assert pa.types.is_dictionary(outcome.type)
    assert outcome.dictionary.to_pylist() == _core.OUTCOMES
    assert outcome.to_pylist() == batch["outcome"].tolist()
    for name in (*batch.varied, *batch.metrics):
        assert table[name].null_count == 0
        np.testing.assert_array_equal(table[name].to_numpy(), batch[name], err_msg=name)


def test_pandas(batch):
    pytest.importorskip("pandas")
    frame = batch.to_pandas()
    assert frame.index.name == "run_index"
    assert frame.index.tolist() == list(range(100, 109))
    assert list(frame.columns) == list(batch.columns)
    assert frame["outcome"].tolist() == batch["outcome"].tolist()
    assert list(frame["outcome"].cat.categories) == _core.OUTCOMES
    np.testing.assert_array_equal(frame["time_to_release_s"], batch["time_to_release_s"])
    assert frame["time_to_release_s"].isna().sum() == 5


def test_pandas_that_is_not_installed(batch, monkeypatch):
    real = importlib.import_module

    def missing(name, *rest):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr("breakaway.base.extras.import_module", missing)
    with pytest.raises(bk.StudyError, match=r"pip install 'breakaway\[pandas\]'$"):
        batch.to_pandas()
    assert builtins.__import__ is not missing


@pytest.mark.slow
def test_xarray(batch):
    data = batch.to_xarray()
    assert data.sizes == {"run_index": 9}
    assert data["run_index"].values.tolist() == list(range(100, 109))
    assert list(data.data_vars) == list(batch.columns)
    assert data.attrs == {"scenario": "some", "seed": 4}
    for name, unit in UNITS.items():
        if name != "run_index":
            assert data[name].attrs["units"] == unit, name
    for name, column in batch.columns.items():
        np.testing.assert_array_equal(data[name].values, column)


def test_tables_of_little(plain):
    """Nothing that differs; no outcome; only an outcome."""
    assert plain.to_arrow().column_names == ["run_index", "iae_m_s", "outcome"]
    assert list(plain.to_xarray().data_vars) == ["iae_m_s", "outcome"]
    one = bk.simulate_many(plain.scenario, 1, metrics=["peak_force_n"])
    assert one.outcome_codes is None
    assert one.to_arrow().column_names == ["run_index", "peak_force_n"]
    other = bk.simulate_many(plain.scenario, 1, metrics=["outcome"])
    assert other.metrics == {}
    assert other.to_arrow().column_names == ["run_index", "outcome"]


def test_replay(batch):
    for i in (0, 8, -1, -9, np.int64(3)):
        run = batch.replay(i)
        assert run.run_index == 100 + i % 9
        assert run.scenario == bk.resolve(batch.scenario_of(i))
        assert run.metrics.iae_m_s == batch["iae_m_s"][i]
        assert run.outcome == batch["outcome"][i]
        assert run.trace["t_s"].size == 201
    assert batch.replay(2, trace_every=1).trace["t_s"].size == 2001
    assert batch.replay(2, trace_every=0).trace == {}
    with pytest.raises(bk.ScenarioError, match=r"^trace\.every_samples: -1 is not >= 0"):
        batch.replay(2, trace_every=-1)


@pytest.mark.parametrize("i", [9, -10, 10**6])
def test_rows_that_are_not_there(batch, i):
    for ask in (batch.replay, batch.scenario_of):
        with pytest.raises(bk.StudyError, match=f"^row {i}: the batch has 9 runs$"):
            ask(i)


def test_scenarios_of_runs(batch):
    scenario = batch.scenario_of(4)
    assert scenario.joint.engagement_length_m == 2e-3
    assert scenario.seed == 4
    assert scenario.controller.gains.kind == "given"
    assert bk.Scenario.parse(scenario.model_dump()) == scenario


def test_numbers_that_all_runs_share(batch):
    """The same number in every run is the number of the scenario."""
    alike = bk.simulate_many(
        batch.scenario, 3, vary={"disturbance.var": [0.05] * 3}, metrics=["iae_m_s"]
    )
    plain = bk.simulate_many(batch.scenario, 3, metrics=["iae_m_s"])
    assert alike["iae_m_s"].tolist() == plain["iae_m_s"].tolist()
