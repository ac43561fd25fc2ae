"""What a face is told: numbers, regions, previews and the page."""

from cutis.report.numbers import Report, report
from cutis.report.regions import Regions

__all__ = ["Regions", "Report", "report"]
