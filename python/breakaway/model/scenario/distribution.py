"""Distributions of a number that differs from part to part."""

from __future__ import annotations

from typing import Annotated, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.model.scenario.model import Model, NotNegative, Positive

Array = NDArray[np.float64]
AnyModel = TypeVar("AnyModel", bound=Model)


class Uniform(Model):
    """Every number from ``low`` to ``high`` is as likely as any other.

    Examples
    --------
    >>> import numpy as np
    >>> float(Uniform(low=1.0, high=3.0).quantile(np.array([0.25]))[0])
    1.5

    """

    distribution: Literal["uniform"] = "uniform"
    """The kind of distribution."""
    low: float
    """Smallest value."""
    high: float
    """Largest value."""

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        return _ordered(self, self.low, self.high)

    def quantile(self, u: Array) -> Array:
        """Give the value below which a share ``u`` of all values lies.

        Parameters
        ----------
        u : ndarray
            Shares, within 0 and 1.

        """
        check_arguments(Uniform.quantile, locals(), ScenarioError)
        return (1.0 - u) * self.low + u * self.high

    def scaled(self, factor: float) -> Uniform:
        """Give the distribution with its width multiplied, about its center.

        Parameters
        ----------
        factor : float
            1 for no change, 0 for no spread; at most 1, because the law fills its range.

        Raises
        ------
        ScenarioError
            The factor is above 1.

        """
        check_arguments(Uniform.scaled, locals(), ScenarioError)
        factor = _not_wider(self.distribution, "normal", factor)
        center, half = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        return Uniform(low=center - factor * half, high=center + factor * half)


class LogUniform(Model):
    """Every ratio is as likely as any other: the logarithm is uniform.

    Examples
    --------
    >>> import numpy as np
    >>> round(float(LogUniform(low=150.0, high=4500.0).quantile(np.array([0.5]))[0]), 1)
    821.6

    """

    distribution: Literal["log_uniform"] = "log_uniform"
    """The kind of distribution."""
    low: Positive
    """Smallest value."""
    high: Positive
    """Largest value."""

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        return _ordered(self, self.low, self.high)

    def quantile(self, u: Array) -> Array:
        """Give the value below which a share ``u`` of all values lies.

        Parameters
        ----------
        u : ndarray
            Shares, within 0 and 1.

        """
        check_arguments(LogUniform.quantile, locals(), ScenarioError)
        return _within(self.low ** (1.0 - u) * self.high**u, self.low, self.high)

    def scaled(self, factor: float) -> LogUniform:
        """Give the distribution with its width in the logarithm multiplied, about its center.

        Parameters
        ----------
        factor : float
            1 for no change, 0 for no spread; at most 1, because the law fills its range.

        Raises
        ------
        ScenarioError
            The factor is above 1.

        """
        check_arguments(LogUniform.scaled, locals(), ScenarioError)
        factor = _not_wider(self.distribution, "log_normal", factor)
        center, half = (self.low * self.high) ** 0.5, (self.high / self.low) ** (0.5 * factor)
        return LogUniform(low=center / half, high=center * half)


class Normal(Model):
    """The normal distribution, truncated where ``low`` or ``high`` is given.

    Truncated means restricted: no value is moved to a bound.

    Examples
    --------
    >>> import numpy as np
    >>> float(Normal(mean=450.0, std=50.0, low=300.0, high=600.0).quantile(np.array([0.5]))[0])
    450.0

    """

    distribution: Literal["normal"] = "normal"
    """The kind of distribution."""
    mean: float
    """Mean of the distribution before it is truncated."""
    std: NotNegative
    """Standard deviation of the distribution before it is truncated."""
    low: float | None = None
    """Smallest value. Left out: no limit."""
    high: float | None = None
    """Largest value. Left out: no limit."""

    @model_validator(mode="after")
    def _has_values(self) -> Self:
        return _ordered(self, self.low, self.high)

    def quantile(self, u: Array) -> Array:
        """Give the value below which a share ``u`` of all values lies.

        Parameters
        ----------
        u : ndarray
            Shares, within 0 and 1.

        """
        check_arguments(Normal.quantile, locals(), ScenarioError)
        from scipy.special import ndtr, ndtri

        if self.std == 0.0:
            return _within(np.full_like(u, self.mean), self.low, self.high)
        low = -np.inf if self.low is None else (self.low - self.mean) / self.std
        high = np.inf if self.high is None else (self.high - self.mean) / self.std
        side = 1.0
        if low >= 0.0:  # an upper tail is computed as the lower one, where small shares are exact
            low, high, u, side = -high, -low, 1.0 - u, -1.0
        if ndtr(high) == 0.0:  # so far from the mean that all values are at the nearer bound
            return _within(np.full_like(u, self.mean), self.low, self.high)
        share = (1.0 - u) * ndtr(low) + u * ndtr(high)
        values = self.mean + side * self.std * np.asarray(ndtri(share))
        return _within(values, self.low, self.high)

    def scaled(self, factor: float) -> Normal:
        """Give the distribution with its standard deviation multiplied; its bounds stay.

        Parameters
        ----------
        factor : float
            1 for no change, 0 for no spread.

        """
        check_arguments(Normal.scaled, locals(), ScenarioError)
        return Normal(mean=self.mean, std=factor * self.std, low=self.low, high=self.high)


SIGMA_MAX = 50.0
"""Largest standard deviation of a logarithm: draws of a wider law would leave the numbers."""


class LogNormal(Model):
    """The logarithm is normal; truncated where ``low`` or ``high`` is given.

    Examples
    --------
    >>> import numpy as np
    >>> float(LogNormal(median=450.0, sigma=0.3).quantile(np.array([0.5]))[0])
    450.0

    """

    distribution: Literal["log_normal"] = "log_normal"
    """The kind of distribution."""
    median: Positive
    """Median of the distribution before it is truncated."""
    sigma: Annotated[float, Field(ge=0.0, le=SIGMA_MAX)]
    """Standard deviation of the natural logarithm."""
    low: Positive | None = None
    """Smallest value. Left out: 0."""
    high: Positive | None = None
    """Largest value. Left out: no limit."""

    @model_validator(mode="after")
    def _has_values(self) -> Self:
        return _ordered(self, self.low, self.high)

    def quantile(self, u: Array) -> Array:
        """Give the value below which a share ``u`` of all values lies.

        Parameters
        ----------
        u : ndarray
            Shares, within 0 and 1.

        """
        check_arguments(LogNormal.quantile, locals(), ScenarioError)
        normal = Normal(
            mean=0.0,
            std=self.sigma,
            low=None if self.low is None else float(np.log(self.low / self.median)),
            high=None if self.high is None else float(np.log(self.high / self.median)),
        )
        return _within(self.median * np.exp(normal.quantile(u)), self.low, self.high)

    def scaled(self, factor: float) -> LogNormal:
        """Give the distribution with its width in the logarithm multiplied; its bounds stay.

        Parameters
        ----------
        factor : float
            1 for no change, 0 for no spread.

        """
        check_arguments(LogNormal.scaled, locals(), ScenarioError)
        sigma = factor * self.sigma
        return LogNormal(median=self.median, sigma=sigma, low=self.low, high=self.high)


class Samples(Model):
    """Values from a table, each as likely as any other.

    Examples
    --------
    >>> import numpy as np
    >>> Samples(values=[1.0, 2.0, 4.0]).quantile(np.array([0.1, 0.5, 0.9])).tolist()
    [1.0, 2.0, 4.0]

    """

    distribution: Literal["samples"] = "samples"
    """The kind of distribution."""
    values: Annotated[tuple[float, ...], Field(min_length=1, strict=False, repr=False)]
    """The values."""
    rows: Literal["independent", "shared"] = "independent"
    """Whether a value is taken on its own, or from the same row of the table as those of the other
    shared samples, which keeps their correlation."""

    def quantile(self, u: Array) -> Array:
        """Give the value whose place in the table is the share ``u`` of its length.

        Parameters
        ----------
        u : ndarray
            Shares, within 0 and 1.

        """
        check_arguments(Samples.quantile, locals(), ScenarioError)
        count = len(self.values)
        place = np.minimum((u * count).astype(np.int64), count - 1)
        return np.asarray(self.values)[place]

    def scaled(self, factor: float) -> Samples:
        """Give the table with every value moved from or to its center.

        Where all values are above 0, so are the moved ones: they move in the logarithm, about the
        geometric mean; else about the mean.

        Parameters
        ----------
        factor : float
            1 for no change, 0 for no spread.

        Raises
        ------
        ScenarioError
            A value is moved beyond the largest number, or one above 0 to 0.

        """
        check_arguments(Samples.scaled, locals(), ScenarioError)
        values = np.asarray(self.values)
        is_positive = bool((values > 0.0).all())
        with np.errstate(over="ignore", under="ignore"):
            if is_positive:
                logs = np.log(values)
                moved = np.exp(logs.mean() + factor * (logs - logs.mean()))
            else:
                moved = values.mean() + factor * (values - values.mean())
        if not np.isfinite(moved).all() or (is_positive and not moved.all()):
            raise ScenarioError(
                f"factor: {factor!r} moves samples beyond what a number can hold; give a smaller "
                "one, or samples that are nearer to each other"
            )
        return Samples(values=tuple(moved.tolist()), rows=self.rows)


Distribution = Annotated[
    Uniform | LogUniform | Normal | LogNormal | Samples, Field(discriminator="distribution")
]


def _ordered(model: AnyModel, low: float | None, high: float | None) -> AnyModel:
    if low is not None and high is not None and low > high:
        raise ValueError(f"low: {low!r} is not <= high = {high!r}; swap them")
    return model


def _not_wider(law: str, other: str, factor: float) -> float:
    """Give a factor for the width of a law that fills its range, but for rounding at most 1."""
    if factor > 1.0 + 1e-9:
        raise ScenarioError(
            f"factor: {factor!r} is not <= 1, because the distribution {law!r} fills its range; "
            f"give at most 1, or the distribution {other!r} with the same low and high"
        )
    return min(factor, 1.0)


def _within(values: Array, low: float | None, high: float | None) -> Array:
    """Undo what rounding added beyond a bound."""
    return np.asarray(np.clip(values, low, high)) if (low, high) != (None, None) else values
