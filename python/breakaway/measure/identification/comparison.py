"""Friction laws compared on one log: which of them pays for its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from breakaway.base.arguments import check_arguments
from breakaway.base.one_line import OneLine
from breakaway.errors import LogError
from breakaway.measure.identification.identify import identify
from breakaway.measure.identification.laws import LAWS, LawName, check_law
from breakaway.measure.identification.record import Span
from breakaway.measure.identification.result import Identification
from breakaway.measure.logs.log import Log

PAYS_AIC = 2.0
"""AIC that a law must be better by."""

PAYS_ERROR = 0.01
"""Share of the held-out error that a law must be better by."""


@dataclass(frozen=True, eq=False)
class ComparedLaw(OneLine):
    """One law's fit, what it predicts of the held-out rows, and whether it pays.

    ``held_out_error`` is the root mean square on rows that were not fitted, in N or m. ``against``
    names the simpler law that it is judged by; it is empty for the first.
    """

    fit: Identification
    held_out_error: float
    against: str
    pays: bool
    because: str

    def __repr__(self) -> str:
        verdict = "pays" if self.pays else "does not pay"
        return f"<{self.fit.law.name}: {verdict}, {self.because}>"


def compare_laws(
    log: Log,
    *,
    held_out: Span,
    laws: Sequence[LawName] = LAWS,
    **settings: Any,  # noqa: ANN401 - handed on to `identify`, which checks them
) -> tuple[ComparedLaw, ...]:
    """Fit several laws and report which ones pay for their parameters.

    Each is judged by the best of the simpler ones that paid: a law pays if it predicts the held-out
    rows better by 1 % and has an AIC lower by 2. Residuals correlate, so the AIC counts effective
    rows: the fewest that any of the fits has, for all alike.

    Parameters
    ----------
    log : Log
        As for `identify`.
    held_out : (start_s, end_s)
        Rows that are predicted, not fitted.
    laws : sequence of str
        Laws, from simple to rich; each starts where the one before ended.
    **settings
        Further settings of `identify`; ``repeats`` by default is all before ``held_out``.

    Returns
    -------
    tuple of ComparedLaw
        In the order of ``laws``.

    Raises
    ------
    LogError
        As `identify`; or ``held_out`` overlaps the rows that are fitted.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(4000) / 1000.0
    >>> x = 0.1 * np.sin(3 * t_s) + 0.02 * np.sin(11 * t_s)
    >>> v = 0.3 * np.cos(3 * t_s) + 0.22 * np.cos(11 * t_s)
    >>> noise = 0.1 * np.random.default_rng(0).standard_normal(4000)
    >>> log = Log(t_s=t_s, position_m=x, force_n=5.0 * np.sign(v) + 20.0 * v + noise)
    >>> laws = ("coulomb", "stribeck")
    >>> simple, rich = compare_laws(log, held_out=(3.0, 4.0), laws=laws, starts=2)
    >>> simple.pays, rich.pays
    (True, False)

    """
    check_arguments(compare_laws, locals(), LogError)
    for law in laws:
        check_law(law, asymmetric=False, position_dependent=False)
    if not (len(held_out) == 2 and held_out[0] < held_out[1]):
        raise LogError(f"held_out: {held_out!r} is not (start_s, end_s)")
    settings.setdefault("repeats", [(float(log.t_s[0]), held_out[0])])
    for start_s, end_s in settings["repeats"]:
        if start_s < held_out[1] and held_out[0] < end_s:
            raise LogError(
                f"held_out: {held_out[0]:g} s to {held_out[1]:g} s overlaps the fitted span "
                f"{start_s:g} s to {end_s:g} s; fit other rows than are predicted"
            )
    if not laws or "law" in settings:
        raise LogError("laws: is empty; name the laws to compare, from simple to rich")
    fits: list[Identification] = []
    for law in laws:
        simpler = dict(fits[-1].values) if fits else {}
        fits.append(identify(log, law=law, **{"guesses": simpler, **settings}))
        if not fits[-1].complete:
            break  # Ctrl-C: what is there is compared
    errors = [fit.predict(spans=[held_out]).rms_error for fit in fits]
    rows = min(fit.effective_rows for fit in fits)
    out: list[ComparedLaw] = []
    best: int | None = None
    for place, (fit, error) in enumerate(zip(fits, errors, strict=True)):
        if best is None:
            out.append(ComparedLaw(fit, error, "", True, "the first law"))
            best = place
            continue
        gained = 1.0 - error / errors[best]
        drop = fits[best].aic_for(rows) - fit.aic_for(rows)
        pays = gained > PAYS_ERROR and drop > PAYS_AIC
        because = f"held-out error {_change(gained)}, AIC {drop:+.1f} better"
        out.append(ComparedLaw(fit, error, fits[best].law.label, pays, because))
        if pays:
            best = place
    return tuple(out)


def _change(gained: float) -> str:
    """Say by how much an error is smaller.

    >>> _change(0.25), _change(-0.6)
    ('25.0 % smaller', '60.0 % larger')
    """
    return f"{100 * abs(gained):.1f} % {'smaller' if gained >= 0.0 else 'larger'}"
