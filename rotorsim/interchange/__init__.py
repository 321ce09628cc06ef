"""Coefficient tables for other programs, and from them.

Every file that is written states its frame and its signs: the load frame
(`rotorsim.table.variables.CONVENTIONS`) or that of ROSS (`rotorsim.interchange.conventions`).
"""

from .formats import FORMATS, is_table, read_table, write_table

__all__ = ["FORMATS", "is_table", "read_table", "write_table"]
