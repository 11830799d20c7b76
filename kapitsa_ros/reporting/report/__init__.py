"""The report: these runs beside those of 1997, in one file of HTML, Markdown or PDF; it needs the extra `report`."""

from kapitsa_ros.reporting.report.content import Content, gather
from kapitsa_ros.reporting.report.formats import WRITERS, as_html

__all__ = ['WRITERS', 'Content', 'as_html', 'gather']
