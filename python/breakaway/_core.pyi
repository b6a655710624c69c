"""The compiled core of breakaway."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__version__: str

def run_one(
    job: Mapping[str, Any],
) -> tuple[str, dict[str, float], dict[str, bytes]]: ...
def impose(
    joint: Mapping[str, Any],
    start_m: float,
    period_s: float,
    velocity_m_per_s: NDArray[np.float64],
) -> list[bytes]: ...
def breakaway_force(joint: Mapping[str, Any], position_m: NDArray[np.float64]) -> bytes: ...
def steady_friction(
    joint: Mapping[str, Any],
    position_m: NDArray[np.float64],
    velocity_m_per_s: NDArray[np.float64],
) -> list[bytes]: ...
def friction_curve(
    joint: Mapping[str, Any],
    position_m: NDArray[np.float64],
    velocity_m_per_s: NDArray[np.float64],
) -> list[bytes]: ...
def friction_field(
    field: Mapping[str, Any], seed: int, run: int, position_m: NDArray[np.float64]
) -> list[bytes]: ...
def law_form(joint: Mapping[str, Any]) -> Literal["bristle", "elements", "rigid"]: ...

OUTCOMES: Sequence[str]

def run_many(
    job: Mapping[str, Any],
    runs: NDArray[np.uint64],
    varied: Sequence[tuple[int, NDArray[np.float64]]],
    figures: Sequence[str],
    outcome: bool,
    threads: int,
    instructions: str,
    tell: Callable[[int], None],
) -> tuple[dict[str, bytes], bytes]: ...
def instructions() -> list[str]: ...
def number_places(job: Mapping[str, Any]) -> dict[str, int]: ...
def export_code(job: Mapping[str, Any], what: str, real: str) -> dict[str, Any]: ...
def export_reference(
    job: Mapping[str, Any], what: str, real: str, inputs: NDArray[np.float64]
) -> dict[str, bytes]: ...
def fractions(seed: int, runs: NDArray[np.uint64], part: int) -> bytes: ...

RIG_NUMBERS: tuple[str, ...]

class RigRecord:
    def __new__(
        cls,
        columns: Sequence[NDArray[np.float64]],
        segments: Sequence[tuple[int, int]],
        drive: Mapping[str, Any],
        elasto_plastic: bool,
        steps: int,
    ) -> RigRecord: ...
    def simulate(self, numbers: Sequence[float]) -> list[bytes]: ...
    def differentiate(
        self,
        numbers: Sequence[float],
        variable: Sequence[int | None],
        position: bool,
        every: int,
    ) -> list[bytes]: ...
    def misfits(self, models: NDArray[np.float64], threads: int) -> bytes: ...
