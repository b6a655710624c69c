"""The code that was simulated, as code that runs elsewhere.

In come scenarios; out go folders of C99 and FMUs. No equations: the core records them.
"""

from __future__ import annotations

from breakaway.export.c_files import ExportedC, export_c
from breakaway.export.fmu import ExportedFmu, export_fmu

__all__ = ["ExportedC", "ExportedFmu", "export_c", "export_fmu"]
