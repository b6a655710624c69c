"""The joint file: what one log told about a joint, and what it did not."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tomli_w
from pydantic import Field

from breakaway._core import __version__
from breakaway.errors import LogError, ScenarioError
from breakaway.identification.inertia_friction import InertiaFrictionFit
from breakaway.logs.log import Log
from breakaway.output import write_atomically
from breakaway.scenario.files import parse_toml
from breakaway.scenario.model import Model, NotNegative, Positive

METHOD = "IDIM least squares (Janot, Gautier, Brunot 2019)"


class Settings(Model):
    """Settings of the identification."""

    lowpass_hz: Positive
    decimation: Annotated[int, Field(ge=1)]
    sample_rate_hz: Positive
    trimmed_samples: Annotated[int, Field(ge=0)]


class Provenance(Model):
    """Where the figures come from. ``log_sha256`` is absent for a log that was in no file."""

    log: str
    log_sha256: str | None = None
    breakaway_version: str
    method: str
    settings: Settings
    samples: Annotated[int, Field(ge=1)]
    notes: Annotated[list[str], Field(default_factory=list)]


class Part(Model):
    """The moving part."""

    mass_kg: Positive


class Joint(Model):
    """Sliding friction of the joint, the same in both directions."""

    coulomb_n: NotNegative
    viscous_n_s_per_m: NotNegative


class Rig(Model):
    """What belongs to the rig that measured, not to the joint."""

    offset_n: float


class StandardError(Model):
    """Standard errors of the symmetric parameters."""

    mass_kg: NotNegative
    coulomb_n: NotNegative
    viscous_n_s_per_m: NotNegative
    offset_n: NotNegative


class AsymmetricParameters(Model):
    """Parameters with friction of its own in each direction, positive where it resists."""

    mass_kg: float
    viscous_positive_n_s_per_m: float
    viscous_negative_n_s_per_m: float
    coulomb_positive_n: float
    coulomb_negative_n: float


class Asymmetric(AsymmetricParameters):
    """The asymmetric parameters and their standard errors."""

    standard_error: AsymmetricParameters


class RelativeForceError(Model):
    """100 ‖F - W θ‖ / ‖F‖ of either fit, in percent."""

    symmetric: NotNegative
    asymmetric: NotNegative


class JointFile(Model):
    """An identified joint, as it is kept in ``joint.toml``.

    Units are in the keys. ``not_identified`` maps a field of a scenario to the reason why the
    log does not tell it: such a field keeps the scenario's own value.

    Examples
    --------
    >>> import numpy as np
    >>> from breakaway.identification import identify_inertia_friction
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
    standard_error: StandardError
    asymmetric: Asymmetric
    relative_force_error_percent: RelativeForceError
    not_identified: dict[str, str]

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
            standard_error=StandardError.model_validate(dict(both.standard_error)),
            asymmetric=Asymmetric.model_validate(
                {**each, "standard_error": dict(fit.asymmetric.standard_error)}
            ),
            relative_force_error_percent=RelativeForceError(
                symmetric=both.relative_force_error_percent,
                asymmetric=fit.asymmetric.relative_force_error_percent,
            ),
            not_identified=dict(fit.not_identified),
        )

    def scenario_changes(self) -> dict[str, float]:
        """Return the fields of a scenario that this file sets, and their values."""
        return {
            "part.mass_kg": self.part.mass_kg,
            "joint.coulomb_n": self.joint.coulomb_n,
            "joint.viscous_n_s_per_m": self.joint.viscous_n_s_per_m,
        }

    def save(self, path: str | Path) -> None:
        """Write the file whole or not at all.

        Parameters
        ----------
        path : str or Path
            The file; its folder must exist.

        Raises
        ------
        OutputError
            The folder is missing or can not be written, or ``path`` is a folder.

        """
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
        source = Path(path)
        try:
            text = source.read_text(encoding="utf-8")
        except FileNotFoundError:
            raise ScenarioError(f"{source}: there is no such file; check the path") from None
        except (OSError, UnicodeDecodeError) as error:
            raise ScenarioError(f"{source}: can not be read as text: {error}") from None
        return parse_toml(cls, text, source.name)
