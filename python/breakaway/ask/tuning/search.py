"""Which method is tried next: optuna's sampler, asked and told, one evaluation after the other."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from breakaway.ask.tuning.evaluation import Evaluation, values_of, violations_of
from breakaway.ask.tuning.problem import Tuning
from breakaway.errors import StudyError

REFUSED = 1e3
"""Violation of a method that no scenario takes: farther off than any that was tried."""
STARTUP_MIN = 10
"""Fewest evaluations before the sampler learns; twice as many as tuned numbers if that is more."""


class Search:
    """Proposes numbers of a method, and learns from what became of them.

    The sampler is TPE: multivariate for one objective, number by number for several. With two
    objectives, twelve numbers of timed impacts, 40 and 80 evaluations and three seeds, the latter's
    fronts had the largest hypervolume in every case, before the multivariate one and NSGA-II. The
    first generations of that are random draws, and it did not do better than drawing all. It
    lives in memory; since what it proposes depends on its seed and on what it was told alone,
    telling it again what is on disk brings it back to the bit.

    Raises
    ------
    StudyError
        optuna is not installed.

    """

    def __init__(self, tuning: Tuning) -> None:
        self._optuna = _optuna()
        self._tuning = tuning
        self._trial: Any = None
        with self._quiet():
            sampler = self._optuna.samplers.TPESampler(
                seed=tuning.sampler_seed,
                multivariate=len(tuning.objectives) == 1,
                constant_liar=False,
                n_startup_trials=max(STARTUP_MIN, 2 * len(tuning.tune)),
            )
            self._study = self._optuna.create_study(
                sampler=sampler,
                directions=[
                    "maximize" if kind.more_is_better else "minimize"
                    for kind in tuning.objective_kinds
                ],
            )
            if tuning.start is not None:
                self._study.enqueue_trial(tuning.start)

    def ask(self) -> dict[str, float]:
        """Propose the numbers of the next method. The first is the method as it is."""
        with self._quiet():
            self._trial = self._study.ask()
            return {
                path: float(self._trial.suggest_float(path, span.low, span.high, log=span.log))
                for path, span in self._tuning.tune.items()
            }

    def tell(self, evaluation: Evaluation) -> None:
        """Tell what became of the numbers that were asked for last."""
        states = self._optuna.trial.TrialState
        with self._quiet():
            if evaluation.laws is None:
                self._trial.set_constraint("refused", REFUSED)
                self._study.tell(self._trial, state=states.PRUNED)
                return
            for name, violation in violations_of(self._tuning, evaluation).items():
                self._trial.set_constraint(name, violation)
            # What is infinite violates a constraint, and is compared by that alone.
            values = [min(value, 1e300) for value in values_of(self._tuning, evaluation)]
            self._study.tell(self._trial, values)

    @contextmanager
    def _quiet(self) -> Iterator[None]:
        """Keep optuna from printing, and leave its settings as they were."""
        before = self._optuna.logging.get_verbosity()
        self._optuna.logging.set_verbosity(self._optuna.logging.ERROR)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                yield
        finally:
            self._optuna.logging.set_verbosity(before)


def _optuna() -> Any:  # noqa: ANN401 - an optional package
    try:
        optuna: Any = import_module("optuna")
    except ImportError:
        raise StudyError(
            "tuning needs optuna; install it with: pip install 'breakaway[tune]'"
        ) from None
    if not hasattr(optuna.trial.Trial, "set_constraint"):
        raise StudyError(
            f"tuning needs optuna >= 5, but {optuna.__version__} is installed; install it with: "
            "pip install --upgrade 'breakaway[tune]' 'optuna>=5'"
        )
    return optuna
