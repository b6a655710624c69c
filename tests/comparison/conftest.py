"""A population of short guides, and three quick ways to free them: one gentle, two not."""

from __future__ import annotations

from pathlib import Path

import pytest

import breakaway as bk

POPULATION = """
name = "short"
description = "Short guides, <quick> & small"
duration_s = 0.4

[parts]
stiction_n = { distribution = "log_uniform", low = 200.0, high = 800.0 }
stiction_ratio = { distribution = "uniform", low = 1.2, high = 2.0 }
presliding_m = { distribution = "uniform", low = 20e-6, high = 30e-6 }
bristle_damping_ratio = { distribution = "uniform", low = 0.3, high = 1.0 }
stribeck_velocity_m_per_s = { distribution = "uniform", low = 0.02, high = 0.2 }
mass_kg = { distribution = "uniform", low = 0.8, high = 1.2 }
engagement_length_m = { distribution = "uniform", low = 1e-3, high = 2e-3 }
var = { distribution = "uniform", low = 0.0, high = 0.3 }
hold_s = { distribution = "uniform", low = 1e-3, high = 1e-2 }
correlation_length_m = { distribution = "log_uniform", low = 1e-5, high = 1e-3 }

[sensors.position]
noise_rms_m = 1e-6
"""
METHODS = {
    "follow": """
name = "follow"
description = "A PID along a smooth reference"
[actuator]
kind = "force"
force_max_n = 8000.0
bandwidth_hz = 1000.0
force_rate_max_n_per_s = 1e8
[reference]
kind = "minimum_jerk"
distance_m = 0.0015
duration_s = 0.35
[controller]
kind = "pid"
velocity_from = "position_difference"
derivative_filter_s = 1e-4
anti_windup = "conditional"
gains = { kind = "given", kp_n_per_m = 3137.3e3, ki_n_per_m_s = 1283289e3, kd_n_s_per_m = 724.2 }
[knows]
"reference.distance_m" = "engagement_length_m"
""",
    "ramp": """
name = "ramp"
description = "A force that grows by 3 kN/s"
[actuator]
kind = "force"
force_max_n = 8000.0
bandwidth_hz = 1000.0
force_rate_max_n_per_s = 1e8
[controller]
kind = "force_ramp"
rate_n_per_s = 3000.0
travel_m = 0.0015
[knows]
"controller.travel_m" = "engagement_length_m"
""",
    "weak": """
name = "weak & <slow>"
description = "A force that is too small for most parts."
[actuator]
kind = "force"
force_max_n = 300.0
bandwidth_hz = 1000.0
force_rate_max_n_per_s = 1e8
[controller]
kind = "force_ramp"
rate_n_per_s = 2000.0
travel_m = 0.0015
""",
}


def write_inputs(folder: Path) -> tuple[Path, list[Path]]:
    """Write the population and the methods as files."""
    population = folder / "short.toml"
    population.write_text(POPULATION)
    paths = []
    for name, text in METHODS.items():
        paths.append(folder / f"{name}.toml")
        paths[-1].write_text(text)
    return population, paths


@pytest.fixture(scope="session")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Path]]:
    """Give the files of the population and of the methods."""
    return write_inputs(tmp_path_factory.mktemp("inputs"))


@pytest.fixture(scope="session")
def whole(inputs: tuple[Path, list[Path]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the folder of a comparison that nothing interrupted, on two threads."""
    population, methods = inputs
    folder = tmp_path_factory.mktemp("comparisons") / "whole"
    bk.compare_methods(
        population, methods, laws=["lugre", "elasto_plastic"], runs=24, out=folder, threads=2
    )
    return folder


@pytest.fixture(scope="session")
def done(whole: Path) -> bk.Comparison:
    """Give the same comparison as read back from its folder."""
    return bk.compare_methods(whole / "comparison.toml", out=whole, resume=True)
