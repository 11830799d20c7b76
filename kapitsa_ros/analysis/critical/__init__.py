"""The critical speed with its interval, from tables and from runs."""

from kapitsa_ros.analysis.critical.direct import CriticalSpeed, direct_fit
from kapitsa_ros.analysis.critical.errors_in_variables import LineFit, errors_in_variables
from kapitsa_ros.analysis.critical.evidence import Bound, Evidence, Ruler, evidence_of

__all__ = ['Bound', 'CriticalSpeed', 'Evidence', 'LineFit', 'Ruler', 'direct_fit', 'errors_in_variables', 'evidence_of']
