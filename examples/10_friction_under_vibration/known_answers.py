"""What a contact of Coulomb friction, rigid or elastic, does under vibration: known answers.

Friction is as a share of mu N_0. An elastic contact is Prandtl's element, a spring that carries at
most mu N; its yield deflection is mu N_0 / k. These models, and the numbers that decide, are those
of M. Popov, The influence of vibration on friction: a contact-mechanical perspective, Frontiers in
Mechanical Engineering 6:69, 2020.
"""

from math import acos, asin, cos, hypot, pi, sin, sqrt

from scipy.optimize import brentq
from scipy.special import ellipk


def tangential(speed: float) -> float:
    """Mean friction under vibration along the motion, rigid contact: ``(2 / pi) asin(v / v_a)``.

    Parameters
    ----------
    speed : float
        v / v_a, the mean velocity over the largest of the vibration.

    """
    return 2 / pi * asin(min(speed, 1.0))


def tangential_elastic(speed: float, softness: float) -> float:
    """Mean friction under vibration along the motion, elastic contact.

    With X(p) = s p + sin p the way of the part over the amplitude, s = v / v_a, the contact unloads
    from p_1 = pi - acos(s), where the part turns. If it goes back by less than 2 K, the contact is
    elastic until X is what it was, else it slips back and loads again after the part has turned
    anew. Derived here; at low speed it is ``1 - 1 / K``.

    Parameters
    ----------
    speed : float
        v / v_a.
    softness : float
        K, the yield deflection mu N / k_x over the amplitude of the vibration.

    """
    if speed >= 1.0:
        return 1.0

    def way(p: float) -> float:
        return speed * p + sin(p)

    def area(p: float) -> float:
        return speed * p * p / 2 - cos(p)

    turns, turns_again = pi - acos(speed), pi + acos(speed)
    if way(turns) - way(turns_again) <= 2 * softness:
        regained = brentq(lambda p: way(p) - way(turns), turns_again, turns + 2 * pi)
        missed = (way(turns) * (regained - turns) - area(regained) + area(turns)) / softness
        return 1 - missed / (2 * pi)
    slips = brentq(lambda p: way(turns) - way(p) - 2 * softness, turns, turns_again)
    caught = brentq(lambda p: way(p) - way(turns_again) - 2 * softness, turns_again, turns + 2 * pi)
    unloading = (way(turns) * (slips - turns) - area(slips) + area(turns)) / softness
    loading = (area(caught) - area(turns_again)) / softness
    loading -= way(turns_again) * (caught - turns_again) / softness
    forward = 2 * pi + turns - caught
    back = turns_again - slips
    total = forward - back + (slips - turns) - unloading - (caught - turns_again) + loading
    return total / (2 * pi)


def normal_static(amplitude: float) -> float:
    """Friction at low speed under vibration normal to the joint: what the lowest N holds.

    ``1 - a``, and none where the bodies part; the model is Popov's (2020).

    Parameters
    ----------
    amplitude : float
        a, the amplitude over the mean approach of the bodies, ``du_z / u_z0 = k_z du_z / N_0``.

    """
    return max(0.0, 1 - amplitude)


def normal(amplitude: float, speed: float) -> float:
    """Mean friction under vibration normal to the joint, elastic contact.

    With N = 1 - a cos p the contact slips while it can follow its level, sticks from p_1, where the
    level rises faster than the spring, ``sin p_1 = s``, and slips again where the spring has caught
    up. Bodies that part meet again at ``cos p = 1 / a``, their spring relaxed.

    Parameters
    ----------
    amplitude : float
        a = du_z / u_z0.
    speed : float
        s = v_0 k_x / (mu k_z w du_z); from 1 on, bodies that do not part never stick.

    """

    def level(p: float) -> float:
        return max(0.0, 1 - amplitude * cos(p))

    def area(p: float) -> float:
        return p - amplitude * sin(p)

    parted = acos(1 / amplitude) if amplitude > 1 else 0.0
    whole = area(2 * pi - parted) - area(parted)
    if speed >= 1.0:
        return whole / (2 * pi)
    sticks = max(asin(speed), parted)
    start, slope = level(sticks), amplitude * speed
    slips = brentq(
        lambda p: start + slope * (p - sticks) - level(p), pi - asin(speed), 2 * pi + sticks
    )
    stuck = slips - sticks
    spring = start * stuck + slope * stuck * stuck / 2
    missed = area(slips) - area(sticks) - spring
    return (whole - missed) / (2 * pi)


def transverse(speed: float) -> float:
    """Mean friction under vibration across the motion, rigid contact.

    The mean of ``v / sqrt(v**2 + v_y**2)``: ``(2 / pi) K(m) / sqrt(1 + x**2)`` with x = v_a / v,
    m = x**2 / (1 + x**2), K the complete elliptic integral: Storck, Littmann, Wallaschek and
    Mracek, Ultrasonics 40, 2002.

    Parameters
    ----------
    speed : float
        v / v_a, v_a the largest velocity of the vibration.

    """
    ratio = 1 / speed
    return float(2 / pi / sqrt(1 + ratio**2) * ellipk(ratio**2 / (1 + ratio**2)))


def transverse_static(softness: float) -> float:
    """Friction at low speed under vibration across the motion, elastic contact.

    ``sqrt(1 - 1 / K**2)``, and none where the vibration alone makes it slip.

    Parameters
    ----------
    softness : float
        K, the yield deflection mu N / k over the amplitude of the vibration.

    """
    return sqrt(max(0.0, 1 - 1 / softness**2))


def transverse_elastic(speed: float, softness: float) -> float:
    """Mean friction under vibration across the motion, elastic contact.

    Prandtl's element in a plane: the spring (z_x, z_y) follows the part, (s p, sin p), and where
    that makes it longer than K it slips along its own direction back to K. The model is Popov's
    (2020). Solved in small steps, and extrapolated to none.

    Parameters
    ----------
    speed : float
        s = v / v_a.
    softness : float
        K, the yield deflection mu N / k over the amplitude of the vibration.

    """
    coarse, fine = (_mean_along(speed, softness, steps) for steps in (10_000, 20_000))
    return 2 * fine - coarse


def _mean_along(speed: float, softness: float, steps: int) -> float:
    """Give the mean of z_x / K over the last of some cycles; at first z lies along the motion."""
    cycles = 4
    forward = 2 * pi / steps * speed
    x, y, total, before = softness, 0.0, 0.0, 0.0
    for n in range(1, cycles * steps + 1):
        across = sin(2 * pi * n / steps)
        x, y, before = x + forward, y + across - before, across
        length = hypot(x, y)
        if length > softness:
            x, y = x * softness / length, y * softness / length
        if n > (cycles - 1) * steps:
            total += x
    return total / (softness * steps)


def shakedown_amplitude(push: float) -> float:
    """Largest amplitude across the motion under which a part that is pushed comes to rest.

    ``u_y = (mu N / k) sqrt(1 - (F / mu N)**2)``, as a share of the yield deflection mu N / k: as
    far as the spring can go to and fro while it carries F along the motion. Wetter and Popov (Int.
    J. Solids Struct. 51, 2014) have such a limit for a rolling contact; this is one that slides.

    Parameters
    ----------
    push : float
        F / mu N, below 1.

    """
    return sqrt(1 - push**2)


def creep_per_cycle(push: float, amplitude: float) -> float:
    """How far a part under a constant push creeps in each cycle of vibration across the motion.

    As a share of mu N / k: ``4 (a - u_y) F / (mu N u_y)``, none for a <= u_y. In each half cycle
    the contact slips by 2 a - 2 u_y across, and its spring, which has the direction (F, mu N u_y),
    slips along itself. Derived here.

    Parameters
    ----------
    push : float
        F / mu N, below 1.
    amplitude : float
        a, the amplitude as a share of the yield deflection mu N / k.

    """
    limit = shakedown_amplitude(push)
    return max(0.0, 4 * (amplitude - limit) * push / limit)


def main() -> None:
    """Print what is left of friction over the speed, one column for each kind of vibration."""
    names = ("along, rigid", "K = 0.5", "across, rigid", "K = 0.5", "normal, a = 0.5", "a = 1")
    print(f"{'s':>5}" + "".join(f"{name:>17}" for name in names))
    for s in (0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0):
        along = tangential(s), tangential_elastic(s, 0.5)
        across = transverse(s), transverse_elastic(s, 0.5)
        shares = (*along, *across, normal(0.5, s), normal(1.0, s))
        print(f"{s:5.2f}" + "".join(f"{share:17.4f}" for share in shares))


if __name__ == "__main__":
    main()
