"""The joint file: what one log shows of a joint, and what it does not."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tomli_w
from pydantic import Field, model_validator

from breakaway._core import __version__
from breakaway.base.arguments import check_arguments
from breakaway.base.output import write_atomically
from breakaway.base.reading import text_of
from breakaway.base.text import shown
from breakaway.errors import LogError, ScenarioError
from breakaway.measure.identification.curve import peak_in_words
from breakaway.measure.identification.inertia_friction import InertiaFrictionFit
from breakaway.measure.identification.joint_tables import (
    Assumed,
    Asymmetric,
    AsymmetricParameters,
    Draws,
    End,
    FitSettings,
    Joint,
    Part,
    Provenance,
    PullFigures,
    RelativeForceError,
    Rig,
    Settings,
)
from breakaway.measure.identification.result import Identification
from breakaway.measure.identification.uncertainty import Posterior
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.distribution import Samples
from breakaway.model.scenario.files import parse_toml
from breakaway.model.scenario.laws import Law
from breakaway.model.scenario.model import Model, NotNegative, Text

DRAWS = 200
"""Joints that a file holds."""

NO_PLACE = {
    "viscous_negative_n_s_per_m": "viscous friction of a scenario is the same in both directions, "
    "as in the positive one here",
    "coulomb_slope_n_per_m": "levels of a scenario fall to joint.residual_n at the end of its "
    "guide, and where in the guide the log was recorded is not known",
    "spring_n_per_m": "a scenario has no spring beside the joint",
}
"""What a log can tell of a joint and no scenario has a place for, with the reason."""

METHOD = "IDIM least squares (Janot, Gautier, Brunot 2019)"


class JointFile(Model):
    """An identified joint, as it is kept in ``joint.toml``.

    Units are in the keys. ``not_identified`` maps a field of a scenario to the reason why the
    log does not tell it: such a field keeps the scenario's own value. ``unplaced`` holds what the
    log tells of the joint and no scenario has a place for; `dropped` says why. ``at_least`` has the
    fields that are bounds from below, with the reason: their intervals have no upper end.
    ``assumed`` has what no log told but a study should vary, with a range that is stated, not
    measured. ``pull`` is there where the joint is of one pull.

    Examples
    --------
    >>> import numpy as np
    >>> from breakaway.measure.identification import identify_inertia_friction
    >>> t_s = np.arange(5000) / 1000.0
    >>> v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    >>> force_n = np.gradient(4 * v, t_s) + 30 * v + 6 * np.sign(v)
    >>> x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    >>> log = Log(t_s=t_s, position_m=x, force_n=force_n)
    >>> joint = JointFile.from_fit(identify_inertia_friction(log), log)
    >>> list(joint.scenario_changes())
    ['part.mass_kg', 'joint.coulomb_n', 'joint.viscous_n_s_per_m']

    """

    provenance: Provenance
    part: Part
    joint: Joint
    rig: Rig
    standard_error: dict[str, NotNegative]
    interval: dict[str, list[End]]
    """Name of a parameter -> its ends; the upper one is infinite for a bound from below."""
    asymmetric: Asymmetric | None = None
    relative_force_error_percent: RelativeForceError | None = None
    at_least: dict[str, Text] = Field(default_factory=dict)
    """Field of a scenario that is a bound from below -> why."""
    assumed: dict[str, Assumed] = Field(default_factory=dict)
    """Field of a scenario -> usual value and range, where the log does not tell it, or not all."""
    not_identified: dict[str, Text]
    unplaced: dict[str, float] = Field(default_factory=dict)
    pull: PullFigures | None = None
    draws: Annotated[Draws | None, Field(repr=False)] = None

    @model_validator(mode="after")
    def _says_what_has_no_place(self) -> JointFile:
        for name in self.unplaced:
            if name not in NO_PLACE:
                raise ValueError(f"unplaced: {shown(name)} is not one of {', '.join(NO_PLACE)}")
        return self

    @classmethod
    def from_fit(cls, fit: InertiaFrictionFit, log: Log) -> JointFile:
        """Gather the figures of a fit.

        Parameters
        ----------
        fit : InertiaFrictionFit
            What was identified.
        log : Log
            What it was identified from.

        Raises
        ------
        LogError
            A symmetric friction parameter is negative: no joint file holds such a joint.

        """
        check_arguments(JointFile.from_fit, locals(), LogError)
        both = fit.symmetric
        for name, value in (
            ("coulomb_n", both.coulomb_n),
            ("viscous_n_s_per_m", both.viscous_n_s_per_m),
        ):
            if value < 0.0:
                raise LogError(
                    f"{log.name}: {name} comes out as {value:.4g} ± "
                    f"{both.standard_error[name]:.2g}; a joint file holds values of at least 0: "
                    "record a log whose speeds span a wider range"
                )
        names = tuple(AsymmetricParameters.model_fields)
        each = {name: getattr(fit.asymmetric, name) for name in names}
        return cls(
            provenance=Provenance(
                log=log.name,
                log_sha256=log.sha256,
                breakaway_version=__version__,
                method=METHOD,
                settings=Settings(
                    lowpass_hz=fit.lowpass_hz,
                    decimation=fit.decimation,
                    sample_rate_hz=fit.sample_rate_hz,
                    trimmed_samples=fit.trimmed_samples,
                ),
                samples=both.samples,
                notes=list(fit.notes),
            ),
            part=Part(mass_kg=both.mass_kg),
            joint=Joint(coulomb_n=both.coulomb_n, viscous_n_s_per_m=both.viscous_n_s_per_m),
            rig=Rig(offset_n=both.offset_n),
            standard_error=dict(both.standard_error),
            interval=fit.intervals(),
            asymmetric=Asymmetric.model_validate(
                {**each, "standard_error": dict(fit.asymmetric.standard_error)}
            ),
            relative_force_error_percent=RelativeForceError(
                symmetric=both.relative_force_error_percent,
                asymmetric=fit.asymmetric.relative_force_error_percent,
            ),
            not_identified=dict(fit.not_identified),
            draws=_regression_draws(fit),
        )

    @classmethod
    def from_identification(
        cls, found: Identification, posterior: Posterior | None = None, *, seed: int = 0
    ) -> JointFile:
        """Gather an identification by output error, with draws for a study.

        Parameters
        ----------
        found : Identification
            What was identified.
        posterior : Posterior, optional
            Where it was sampled; else draws are from the normal distribution of the errors.
        seed : int
            Chooses the draws.

        Raises
        ------
        LogError
            The Coulomb friction is not identifiable: there is no joint to write.

        """
        check_arguments(JointFile.from_identification, locals(), LogError)
        told = {one.name for one in found.estimates if one.identifiable}
        coulomb = "coulomb_positive_n" if found.law.asymmetric else "coulomb_n"
        if coulomb in found.fixed:
            raise LogError(
                f"{found.log.name}: {coulomb} was fixed, not identified; there is no joint to write"
            )
        if coulomb not in told:
            raise LogError(
                f"{found.log.name}: {coulomb} is not identifiable from this log, so there is no "
                "joint to write; record reversals and sliding in both directions"
            )
        drawn = posterior.samples if posterior is not None else found.draws(DRAWS, seed=seed)
        fields = _fields_of(found.values, told)
        columns = _fields_of({name: one[_thinned(one)] for name, one in drawn.items()}, told)
        changes: dict[str, dict[str, Any]] = {"part": {}, "joint": {"law": _law_of(found)}}
        for path, value in fields.items():
            table, name = path.split(".")
            changes[table][name] = value
        return cls(
            provenance=_provenance(found),
            part=Part(**changes["part"]),
            joint=Joint(**changes["joint"]),
            rig=Rig(offset_n=_last_offset(found.values)),
            standard_error={
                one.name: one.standard_error for one in found.estimates if one.identifiable
            },
            interval={one.name: [one.low, one.high] for one in found.estimates if one.identifiable},
            not_identified=_not_identified(found, fields),
            unplaced={name: found.values[name] for name in NO_PLACE if name in told},
            draws=Draws(
                source="normal" if posterior is None else "posterior",
                seed=seed,
                values={path: column.tolist() for path, column in columns.items()},
            ),
        )

    def scenario_changes(self) -> dict[str, float]:
        """Return the fields of a scenario that this file sets, and their values."""
        tables = {"part": self.part, "joint": self.joint}
        return {
            f"{table}.{name}": value
            for table, model in tables.items()
            for name, value in model
            if value is not None and name != "law"
        }

    def origin(self, field: str) -> str:
        """Say how a field of `scenario_changes` is known: identified, a bound, assumed or given.

        Parameters
        ----------
        field : str
            Its dotted path, such as ``joint.stiction_n``.

        """
        check_arguments(JointFile.origin, locals(), ScenarioError)
        if field in self.at_least:
            return f"at least: {self.at_least[field]}"
        if field in self.assumed:
            return f"assumed: {self.assumed[field].why}"
        if field == "part.mass_kg" and self.provenance.search is not None:
            return "given"
        return "identified"

    def dropped(self) -> dict[str, tuple[float, str]]:
        """Return what no scenario has a place for: each value, and why it has none."""
        each = self.asymmetric
        by_direction = {} if each is None else each.model_dump(exclude={"standard_error"})
        other = "of a second fit, with friction by direction and no offset; the first is used"
        return {
            **{name: (value, NO_PLACE[name]) for name, value in self.unplaced.items()},
            **{f"asymmetric.{name}": (value, other) for name, value in by_direction.items()},
            "rig.offset_n": (self.rig.offset_n, "belongs to the rig, not to the joint"),
        }

    def vary(self) -> dict[str, Samples]:
        """Return what differs from part to part in a study: rows of the draws.

        Raises
        ------
        ScenarioError
            The file has no draws.

        """
        if self.draws is None:
            raise ScenarioError(
                "joint file: has no draws, so its spread is not known; identify the joint again"
            )
        return {
            path: Samples(values=tuple(values), rows="shared")
            for path, values in self.draws.values.items()
        }

    def save(self, path: str | Path) -> None:
        """Write the file whole or not at all.

        Parameters
        ----------
        path : str or Path
            The file; missing folders are made.

        Raises
        ------
        OutputError
            The folder cannot be made or not be written to, or ``path`` is a folder.

        """
        check_arguments(JointFile.save, locals(), LogError)
        text = tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))
        write_atomically(Path(path), text.encode())

    @classmethod
    def load(cls, path: str | Path) -> JointFile:
        """Read a joint file.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        ScenarioError
            The file is missing, not TOML, lacks a key, has one too many, or has a value out of
            range; each is named.

        """
        check_arguments(JointFile.load, locals(), LogError)
        source = Path(path)
        return parse_toml(cls, text_of(source, ScenarioError), source.name)


def _fields_of(values: Mapping[str, Any], told: set[str]) -> dict[str, Any]:
    """Return fields of a scenario from parameters, or columns of fields from columns."""

    def positive(name: str) -> str:
        return name if name in values else _sided(name)

    fields: dict[str, Any] = {}
    coulomb = values[positive("coulomb_n")]
    fields["joint.coulomb_n"] = coulomb
    viscous = positive("viscous_n_s_per_m")
    if viscous in told:
        fields["joint.viscous_n_s_per_m"] = values[viscous]
    if "stiction_ratio" in told:
        fields["joint.stiction_n"] = values["stiction_ratio"] * coulomb
    for name in (
        "stribeck_velocity_m_per_s",
        "stiffness_n_per_m",
        "damping_n_s_per_m",
        "elastic_share",
    ):
        if name in told:
            fields[f"joint.{name}"] = values[name]
    if "coulomb_negative_n" in told:
        fields["joint.backward_ratio"] = values["coulomb_negative_n"] / coulomb
    if "mass_kg" in told:
        fields["part.mass_kg"] = values["mass_kg"]
    return fields


def _last_offset(values: Mapping[str, float]) -> float:
    offsets = [value for name, value in values.items() if name.startswith("offset_")]
    return offsets[-1] if offsets else 0.0


def _sided(name: str) -> str:
    """Return the name of a number in the positive direction.

    >>> _sided("viscous_n_s_per_m")
    'viscous_positive_n_s_per_m'
    """
    quantity, unit = name.split("_", 1)
    return f"{quantity}_positive_{unit}"


def _thinned(column: Array) -> slice:
    return slice(None, None, max(1, len(column) // DRAWS))


def _law_of(found: Identification) -> Law | None:
    """Return the law of a scenario that a fit was made with; one without a bristle tells none."""
    return found.law.name if found.law.has_bristle else None


_IN_THE_FIT = {"stiction_n": "stiction_ratio", "backward_ratio": "coulomb_negative_n"}
"""Field of a scenario -> the parameter of a fit that tells it, where their names differ."""


def _not_identified(found: Identification, fields: Mapping[str, float]) -> dict[str, str]:
    reasons = {one.parameter: one.because for one in found.verdicts if not one.identifiable}
    out = {}
    for field in (
        "joint.stiction_n",
        "joint.viscous_n_s_per_m",
        "joint.stiffness_n_per_m",
        "joint.damping_n_s_per_m",
        "joint.stribeck_velocity_m_per_s",
        *(["joint.elastic_share"] if found.law.elasto_plastic else []),
        *(["joint.backward_ratio"] if found.law.asymmetric else []),
        "part.mass_kg",
    ):
        if field not in fields:
            name = field.split(".")[1]
            keys = (_IN_THE_FIT.get(name, name), _sided(name))
            why = next((reasons[key] for key in keys if key in reasons), "it was held in the fit")
            out[field] = why
    out["joint.engagement_length_m"] = "the length of the guide is known from the drawing"
    return out


def _provenance(found: Identification) -> Provenance:
    settings = found.settings
    return Provenance(
        log=found.log.name,
        log_sha256=found.log.sha256,
        breakaway_version=__version__,
        method=f"output error, {found.law.label}, {settings.motion} motion",
        fit=FitSettings(
            law=found.law.name,
            asymmetric=found.law.asymmetric,
            position_dependent=found.law.position_dependent,
            motion=settings.motion,
            repeats=[list(span) for span in found.spans],
            origin_m=settings.origin_m,
            steps_per_row=settings.steps,
            rig=settings.rig,
            loss=found.loss,
            starts=found.starts,
            seed=found.seed,
            complete=found.complete,
        ),
        samples=len(found.fit.t_s),
        notes=[*found.notes, peak_in_words(found)],
    )


def _regression_draws(fit: InertiaFrictionFit) -> Draws:
    """Draw joints from the normal distribution of the regression's errors."""
    both = fit.symmetric
    fields = {
        "mass_kg": "part.mass_kg",
        "coulomb_n": "joint.coulomb_n",
        "viscous_n_s_per_m": "joint.viscous_n_s_per_m",
    }
    names = list(both.standard_error)
    places = [names.index(name) for name in fields]
    covariance = np.array(both.covariance)[np.ix_(places, places)]
    center = [getattr(both, name) for name in fields]
    rng = np.random.default_rng(0)
    kept = np.empty((0, len(fields)))
    while len(kept) < DRAWS:
        drawn = rng.multivariate_normal(center, covariance, DRAWS)
        kept = np.vstack([kept, drawn[(drawn > 0.0).all(axis=1)]])
    columns = {path: kept[:DRAWS, i].tolist() for i, path in enumerate(fields.values())}
    return Draws(source="normal", seed=0, values=columns)
