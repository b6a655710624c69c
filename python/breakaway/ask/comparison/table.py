"""The numbers of a comparison: a row for each case and method, against the best of the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from breakaway.ask.studies.plan import Row
from breakaway.ask.studies.statistics import clopper_pearson, mcnemar, median_interval
from breakaway.model.scenario.population import Gentleness
from breakaway.run.trials import Case, Trial

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CONFIDENCE = 0.95
"""Of every interval."""
RELEASED_ENOUGH = 0.9
"""Share of parts that a method frees at least, to be the best in anything but that."""
SHARES = ("released", "gentle", "strict")
"""What a row gives as counts, shares and intervals."""
CRITERIA = {
    "force": ("peak_over_breakaway", "peak_over_breakaway_max"),
    "jump": ("largest_jump_m", "jump_max_m"),
    "velocity": ("release_velocity_m_per_s", "release_velocity_max_m_per_s"),
}
"""Criterion of gentleness -> the metric it is about, and its limit."""
SPREADS = (
    "time_to_release_s",
    "largest_jump_m",
    "peak_over_breakaway",
    "release_velocity_m_per_s",
    "largest_impact_work_j",
    "impulse_n_s",
)
"""Metrics whose median, with its interval, and 99 % quantile a row gives."""
WEAR = ("stack_cycles", "rms_current_a", "stack_loss_w")
"""What wears a piezo stack; only where there is one."""
LOWER_IS_BETTER = (
    "time_to_release_s_median",
    "largest_jump_m_median",
    "largest_jump_m_p99",
    "peak_over_breakaway_median",
    "peak_over_breakaway_p99",
    "release_velocity_m_per_s_p99",
    "largest_impact_work_j_p99",
    "impulse_n_s_median",
)
"""Columns whose lowest value is the best."""
HIGHER_IS_BETTER = (*(f"{name}_share" for name in SHARES), *(f"{name}_share" for name in CRITERIA))
"""Columns whose highest value is the best."""

Trials = Mapping[Case, Mapping[str, Trial]]
"""Case -> name of a method -> what it did."""


def table_of(trials: Trials, baselines: Sequence[str]) -> list[Row]:
    """Give a row for each case and method, in their order."""
    rows: list[Row] = []
    for case, by_method in trials.items():
        of_case = [_row(case, name, trial) for name, trial in by_method.items()]
        for row in of_case:
            _add_pairing(row, of_case, by_method, baselines or list(by_method))
        _add_best(of_case)
        rows += of_case
    return rows


def case_of(row: Mapping[str, Any]) -> Case:
    """Give the case of a row."""
    return Case(row["law"], row["variation"])


def criterion_met(trial: Trial, criterion: str, limits: Gentleness) -> Mask:
    """Tell which parts are free and within one limit, whatever the others say."""
    metric, limit = CRITERIA[criterion]
    within = trial.metrics[metric] <= getattr(limits, limit)
    return np.asarray(trial.released & within)


def has_stack(trial: Trial) -> bool:
    """Whether a piezo stack pushes."""
    return getattr(getattr(trial.method.actuator, "tip", None), "kind", None) == "piezo"


def worst_row(trial: Trial) -> int:
    """Give the row of the part with the largest jump, the first where several share it."""
    jump = trial.metrics["largest_jump_m"]
    return int(np.argmax(np.where(np.isfinite(jump), jump, -1.0)))


def median_row(trial: Trial) -> int | None:
    """Give the row of the middle part by its jump, among those that are free; None without any."""
    rows = np.flatnonzero(trial.released & np.isfinite(trial.metrics["largest_jump_m"]))
    if not len(rows):
        return None
    order = np.argsort(trial.metrics["largest_jump_m"][rows], kind="stable")
    return int(rows[order[(len(rows) - 1) // 2]])


def _row(case: Case, method: str, trial: Trial) -> Row:
    gentle, strict = trial.population.gentle, trial.population.strict
    runs, median = len(trial.runs), median_row(trial)
    row: Row = {"law": case.law, "variation": case.variation, "method": method, "runs": runs}
    for name, mask in zip(
        SHARES, (trial.released, trial.within(gentle), trial.within(strict)), strict=True
    ):
        low, high = clopper_pearson(int(mask.sum()), runs, CONFIDENCE)
        row |= {name: int(mask.sum()), f"{name}_share": float(mask.mean())}
        row |= {f"{name}_low": low, f"{name}_high": high}
    for name in CRITERIA:
        row[f"{name}_share"] = float(criterion_met(trial, name, gentle).mean())
    for name in SPREADS:
        row |= _spread(name, trial.metrics[name], released=trial.released)
    for name in WEAR:
        row |= {f"{name}_median": _median(trial.metrics[name]) if has_stack(trial) else None}
    row["stopped"] = int((trial.metrics["stop_reason"] > 0).sum())
    row["median_run"] = None if median is None else trial.runs[median]
    row["worst_run"] = trial.runs[worst_row(trial)]
    return row


def _spread(name: str, values: Array, *, released: Mask) -> Row:
    """Give median, its interval, and the 99 % quantile.

    Of the parts that are free where the metric is of the release, and of all parts otherwise.
    """
    of_release = name in ("time_to_release_s", "release_velocity_m_per_s")
    kept = values[np.isfinite(values) & (released if of_release else True)]
    keys = [f"{name}_{key}" for key in ("median", "median_low", "median_high", "p99")]
    if not len(kept):
        return dict.fromkeys(keys)
    found = median_interval(kept, CONFIDENCE)
    numbers = (found.median, found.low, found.high, float(np.quantile(kept, 0.99)))
    return dict(zip(keys, numbers, strict=True))


def _median(values: Array) -> float | None:
    kept = values[np.isfinite(values)]
    return float(np.median(kept)) if len(kept) else None


def rank(row: Mapping[str, Any]) -> tuple[int, int, float]:
    """Order rows by how gentle their methods are: gentle, strict, and then small jumps."""
    jump = row["largest_jump_m_median"]
    return row["gentle"], row["strict"], -(np.inf if jump is None else jump)


def _add_pairing(
    row: Row, of_case: Sequence[Row], by_method: Mapping[str, Trial], baselines: Sequence[str]
) -> None:
    """Compare a method with the best of the others, part by part."""
    rivals = [r for r in of_case if r["method"] in baselines and r["method"] != row["method"]]
    best = max(rivals, key=rank, default=None)
    row["against"] = None if best is None else best["method"]
    for name in ("gentle", "strict"):
        only = None if best is None else paired(by_method[row["method"]], by_method[best["method"]])
        ours, theirs, p = only[name] if only else (None, None, None)
        row |= {f"{name}_only_this": ours, f"{name}_only_other": theirs, f"{name}_p": p}


def paired(one: Trial, other: Trial) -> dict[str, tuple[int, int, float]]:
    """Count the parts that only one and only the other spares, with the p value of McNemar."""
    found = {}
    for name in ("gentle", "strict"):
        limits = getattr(one.population, name)
        first, second = one.within(limits), other.within(limits)
        counts = int((first & ~second).sum()), int((second & ~first).sum())
        found[name] = (*counts, mcnemar(*counts))
    return found


def _add_best(of_case: Sequence[Row]) -> None:
    """Name the columns in which each method is the best of its case."""
    for row in of_case:
        row["best"] = ""
    if len(of_case) < 2:
        return
    free = [row for row in of_case if row["released_share"] >= RELEASED_ENOUGH]
    for names, rows, choose in ((HIGHER_IS_BETTER, of_case, max), (LOWER_IS_BETTER, free, min)):
        for name in names:
            values = [row[name] for row in rows if row[name] is not None]
            best = choose(values, default=None)
            holders = [row for row in rows if row[name] is not None and row[name] == best]
            if len(holders) == len(of_case) or (choose is max and best == 0.0):
                continue  # says nothing
            for row in holders:
                row["best"] += f"{';' if row['best'] else ''}{name}"
