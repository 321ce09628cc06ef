"""Results as HTML: the report of a scenario, and how results show themselves in notebooks."""

from .page import report_page, write_report

__all__ = ["report_page", "write_report"]
