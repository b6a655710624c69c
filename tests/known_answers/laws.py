"""The contact of the example under the other friction laws."""

from vibrated_contact import DAMPED, LEVELS, RIGID, STIFFNESS_N_PER_M

import breakaway as bk

BRISTLE = {"stiffness_n_per_m": STIFFNESS_N_PER_M, "damping_n_s_per_m": 600.0}
LUGRE = bk.Lugre(**LEVELS, **BRISTLE)
GMS = bk.Gms(**LEVELS, **BRISTLE, attraction_n_per_s=1e7, elements=4)
TWO_REGION = bk.TwoRegion(
    **{name: value for name, value in LEVELS.items() if name != "stribeck_velocity_m_per_s"},
    **BRISTLE,
)
LAWS = [LUGRE, DAMPED, GMS, TWO_REGION, RIGID]
