"""Scenarios that are over at once, and what two equal runs have in common."""

import numpy as np
import pytest

import breakaway as bk


@pytest.fixture(scope="session")
def quick():
    """Give a disturbed extraction of 2 ms, of which nothing comes loose."""
    return bk.load_scenario("paper_as_computed").with_(
        {"timing.duration_s": 0.002}, disturbance=bk.UniformDisturbance(var=0.2), seed=11
    )


@pytest.fixture(scope="session")
def endless():
    """Give an extraction that takes longer than anybody waits."""
    return bk.load_scenario("paper_as_computed").with_(
        {"disturbance.var": 0.05, "timing.duration_s": 1000.0, "trace.every_samples": 0}
    )


@pytest.fixture(scope="session")
def bits():
    """Give the function that makes numbers comparable to the last bit, all NaN being alike."""

    def of(values):
        values = np.asarray(values, dtype=np.float64)
        return np.where(np.isnan(values), np.nan, values).view(np.uint64)

    return of
