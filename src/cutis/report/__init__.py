"""What a face is told: numbers, regions, previews and the page."""

from cutis.report.gathering import RunningReport, report
from cutis.report.numbers import Report
from cutis.report.regions import Regions

__all__ = ["Regions", "Report", "RunningReport", "report"]
