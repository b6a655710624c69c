"""Friction along the way: what was asked is what runs meet."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline

import breakaway as bk

QUINTIC = BSpline.basis_element(np.arange(-3.0, 4.0), extrapolate=False)
WIDTHS_PER_LENGTH = 1.034902840090455
LENGTH_M = 1e-3
VAR = {"bounded": 0.5, "gaussian": 0.15, "log_normal": 0.4}
"""Size of the fields of each law."""


def correlation(lag_m):
    """Of a field of the length LENGTH_M: the autocorrelation of quadratic B-splines."""
    return np.nan_to_num(QUINTIC(WIDTHS_PER_LENGTH * lag_m / LENGTH_M)) / 0.55


def scenario(law="bounded", **changes):
    field = bk.FieldDisturbance(law=law, var=VAR[law], correlation_length_m=LENGTH_M)
    return bk.load_scenario("paper_as_computed").with_({"seed": 5, **changes}, disturbance=field)


@pytest.fixture(scope="module")
def fields():
    """40 runs of 0.1 m at 50 um: 4000 correlation lengths of each law."""
    x = np.arange(0.0, 0.1, 5e-5)
    return {
        law: np.array([bk.friction_field(scenario(law), x, run_index=i).factor for i in range(400)])
        for law in VAR
    }


def test_the_correlation_length_is_where_it_falls_to_1_over_e():
    assert correlation(LENGTH_M) == pytest.approx(np.exp(-1.0), rel=1e-12)


def expected(law, lag_m):
    """Covariance of 1 + s over its variance; that of a log-normal field by the moments of exp."""
    rho = correlation(lag_m)
    if law == "log_normal":
        square = VAR[law] ** 2
        return np.expm1(square * rho) / np.expm1(square)
    return rho


@pytest.mark.parametrize("law", VAR)
def test_correlation_and_size_are_what_was_asked(fields, law):
    """Within 2 %: of the variance at every lag, and of the standard deviation."""
    factor = fields[law]
    size = {
        "bounded": VAR[law] * np.sqrt(0.55 / 3.0),
        "gaussian": VAR[law],
        "log_normal": np.sqrt(np.expm1(VAR[law] ** 2)),
    }[law]
    assert factor.mean() == pytest.approx(1.0, abs=0.02 * size)
    assert factor.std() == pytest.approx(size, rel=0.02)
    s = factor - 1.0
    for lag in range(0, 80, 4):
        found = (s[:, : s.shape[1] - lag] * s[:, lag:]).mean() / size**2
        assert found == pytest.approx(expected(law, lag * 5e-5), abs=0.02), lag


@pytest.mark.parametrize("law", ["bounded", "gaussian"])
def test_the_spectrum_is_what_was_asked(fields, law):
    """Power in six bands, against sinc^6 over the same window: within 2 % of the whole power."""
    s = fields[law] - 1.0
    count = s.shape[1]
    window = np.hanning(count)
    power = (np.abs(np.fft.rfft(s * window, axis=1)) ** 2).mean(axis=0)
    frequency = np.fft.rfftfreq(count, 5e-5)
    width = LENGTH_M / WIDTHS_PER_LENGTH
    asked = np.sinc(frequency * width) ** 6
    asked *= power.sum() / asked.sum()
    edges = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0]) / width
    for low, high in pairwise(edges):
        band = (low <= frequency) & (frequency < high)
        assert power[band].sum() == pytest.approx(asked[band].sum(), abs=0.02 * power.sum())


def test_distributions(fields):
    """Normal where that was asked, by its fourth moment and its tails; bounded where it is."""
    z = (fields["gaussian"] - 1.0) / VAR["gaussian"]
    assert (z**4).mean() == pytest.approx(3.0, abs=0.1)
    assert (np.abs(z) > 2.0).mean() == pytest.approx(0.0455, abs=0.003)
    assert np.abs(fields["bounded"] - 1.0).max() <= VAR["bounded"]
    logarithm = np.log(fields["log_normal"])
    assert logarithm.std() == pytest.approx(VAR["log_normal"], rel=0.02)
    assert logarithm.mean() == pytest.approx(-0.5 * VAR["log_normal"] ** 2, abs=0.02 * 0.4)


def test_runs_and_seeds_have_fields_of_their_own():
    x = np.linspace(0.0, 0.1, 2000)
    one = bk.friction_field(scenario(), x)
    assert one == bk.friction_field(scenario(), x)
    for other in (
        bk.friction_field(scenario(), x, run_index=1),
        bk.friction_field(scenario(seed=6), x),
    ):
        assert abs(np.corrcoef(one.factor, other.factor)[0, 1]) < 0.3


def test_the_slope_is_that_of_the_factor():
    x = np.linspace(0.0, 0.01, 20_001)
    field = bk.friction_field(scenario("log_normal"), x)
    by_difference = np.gradient(field.factor, x)
    assert np.abs(field.slope_per_m - by_difference)[1:-1].max() < 2.0
    assert np.abs(field.slope_per_m).max() > 200.0


def pushed(force_n, held_s, joint, disturbance):
    """A constant push on a part in a joint of 2 mm, after a ramp of 1 ms."""
    return bk.load_scenario("paper_as_computed").with_(
        {
            "timing": {"duration_s": held_s, "control_period_s": 1e-4},
            "trace.every_samples": 0,
            "limits": {"diverged_error_m": 1.0, "diverged_force_n": 1e6, "after_release_s": 0.0},
        },
        joint=joint,
        disturbance=disturbance,
        actuator=bk.PushOnlyActuator(force_max_n=force_n),
        controller=bk.ForceRamp(rate_n_per_s=1e6, travel_m=0.002),
        reference=bk.StepReference(distance_m=0.002),
    )


RIGID = bk.CoulombStiction(
    stiction_n=450.0,
    coulomb_n=360.0,
    stribeck_velocity_m_per_s=0.09,
    engagement_length_m=0.002,
    residual_n=440.0,
)


def smallest_freeing_push_n(held_s, disturbance):
    low, high = 100.0, 900.0
    while high - low > 0.02:
        middle = 0.5 * (low + high)
        run = bk.simulate(pushed(middle, held_s, RIGID, disturbance))
        low, high = (low, middle) if run.outcome == "released" else (middle, high)
    return high


def test_waiting_changes_nothing():
    """The smallest push that frees a part does not depend on how long it is held: to 0.1 %.

    With the paper's factor on the friction level it does: waiting finds the lowest of many draws.
    """
    along = bk.FieldDisturbance(var=0.3, correlation_length_m=2e-4)
    soon, late = (smallest_freeing_push_n(held_s, along) for held_s in (0.25, 4.0))
    assert soon == pytest.approx(late, rel=1e-3)
    assert soon > 450.0  # somewhere along the way friction is higher than at the seat
    redrawn = bk.UniformDisturbance(var=0.3, hold_s=1e-3, acts_on="friction_level")
    soon, late = (smallest_freeing_push_n(held_s, redrawn) for held_s in (0.25, 4.0))
    assert late < 0.95 * soon


def test_a_part_that_goes_back_meets_the_same_friction():
    """Two runs pass the same place at other times, one after a detour: the joint force there is the
    same but for what the bristles take to settle."""
    x = np.array([0.05])
    there = bk.friction_field(scenario(), np.concatenate([x, x + 1e-3, x]))
    assert there.factor[0] == there.factor[2]
    assert there.factor[0] != there.factor[1]


@pytest.mark.parametrize("law", VAR)
def test_a_batch_has_the_bits_of_its_runs(law):
    batch = bk.simulate_many(
        scenario(law, **{"timing.duration_s": 0.05}),
        runs=range(3, 40),
        vary={"disturbance.var": bk.Uniform(low=0.0, high=0.2)},
        metrics=["iae_m_s", "peak_force_n", "peak_over_breakaway", "final_position_m"],
    )
    for i in (0, 17, 36):
        run = bk.simulate(batch.scenario_of(i), run_index=int(batch.run_index[i]))
        for name in batch.metrics:
            assert batch[name][i] == getattr(run.metrics, name)


def test_breakaway_is_judged_by_the_part_s_own():
    """What friction can hold it with, at the tightest place of its guide."""
    run = bk.simulate(scenario())
    x = np.linspace(0.0, 0.1, 200_001)
    seated_n, left_n = run.scenario.joint.stiction_n, run.scenario.joint.residual_n
    along = seated_n + (left_n - seated_n) * x / 0.1
    own_n = (along * bk.friction_field(scenario(), x).factor).max()
    assert own_n > 1.02 * seated_n
    found = run.metrics.peak_force_n / run.metrics.peak_over_breakaway
    assert found == pytest.approx(own_n, rel=4e-3)
    assert found <= own_n


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"law": "gaussian", "var": 0.3}, "var: 0.3 is not < 0.2, or a level could fall to zero"),
        ({"correlation_length_m": 1e-7}, "correlation_length_m: 1e-07 is not >= 1e-06"),
        ({"var": 1.0}, "var: 1.0 is not < 1"),
        ({"hold_s": 1e-3}, "hold_s: is not a known key"),
    ],
)
def test_what_is_no_field_is_refused(changes, message):
    values = {"kind": "field", "var": 0.1, "correlation_length_m": 1e-3} | changes
    with pytest.raises(bk.ScenarioError, match=f"disturbance.*{message}"):
        bk.load_scenario("paper_as_computed").with_({"disturbance": values})


def test_a_field_finer_than_its_hash_is_refused():
    changes = {"joint.engagement_length_m": 1.0, "reference.distance_m": 1.0}
    values = {"kind": "field", "var": 0.1, "correlation_length_m": 1e-6}
    with pytest.raises(bk.ScenarioError, match=r"correlation_length_m: 1e-06 is not >= joint"):
        bk.load_scenario("paper_as_computed").with_({**changes, "disturbance": values})


def test_only_a_field_has_a_course():
    with pytest.raises(
        bk.ScenarioError, match=r"disturbance\.kind: 'paper_random_factor' is no field"
    ):
        bk.friction_field(bk.load_scenario("paper_as_computed"), [0.0])
