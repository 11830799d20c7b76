"""Reports, each in one file of HTML, Markdown or PDF; they need the extra `report`.

Of runs, beside those of 1997, of campaigns, and of classes.
"""

from kapitsa_ros.reporting.figures.canvas import house_style
from kapitsa_ros.reporting.report.campaign import campaign_document
from kapitsa_ros.reporting.report.class_document import class_document
from kapitsa_ros.reporting.report.content import Content, gather
from kapitsa_ros.reporting.report.document import Document
from kapitsa_ros.reporting.report.drawings import drawings_of
from kapitsa_ros.reporting.report.formats import WRITERS, as_html
from kapitsa_ros.reporting.report.text import report_text

__all__ = ['WRITERS', 'Content', 'as_html', 'campaign_document', 'class_document', 'gather', 'report_document']

TITLE = "Kapitsa's stable inverted pendulum"


def report_document(content: Content) -> Document:
    """Return the report on runs."""
    with house_style():
        drawings = drawings_of(content)
    return Document(title=TITLE, text=report_text(content, drawings), drawings=drawings)
