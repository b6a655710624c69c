"""Random draws: of what differs from part to part, and of the disturbance."""

import itertools

import numpy as np
import pytest
from scipy import special, stats
from scipy.stats import qmc

import breakaway as bk

UNIT = bk.Uniform(low=0.0, high=1.0)
FIVE = dict.fromkeys("abcde", UNIT)


def columns_of(drawn):
    return np.column_stack(list(drawn.values()))


# What differs from part to part


def test_numbers_are_independent():
    """Of each other, of the run before, of another seed, and of the order of size."""
    runs = 20_000
    table = columns_of(bk.draw_columns(FIVE, range(runs + 1), seed=3))
    other = columns_of(bk.draw_columns(FIVE, range(runs), seed=4))
    everything = np.column_stack([table[:-1], table[1:], other])
    found = np.corrcoef(everything, rowvar=False)[np.triu_indices(15, 1)]
    assert np.abs(found).max() < 5.0 / np.sqrt(runs)
    assert np.abs(table.mean(axis=0) - 0.5).max() < 5.0 / np.sqrt(12.0 * runs)


def test_values_are_those_of_the_seed_the_run_and_the_place():
    whole = bk.draw_columns(FIVE, range(100), seed=2**63 - 1)
    piece = bk.draw_columns(FIVE, range(40, 60), seed=2**63 - 1)
    fewer = bk.draw_columns({"a": UNIT, "b": UNIT}, range(100), seed=2**63 - 1)
    for name in "abcde":
        np.testing.assert_array_equal(piece[name], whole[name][40:60])
    for name in "ab":
        np.testing.assert_array_equal(fewer[name], whole[name])
    renamed = bk.draw_columns({"z": UNIT, "a": UNIT}, range(100), seed=2**63 - 1)
    np.testing.assert_array_equal(renamed["z"], whole["a"])
    assert not (whole["a"] == whole["b"]).any()


def test_threads_do_not_matter(quick):
    batches = [
        bk.simulate_many(quick, 50, vary={"joint.stiction_n": UNIT}, threads=threads)
        for threads in (1, 2, 5)
    ]
    for batch in batches:
        for name in ("joint.stiction_n", "iae_m_s"):
            np.testing.assert_array_equal(batch[name], batches[0][name])


def test_batches_draw_from_the_seed_of_the_scenario(quick):
    vary = {"joint.stiction_n": bk.Normal(mean=450.0, std=10.0)}
    batch = bk.simulate_many(quick, range(3, 8), vary=vary)
    drawn = bk.draw_columns(vary, range(3, 8), seed=quick.seed)
    np.testing.assert_array_equal(batch["joint.stiction_n"], drawn["joint.stiction_n"])


@pytest.mark.parametrize("size", [64, 256])
def test_sobol_points_fill_better_than_random_ones(size):
    """Better than every one of many random tables."""
    vary = dict.fromkeys("abcd", UNIT)
    even = columns_of(bk.draw_columns(vary, range(size), seed=1, design="sobol"))
    by_chance = [
        qmc.discrepancy(columns_of(bk.draw_columns(vary, range(size), seed=seed)))
        for seed in range(20)
    ]
    assert qmc.discrepancy(even) < min(by_chance)


def test_sobol_points_need_no_power_of_two():
    drawn = bk.draw_columns(FIVE, range(100), seed=1, design="sobol")
    longer = bk.draw_columns(FIVE, range(128), seed=1, design="sobol")
    for name in FIVE:
        np.testing.assert_array_equal(drawn[name], longer[name][:100])


@pytest.mark.parametrize("size", [1, 10, 257])
def test_a_latin_hypercube_has_one_point_in_each_stratum(size):
    drawn = bk.draw_columns(FIVE, range(size), seed=8, design="latin_hypercube")
    for column in drawn.values():
        assert sorted(np.floor(column * size)) == list(range(size))
    places = {tuple(np.argsort(column)) for column in drawn.values()}
    assert size == 1 or len(places) == 5


@pytest.mark.parametrize("design", ["sobol", "latin_hypercube"])
def test_pieces_of_a_design(design):
    whole = bk.draw_columns(FIVE, range(40), seed=8, design=design)
    piece = bk.draw_columns(FIVE, range(10, 20), seed=8, design=design, total=40)
    again = bk.draw_columns(FIVE, range(40), seed=9, design=design)
    for name in FIVE:
        np.testing.assert_array_equal(piece[name], whole[name][10:20])
        assert ((whole[name] > 0.0) & (whole[name] < 1.0)).all()
        assert not (whole[name] == again[name]).all()


@pytest.mark.parametrize("design", ["sobol", "latin_hypercube", "random"])
def test_designs_reach_the_batch(quick, design):
    vary = {"joint.stiction_n": bk.Uniform(low=400.0, high=500.0), "part.mass_kg": UNIT}
    vary["part.mass_kg"] = bk.Normal(mean=1.0, std=0.05)
    batch = bk.simulate_many(quick, 16, vary=vary, design=design)
    drawn = bk.draw_columns(vary, range(16), seed=quick.seed, design=design)
    for name in vary:
        np.testing.assert_array_equal(batch[name], drawn[name])
    strata = np.unique(np.floor((batch["joint.stiction_n"] - 400.0) / 100.0 * 16))
    assert (len(strata) == 16) is (design != "random")


@pytest.mark.parametrize("design", ["random", "sobol", "latin_hypercube"])
def test_shared_samples_keep_their_rows(design):
    stiction, mass = [400.0, 450.0, 500.0, 550.0], [1.0, 2.0, 3.0, 4.0]
    vary = {
        "a": bk.Samples(values=stiction, rows="shared"),
        "b": UNIT,
        "c": bk.Samples(values=mass, rows="shared"),
        "d": bk.Samples(values=mass),
    }
    drawn = bk.draw_columns(vary, range(2000), seed=1, design=design)
    row = np.searchsorted(stiction, drawn["a"])
    np.testing.assert_array_equal(drawn["c"], np.asarray(mass)[row])
    assert stats.chisquare(np.bincount(row, minlength=4)).pvalue > 1e-6
    assert abs(np.corrcoef(drawn["a"], drawn["d"])[0, 1]) < 5.0 / np.sqrt(2000)
    assert abs(np.corrcoef(drawn["a"], drawn["b"])[0, 1]) < 5.0 / np.sqrt(2000)


def test_nothing_to_draw():
    for design in ("random", "sobol", "latin_hypercube"):
        assert bk.draw_columns({}, range(3), seed=1, design=design) == {}
    assert bk.draw_columns(FIVE, range(0), seed=1)["a"].shape == (0,)


@pytest.mark.parametrize(
    ("runs", "options", "message"),
    [
        (
            range(3),
            {"design": "halton"},
            r"^design: 'halton' is not one of random, sobol, l",
        ),
        (range(0, 6, 2), {}, r"^runs: range\(0, 6, 2\) is not a whole number of at least 0, nor a"),
        (range(-1, 3), {}, r"^runs: range\(-1, 3\) is not a whole number"),
        (range(3), {"total": 2}, r"^total: 2 is not a whole number of at least 3"),
    ],
)
def test_draws_that_are_refused(runs, options, message):
    with pytest.raises(bk.StudyError, match=message):
        bk.draw_columns(FIVE, runs, seed=1, **options)


def test_grids():
    levels = {"a": [1.0, 2.0, 3.0], "b": [10.0], "c": np.array([0.1, 0.2])}
    columns = bk.grid_columns(levels)
    rows = list(zip(*(column.tolist() for column in columns.values()), strict=True))
    assert list(columns) == ["a", "b", "c"]
    assert rows == list(itertools.product(*levels.values()))
    assert all(column.dtype == np.float64 for column in columns.values())
    assert bk.grid_columns({}) == {}
    assert bk.grid_columns({"a": []})["a"].shape == (0,)


def test_a_grid_is_a_batch(quick):
    columns = bk.grid_columns({"disturbance.var": [0.0, 0.2], "part.mass_kg": [0.9, 1.0, 1.1]})
    batch = bk.simulate_many(quick, 6, vary=columns)
    assert batch["disturbance.var"].tolist() == [0.0, 0.0, 0.0, 0.2, 0.2, 0.2]
    assert len(set(batch["iae_m_s"])) == 6


# The disturbance

COULOMB_N = 100.0
LENGTH_M = 1000.0
VAR = 0.2
PERIOD_S = 1e-5
LAWS = {
    "uniform": bk.UniformDisturbance(var=VAR, hold_s=PERIOD_S),
    "gaussian": bk.GaussianDisturbance(var=VAR, hold_s=PERIOD_S),
    "band_limited": bk.BandLimitedDisturbance(var=VAR, hold_s=PERIOD_S, bandwidth_hz=3000.0),
}


def sliding(disturbance, samples, seed=0):
    """Give a part that is pushed steadily, five times as hard as friction holds it."""
    return bk.Scenario(
        seed=seed,
        joint=bk.TwoRegion(
            stiction_n=110.0,
            coulomb_n=COULOMB_N,
            stiffness_n_per_m=3.6e7,
            damping_n_s_per_m=9000.0,
            engagement_length_m=LENGTH_M,
        ),
        part=bk.Part(mass_kg=1.0),
        reference=bk.StepReference(distance_m=400.0),
        disturbance=disturbance,
        controller=bk.Pid(gains=bk.Gains(kp_n_per_m=1.25, ki_n_per_m_s=0.0, kd_n_s_per_m=0.0)),
        timing=bk.Timing(
            duration_s=samples * PERIOD_S, control_period_s=PERIOD_S, steps_per_period=1
        ),
        trace=bk.Trace(every_samples=1),
    )


def draws_of(scenario, run_index=0):
    """Recover w at every sample at which the part slides, and which samples these are.

    Under the two-region law the joint force is then F_c(x) (1 + var w), exactly so.
    """
    run = bk.simulate(scenario, run_index=run_index)
    x, force = run.trace["position_m"][:-1], run.trace["joint_force_n"][:-1]
    weight_n = 9.81 if scenario.joint.residual_n is None else scenario.joint.residual_n
    coulomb_n = COULOMB_N + (weight_n - COULOMB_N) * x / LENGTH_M
    w = (force / coulomb_n - 1.0) / scenario.disturbance.var
    start = np.flatnonzero(x > 1e-4)[0]
    assert (run.trace["velocity_m_per_s"][start:] > 0.0).all()
    return w[start:], np.arange(len(x))[start:]


def philox4x32(counter, key):
    """Philox4x32-10 from its paper: Salmon, Moraes, Dror and Shaw, SC 2011."""
    c, k, mask = list(counter), list(key), 0xFFFFFFFF
    for _ in range(10):
        low, high = c[0] * 0xD2511F53, c[2] * 0xCD9E8D57
        c = [(high >> 32) ^ c[1] ^ k[0], high & mask, (low >> 32) ^ c[3] ^ k[1], low & mask]
        k = [(k[0] + 0x9E3779B9) & mask, (k[1] + 0xBB67AE85) & mask]
    return c


def words(seed, run, count, stream=0):
    """Give 53 random bits for each draw of a stream."""
    low, high = 0xFFFFFFFF, 32
    rows = [
        philox4x32([i, stream, run & low, run >> high], [seed & low, seed >> high])
        for i in range(count)
    ]
    return [((row[1] << 32) | row[0]) >> 11 for row in rows]


def expected_draws(law, seed, run, count, a=None):
    """Give w by its definition, with scipy's normal distribution."""
    bits = words(seed, run, count)
    if law == "uniform":
        return np.array([b * 2.0**-52 - 1.0 for b in bits])
    u = np.array([(b >> 1) * 2.0**-52 + 2.0**-53 for b in bits])
    if law == "gaussian":
        beyond = stats.norm.cdf(-4.0)
        return special.ndtri(beyond + u * (1.0 - 2.0 * beyond))
    fresh = special.ndtri(u)
    w = [fresh[0]]
    for xi in fresh[1:]:
        w.append(a * w[-1] + np.sqrt(1.0 - a * a) * xi)
    return np.clip(w, -4.0, 4.0)


@pytest.mark.parametrize("acts_on", ["joint_force", "friction_level"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("hold_s", "run"), [(1e-5, 0), (1e-4, 3), (3.7e-5, 2**63 + 1)])
def test_draws_are_the_law_of_philox(law, acts_on, hold_s, run):
    disturbance = LAWS[law].model_copy(update={"hold_s": hold_s, "acts_on": acts_on})
    w, samples = draws_of(sliding(disturbance, 400, seed=77), run)
    a = np.exp(-2.0 * np.pi * 3000.0 * hold_s)
    expected = expected_draws(law, 77, run, 401, a)
    first_samples = np.ceil(np.arange(402) * hold_s / PERIOD_S - 1e-6)
    draw = np.searchsorted(first_samples, samples, side="right") - 1
    assert len(w) > 300
    np.testing.assert_allclose(w, expected[draw], rtol=0.0, atol=1e-9)


def test_numbers_of_parts_are_the_law_of_philox():
    drawn = bk.draw_columns(FIVE, range(3), seed=2**40 + 5)
    for number, column in enumerate(drawn.values()):
        for run in range(3):
            (bits,) = words(2**40 + 5, run, 1, stream=1 + number)
            assert column[run] == (bits >> 1) * 2.0**-52 + 2.0**-53


@pytest.fixture(scope="module")
def many_draws():
    """Give draws of each law, in rows by run."""
    drawn = {}
    for law, disturbance in LAWS.items():
        scenario = sliding(disturbance, 5200)
        drawn[law] = np.array([draws_of(scenario, i)[0][-5000:] for i in range(8)])
    return drawn


@pytest.mark.parametrize(
    ("law", "scipy_law"),
    [("uniform", stats.uniform(-1.0, 2.0)), ("gaussian", stats.truncnorm(-4.0, 4.0))],
)
def test_independent_draws_have_their_distribution(many_draws, law, scipy_law):
    w = many_draws[law].ravel()
    assert stats.kstest(w, scipy_law.cdf).pvalue > 1e-6
    mean, variance, kurtosis = scipy_law.stats("mvk")
    fourth = (kurtosis + 3.0) * variance**2
    assert abs(w.mean() - mean) < 5.0 * np.sqrt(variance / w.size)
    assert abs((w**2).mean() - variance) < 5.0 * np.sqrt((fourth - variance**2) / w.size)
    assert np.abs(w).max() <= scipy_law.support()[1]
    for lag in (1, 2, 10):
        found = np.mean(many_draws[law][:, lag:] * many_draws[law][:, :-lag]) / variance
        assert abs(found) < 5.0 / np.sqrt(w.size)


def test_band_limited_draws_forget_as_the_low_pass_does(many_draws):
    """Autocorrelation exp(-2 pi f t), within five standard errors by Bartlett's formula."""
    w = many_draws["band_limited"]
    a = np.exp(-2.0 * np.pi * 3000.0 * PERIOD_S)
    error = np.sqrt((1.0 + a * a) / (1.0 - a * a) / w.size)
    assert abs((w**2).mean() - 1.0) < 5.0 * np.sqrt(2.0) * error
    assert abs(w.mean()) < 5.0 * np.sqrt((1.0 + a) / (1.0 - a) / w.size)
    for lag in (1, 2, 5, 10, 40):
        found = np.mean(w[:, lag:] * w[:, :-lag]) / np.mean(w * w)
        b = a ** (2 * lag)
        spread = ((1.0 - b) * (1.0 + a * a) / (1.0 - a * a) - 2.0 * lag * b) / w.size
        assert abs(found - a**lag) < 5.0 * np.sqrt(spread), lag
    assert stats.kstest(w[:, ::40].ravel(), stats.norm.cdf).pvalue > 1e-6  # 5e-4 of it is left


@pytest.mark.parametrize("law", LAWS)
def test_runs_are_independent(many_draws, law):
    rows = many_draws[law]
    found = np.corrcoef(rows)[np.triu_indices(len(rows), 1)]
    a = np.exp(-2.0 * np.pi * 3000.0 * PERIOD_S) if law == "band_limited" else 0.0
    longer = (1.0 + a * a) / (1.0 - a * a)
    assert np.abs(found).max() < 5.0 * np.sqrt(longer / rows.shape[1])


@pytest.mark.parametrize("law", ["gaussian", "band_limited"])
def test_the_first_draw_has_the_stationary_law(law):
    """Not that of a low-pass that starts from nothing; and it is no number of the part."""
    runs = 600
    disturbance = LAWS[law].model_copy(update={"hold_s": 1.0})
    if law == "band_limited":
        disturbance = disturbance.model_copy(update={"bandwidth_hz": 0.01})
    scenario = sliding(disturbance, 120)
    w = np.array([draws_of(scenario, i)[0][-1] for i in range(runs)])
    assert stats.kstest(w, stats.norm.cdf).pvalue > 1e-6
    part = columns_of(bk.draw_columns(FIVE, range(runs), seed=scenario.seed))
    found = np.corrcoef(np.column_stack([w, part]), rowvar=False)[0, 1:]
    assert np.abs(found).max() < 5.0 / np.sqrt(runs)


def test_a_wide_band_forgets_at_once():
    """Noise that is band-limited far above the redraws is the normal law without its bounds."""
    wide = bk.BandLimitedDisturbance(var=VAR, hold_s=PERIOD_S, bandwidth_hz=1e9)
    narrow = bk.BandLimitedDisturbance(var=VAR, hold_s=PERIOD_S, bandwidth_hz=1e-6)
    u = [(b >> 1) * 2.0**-52 + 2.0**-53 for b in words(0, 0, 400)]
    w, samples = draws_of(sliding(wide, 400))
    np.testing.assert_allclose(w, special.ndtri(np.array(u))[samples], rtol=0.0, atol=1e-9)
    held, _ = draws_of(sliding(narrow, 400))
    assert np.ptp(held) < 0.01
