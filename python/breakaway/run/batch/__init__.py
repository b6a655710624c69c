"""Many runs of one scenario: draws of their own, and parts of their own."""

from __future__ import annotations

from breakaway.run.batch.batch import Batch
from breakaway.run.batch.draw import Design, draw_columns, grid_columns
from breakaway.run.batch.simulation import METRICS, check_batch_fits, run_columns, simulate_many

__all__ = [
    "METRICS",
    "Batch",
    "Design",
    "check_batch_fits",
    "draw_columns",
    "grid_columns",
    "run_columns",
    "simulate_many",
]
