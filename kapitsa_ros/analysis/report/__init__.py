"""The report: one self-contained page, the rig's figures beside those of 1997; it needs the extra `report`."""

from kapitsa_ros.analysis.report.content import Content, gather
from kapitsa_ros.analysis.report.page import render

__all__ = ['Content', 'gather', 'render']
