"""An identified joint laid over a scenario."""

from __future__ import annotations

from pathlib import Path
from typing import overload

from breakaway.base.arguments import check_arguments
from breakaway.design.pole_placement import residual_n
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import NO_PLACE, JointFile
from breakaway.measure.identification.result import Identification
from breakaway.model.scenario.joint_source import JointSource
from breakaway.model.scenario.laws import laws_with, values_under
from breakaway.model.scenario.population import PartPopulation
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.parts_overlay import lay_over_parts

Joints = JointFile | Identification | str | Path
"""What a joint is given as."""


@overload
def lay_over(scenario: Scenario, joint: Joints) -> Scenario: ...
@overload
def lay_over(scenario: PartPopulation, joint: Joints) -> PartPopulation: ...
def lay_over(
    scenario: Scenario | PartPopulation, joint: JointFile | Identification | str | Path
) -> Scenario | PartPopulation:
    """Lay an identified joint over a scenario, and the mass if the log determined it.

    Over a population: its parts become the joints that the file draws, each row of the draws one
    part; what the file has no draws of stays. What the file assumes varies there as well.

    The friction law of the fit comes along, and how friction differs with the direction. What the
    log did not determine stays as in the scenario. Friction that is left at the end of the guide,
    where the scenario does not state it, becomes the same share of the identified Coulomb friction
    as it was of the scenario's: the weight, which it would be, says nothing of a joint from another
    rig. The result's ``joint_source`` tells this, and what the log told that no scenario has a
    place for; so do the warnings of its runs. Gains by pole placement are then designed for the
    identified joint; gains that are given stay.

    Parameters
    ----------
    scenario : Scenario or PartPopulation
        What is changed; it stays as it is.
    joint : JointFile, Identification, str or Path
        The joint, or the path of its file.

    Returns
    -------
    Scenario or PartPopulation
        The changed copy. Not checked: whether gains can be designed for it, which `resolve` finds.

    Raises
    ------
    ScenarioError
        The file is missing or not valid, the scenario's friction law has no place for a number of
        the joint, or the changed scenario is not valid: the joint and the field are named. Or the
        file has no draws for a population.
    LogError
        The identification did not determine Coulomb friction, so there is no joint.

    Examples
    --------
    >>> import numpy as np
    >>> import breakaway as bk
    >>> t_s = np.arange(5000) / 1000.0
    >>> v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    >>> force_n = np.gradient(4 * v, t_s) + 30 * v + 60 * np.sign(v)
    >>> x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    >>> log = bk.Log(t_s=t_s, position_m=x, force_n=force_n)
    >>> joint = bk.JointFile.from_fit(bk.identify_inertia_friction(log), log)
    >>> scenario = bk.lay_over(bk.load_scenario("paper_as_computed"), joint)
    >>> round(scenario.joint.coulomb_n), scenario.joint.stiction_n, round(scenario.part.mass_kg)
    (60, 450.0, 4)
    >>> scenario.joint_source.residual
    '2.73 % of the identified coulomb_n, as in paper_as_computed (9.81 N of 360 N): ...'

    """
    check_arguments(lay_over, locals(), ScenarioError)
    if isinstance(joint, str | Path):
        file, name = JointFile.load(joint), str(joint)
    elif isinstance(joint, Identification):
        file, name = JointFile.from_identification(joint), "identification"
    else:
        file, name = joint, "joint file"
    if isinstance(scenario, PartPopulation):
        return lay_over_parts(scenario, file, name)
    return lay_file_over(scenario, file, name)


def lay_file_over(scenario: Scenario, joint: JointFile, name: str) -> Scenario:
    """Lay over what a joint file says.

    Raises
    ------
    ScenarioError
        As `lay_over`; the joint is called by ``name``.

    """
    changes = joint.scenario_changes()
    law = joint.joint.law or scenario.joint.law
    numbers = {path.removeprefix("joint."): n for path, n in changes.items() if "joint." in path}
    laws = laws_with(set(numbers))
    if law not in laws:
        lacking = next(one for one in numbers if law not in laws_with({one}))
        raise ScenarioError(
            f"{name}: sets joint.{lacking}, which the scenario's law = {law!r} does not have; give "
            f"the scenario a joint with law = {laws[0]!r}"
        )
    left_n, because = _residual(scenario, joint.joint.coulomb_n)
    source = JointSource(
        log=joint.provenance.log,
        residual=because,
        dropped="; ".join(
            f"{one} = {value:.5g} ({NO_PLACE[one]})" for one, value in joint.unplaced.items()
        ),
        at_least="; ".join(f"{field} ({why})" for field, why in joint.at_least.items()),
    )
    try:
        return scenario.with_(
            joint=values_under(law, scenario.joint, {**numbers, "residual_n": left_n}),
            part={"mass_kg": changes.get("part.mass_kg", scenario.part.mass_kg)},
            joint_source=source,
        )
    except ScenarioError as error:
        raise ScenarioError(f"{name} laid over {scenario.name}: {error}") from None


def _residual(scenario: Scenario, coulomb_n: float) -> tuple[float, str]:
    """Give the friction left at the end of the guide, in N, and why; nothing where it is stated."""
    own = scenario.joint
    if own.residual_n is not None:
        return own.residual_n, ""
    weight_n = residual_n(own, scenario.part.mass_kg)
    share = weight_n / own.coulomb_n
    return share * coulomb_n, (
        f"{100 * share:.3g} % of the identified coulomb_n, as in {scenario.name} ({weight_n:.4g} N "
        f"of {own.coulomb_n:.4g} N): a log does not tell it; joint.residual_n states it"
    )
