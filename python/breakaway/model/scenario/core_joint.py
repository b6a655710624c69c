"""A joint under the names of the core."""

from __future__ import annotations

from typing import Any

from breakaway.model.scenario.joint import AnyJoint, ElastoPlastic, Gms


def core_joint(joint: AnyJoint) -> dict[str, Any]:
    """Give a joint as the core takes it, which needs its residual force.

    Examples
    --------
    >>> import breakaway as bk
    >>> core_joint(bk.resolve(bk.load_scenario("paper_as_computed")).joint)["law"]
    'lugre'

    """
    return nested_joint(joint, joint.model_dump())


def nested_joint(joint: AnyJoint, values: dict[str, Any]) -> dict[str, Any]:
    """Nest what the core nests: the laws that build on LuGre hold its numbers in a table."""
    leave_out_zero(values, "viscous_n_s_per_m")
    del values["drift"], values["normal_force"]  # the same for all laws: not the law's in the core
    if isinstance(joint, ElastoPlastic):
        own = {"elastic_share": values.pop("elastic_share")}
    elif isinstance(joint, Gms):
        del values["stiffness_shares"], values["level_shares"]
        own = {name: values.pop(name) for name in ("elements", "attraction_n_per_s")}
        own["stiffness_shares"], own["level_shares"] = joint.all_shares()
    else:
        return values
    return {"law": values.pop("law"), "friction": values, **own}


def leave_out_zero(values: dict[str, Any], name: str) -> None:
    """Say that there is none, where it is a number and zero: the core is faster without."""
    if isinstance(values.get(name), float) and values[name] == 0.0:
        values[name] = None
