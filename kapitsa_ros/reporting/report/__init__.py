"""The report: one self-contained page, the rig's figures beside those of 1997; it needs the extra `report`."""

from kapitsa_ros.reporting.report.content import Content, gather
from kapitsa_ros.reporting.report.page import render

__all__ = ['Content', 'gather', 'render']
