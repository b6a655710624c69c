"""Small parts that a feed frees in tenths of a second, and tunings of that feed."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import breakaway as bk

PARTS = {
    "stiction_n": {"distribution": "log_uniform", "low": 100.0, "high": 400.0},
    "stiction_ratio": {"distribution": "uniform", "low": 1.1, "high": 2.0},
    "presliding_m": {"distribution": "uniform", "low": 20e-6, "high": 30e-6},
    "bristle_damping_ratio": {"distribution": "uniform", "low": 0.5, "high": 1.0},
    "stribeck_velocity_m_per_s": {"distribution": "uniform", "low": 0.05, "high": 0.1},
    "mass_kg": {"distribution": "uniform", "low": 1.0, "high": 1.5},
    "engagement_length_m": {"distribution": "uniform", "low": 0.001, "high": 0.002},
    "var": {"distribution": "uniform", "low": 0.0, "high": 0.2},
    "hold_s": {"distribution": "uniform", "low": 1e-3, "high": 1e-2},
    "correlation_length_m": {"distribution": "uniform", "low": 1e-5, "high": 1e-3},
}
SPEED = "controller.speed_m_per_s"


@pytest.fixture(scope="session")
def parts() -> bk.PartPopulation:
    return bk.PartPopulation(name="small", parts=PARTS, duration_s=0.4, control_period_s=1e-4)


@pytest.fixture(scope="session")
def feed(parts: bk.PartPopulation) -> Callable[..., bk.Tuning]:
    """Give tunings of the speed of a feed: how long it takes is length over speed."""

    def make(**changes: Any) -> bk.Tuning:
        values: dict[str, Any] = {
            "population": parts,
            "method": "steady_feed",
            "objectives": ["median_time_to_release_s"],
            "tune": {SPEED: {"low": 0.01, "high": 0.04}},
            "training_runs": 12,
            "test_runs": {"first": 1000, "runs": 24},
            "evaluations": 15,
        }
        return bk.Tuning.parse(values | changes)

    return make


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave figures out, which take longer than the evaluations."""
    monkeypatch.setattr("breakaway.ask.tuning.writing._draw", lambda *_: None)


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock" and path.suffix not in (".png", ".svg")
    }
