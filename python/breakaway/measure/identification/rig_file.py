"""The rig file: what lies between a part and the sensors that measured it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tomli_w
from pydantic import Field, model_validator

from breakaway.base.arguments import check_arguments
from breakaway.base.output import write_atomically
from breakaway.base.reading import text_of
from breakaway.errors import LogError, ScenarioError
from breakaway.measure.logs.derived import SPACING_TOLERANCE, derive_motion
from breakaway.measure.logs.log import Array, Log
from breakaway.model.scenario.files import parse_toml
from breakaway.model.scenario.model import Model, NotNegative, Positive, Text


class RigFile(Model):
    """A rig, as it is kept in ``rig.toml``: compliance, mass and filter beside the joint.

    ::

        x_part = x - F / k_rig        F_part = F - m_rig a

    with x and F as measured. What is left out is not known; errors are standard uncertainties.

    Examples
    --------
    >>> import numpy as np
    >>> t_s = np.arange(100) / 100.0
    >>> log = Log(t_s=t_s, position_m=1e-3 * t_s, force_n=100.0 * t_s)
    >>> rig = RigFile(stiffness_n_per_m=1e6, force_calibration_percent=0.5)
    >>> round(float(rig.at_part(log).position_m[-1]), 9)
    0.000891

    """

    stiffness_n_per_m: Positive | None = None
    """k_rig: stiffness between the position sensor and the part, in N/m."""
    stiffness_error_n_per_m: NotNegative = 0.0
    """Its standard uncertainty, in N/m."""
    mass_kg: NotNegative = 0.0
    """m_rig: mass between the load cell and the part, such as a clamp, in kg."""
    mass_error_kg: NotNegative = 0.0
    """Its standard uncertainty, in kg."""
    position_sensor: Literal["drive", "part"] = "drive"
    """What the position is measured at; at the part, no compliance of the rig is in it."""
    filter_hz: Positive | None = None
    """Cutoff of the low-pass in front of the sampling of the force, in Hz."""
    force_calibration_percent: Annotated[float, Field(ge=0.0, le=20.0)] = 0.0
    """Standard uncertainty of the load cell's gain, in percent of the force."""
    notes: list[Text] = Field(default_factory=list)
    """Where the figures come from, and what they leave open."""

    @model_validator(mode="after")
    def _sensor_sees_the_stiffness(self) -> RigFile:
        if self.position_sensor == "part" and self.stiffness_n_per_m is not None:
            raise ValueError(
                "stiffness_n_per_m: has no effect with position_sensor = 'part'; leave one out"
            )
        return self

    @property
    def stiffness_is_told(self) -> bool:
        """Whether a position at the part can be had, and so the stiffness of the joint alone."""
        return self.position_sensor == "part" or self.stiffness_n_per_m is not None

    def at_part(self, log: Log) -> Log:
        """Return a log with position and force at the part.

        Parameters
        ----------
        log : Log
            Position and force as measured.

        Notes
        -----
        The acceleration is that of `derive_motion` where stamps are even, else that of
        differences, and so is its noise.

        """
        check_arguments(RigFile.at_part, locals(), LogError)
        position, force = log.position_m, log.force_n
        if self.stiffness_n_per_m is not None:
            position = position - force / self.stiffness_n_per_m
        moved = _changed(log, position, force)
        if self.mass_kg == 0.0:
            return moved
        return _changed(log, position, force - self.mass_kg * _acceleration(moved))

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
        check_arguments(RigFile.save, locals(), LogError)
        text = tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))
        write_atomically(Path(path), text.encode())

    @classmethod
    def load(cls, path: str | Path) -> RigFile:
        """Read a rig file.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        ScenarioError
            The file is missing, not TOML, has an unknown key, or has a value out of range; each
            is named.

        """
        check_arguments(RigFile.load, locals(), LogError)
        source = Path(path)
        return parse_toml(cls, text_of(source, ScenarioError), source.name)


def _changed(log: Log, position: Array, force: Array) -> Log:
    return Log(
        position_m=position,
        force_n=force,
        channels=log.channels,
        source=log.source,
        sha256=log.sha256,
        ignored_columns=log.ignored_columns,
        history=log.history,
    )


def _acceleration(log: Log) -> Array:
    steps = np.diff(log.t_s)
    if np.all(np.abs(steps / np.median(steps) - 1.0) <= SPACING_TOLERANCE):
        return derive_motion(log).acceleration_m_per_s2
    return np.asarray(np.gradient(np.gradient(log.position_m, log.t_s), log.t_s))
