"""What the tests of the reproduction share: its simulations, done once."""

from __future__ import annotations

import pytest

from breakaway.ask.reproduction.runs import simulate_all


@pytest.fixture(scope="session")
def simulated():
    """Everything that the reproduction simulates, and what it told on the way."""
    told: list[str] = []
    return simulate_all(told.append), told
