"""Formulas and scenarios are those of the example, which a user reads."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "examples" / "10_friction_under_vibration"))
