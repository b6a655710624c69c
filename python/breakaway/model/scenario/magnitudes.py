"""Ranges of the numbers of parts and rigs, by quantity.

Their upper ends are far beyond any part: a larger number is a slip of the pen, or of the unit.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

Mass = Annotated[float, Field(gt=0.0, le=1e6)]
"""In kg."""
Length = Annotated[float, Field(gt=0.0, le=1e9)]
"""In m; 1e9 is a guide without an end."""
LengthOrZero = Annotated[float, Field(ge=0.0, le=1e9)]
"""In m."""
Duration = Annotated[float, Field(gt=0.0, le=1e6)]
"""In s."""
DurationOrZero = Annotated[float, Field(ge=0.0, le=1e6)]
"""In s."""
Speed = Annotated[float, Field(gt=0.0, le=1e6)]
"""In m/s."""
Acceleration = Annotated[float, Field(gt=0.0, le=1e7)]
"""In m/s^2."""
Force = Annotated[float, Field(gt=0.0, le=1e9)]
"""In N."""
ForceOrZero = Annotated[float, Field(ge=0.0, le=1e9)]
"""In N."""
ForceRate = Annotated[float, Field(gt=0.0, le=1e15)]
"""In N/s."""
Stiffness = Annotated[float, Field(gt=0.0, le=1e12)]
"""In N/m."""
Damping = Annotated[float, Field(ge=0.0, le=1e12)]
"""In N s/m."""
Frequency = Annotated[float, Field(gt=0.0, le=1e9)]
"""In Hz."""
