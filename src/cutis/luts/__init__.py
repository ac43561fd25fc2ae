"""Edits as look-up tables for other programs: .cube and .clf."""

from cutis.luts.export import export_lut
from cutis.luts.lut_files import write_clf, write_cube

__all__ = ["export_lut", "write_clf", "write_cube"]
