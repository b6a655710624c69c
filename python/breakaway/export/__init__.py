"""The code that was simulated, as code that runs elsewhere."""

from __future__ import annotations

from breakaway.export.c_files import ExportedC, export_c
from breakaway.export.fmu import ExportedFmu, export_fmu

__all__ = ["ExportedC", "ExportedFmu", "export_c", "export_fmu"]
