"""An identified joint laid over a scenario."""

from __future__ import annotations

from pathlib import Path

from breakaway.base.arguments import check_arguments
from breakaway.errors import ScenarioError
from breakaway.measure.identification.joint_file import JointFile
from breakaway.measure.identification.result import Identification
from breakaway.model.scenario.laws import laws_with
from breakaway.model.scenario.scenario import Scenario


def lay_over(scenario: Scenario, joint: JointFile | Identification | str | Path) -> Scenario:
    """Lay an identified joint over a scenario, and the mass if the log determined it.

    What the log did not determine stays as in the scenario. Gains by pole placement are then
    designed for the identified joint; gains that are given stay.

    Parameters
    ----------
    scenario : Scenario
        What is changed; it stays as it is.
    joint : JointFile, Identification, str or Path
        The joint, or the path of its file.

    Returns
    -------
    Scenario
        The changed copy. Not checked: whether gains can be designed for it, which `resolve` finds.

    Raises
    ------
    ScenarioError
        The file is missing or not valid, the scenario's friction law has no place for a number of
        the joint, or the changed scenario is not valid: the joint and the field are named.
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

    """
    check_arguments(lay_over, locals(), ScenarioError)
    if isinstance(joint, str | Path):
        return lay_file_over(scenario, JointFile.load(joint), str(joint))
    if isinstance(joint, Identification):
        return lay_file_over(scenario, JointFile.from_identification(joint), "identification")
    return lay_file_over(scenario, joint, "joint file")


def lay_file_over(scenario: Scenario, joint: JointFile, name: str) -> Scenario:
    """Lay over what a joint file says.

    Raises
    ------
    ScenarioError
        As `lay_over`; the joint is called by ``name``.

    """
    changes = joint.scenario_changes()
    for path in changes:
        table, field = path.split(".")
        if field not in type(getattr(scenario, table)).model_fields:
            raise ScenarioError(
                f"{name}: sets {path}, which the scenario's law = {scenario.joint.law!r} does not "
                f"have; give the scenario a joint with law = {_law_for(changes)!r}"
            )
    try:
        return scenario.with_(changes)
    except ScenarioError as error:
        raise ScenarioError(f"{name} laid over {scenario.name}: {error}") from None


def _law_for(changes: dict[str, float]) -> str:
    """Give the first law that has a place for all of a joint's numbers."""
    numbers = {path.partition(".")[2] for path in changes if path.startswith("joint.")}
    return laws_with(numbers)[0]
