"""Controller design: gains by pole placement, and what becomes of the closed loop."""

from __future__ import annotations

from breakaway.design.pole_placement import GainSet, PidGains, pole_placement
from breakaway.design.stability import LoopStability, Stability, stability

__all__ = ["GainSet", "LoopStability", "PidGains", "Stability", "pole_placement", "stability"]
