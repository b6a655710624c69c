"""Friction under vibration: what formulas say, and what scenarios give."""

from collections.abc import Iterator

from vibrated_contact import (
    DAMPED,
    ELASTIC,
    RIGID,
    across,
    along,
    creep,
    mean_friction,
    pressed,
    pushed,
    shaken_across,
    shaken_normal,
    sprung,
    static_friction,
)

import known_answers as known

Row = tuple[str, str, float, float]
"""What, its dimensionless numbers, what the formula says, what the simulation gives."""
RIGID_ENOUGH = 0.005
"""K of an elastic contact whose springs are short beside the vibration."""


def along_the_motion() -> Iterator[Row]:
    """Mean friction of a part that moves to and fro."""
    what = "along, sliding"
    for s in (0.1, 0.5, 0.9):
        yield what, f"s = {s}, rigid", known.tangential(s), mean_friction(along(RIGID, s, 0.5))
    for s, k in ((0.1, 1.5), (0.5, 0.2), (0.5, 2.0)):
        found = mean_friction(along(ELASTIC, s, k))
        yield what, f"s = {s}, K = {k}", known.tangential_elastic(s, k), found


def normal_to_the_joint() -> Iterator[Row]:
    """Static and mean sliding friction of a part whose normal force vibrates."""
    for a in (0.2, 0.6, 0.9):
        found = static_friction(shaken_normal(RIGID, a))
        yield "normal, static", f"a = {a}", known.normal_static(a), found
    for a, s in ((0.6, 0.1), (0.6, 0.3), (0.6, 0.9), (1.5, 0.3)):
        found = mean_friction(pressed(a, s))
        yield "normal, sliding, bristle", f"a = {a}, s = {s}", known.normal(a, s), found
    for a, s in ((0.6, 0.1), (0.6, 0.3), (0.6, 0.9)):
        found = mean_friction(sprung(a, s))
        yield "normal, sliding, soft axis", f"a = {a}, s = {s}", known.normal(a, s), found


def across_the_motion() -> Iterator[Row]:
    """Static and mean sliding friction of a part that also moves across."""
    for k in (1.2, 2.0, 4.0):
        found = static_friction(shaken_across(DAMPED, 1 / k))
        yield "across, static", f"K = {k}", known.transverse_static(k), found
    for s in (0.3, 0.7, 1.5):
        found = mean_friction(across(s, RIGID_ENOUGH))
        yield "across, sliding", f"s = {s}, rigid", known.transverse(s), found
    for s, k in ((0.3, 0.4), (0.5, 2.0), (0.9, 0.3)):
        found = mean_friction(across(s, k))
        yield "across, sliding", f"s = {s}, K = {k}", known.transverse_elastic(s, k), found


def ratcheting() -> Iterator[Row]:
    """Creep in a cycle under a push below the friction, in yield deflections."""
    for push, a in ((0.6, 0.79), (0.6, 1.0), (0.6, 3.0), (0.3, 2.0)):
        found = creep(pushed(shaken_across(DAMPED, a), push))
        yield "across, creep", f"F = {push}, 1/K = {a}", known.creep_per_cycle(push, a), found


def main() -> None:
    """Print the table."""
    print(f"{'vibration':27} {'numbers':28} {'formula':>9} {'simulated':>10} {'difference':>11}")
    for kind in (along_the_motion, normal_to_the_joint, across_the_motion, ratcheting):
        for what, numbers, formula, found in kind():
            off = f"{found / formula - 1:11.1e}" if formula else f"{found:11.1e}"
            print(f"{what:27} {numbers:28} {formula:9.5f} {found:10.5f} {off}")


if __name__ == "__main__":
    main()
