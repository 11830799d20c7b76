"""Which causes fit a table of readings, and which of them it cannot tell apart."""

from kapitsa_ros.analysis.explain.causes import CAUSES, Cause
from kapitsa_ros.analysis.explain.ranking import Explanation, OtherErrors, Ranking, explain, fit_cause

__all__ = ['CAUSES', 'Cause', 'Explanation', 'OtherErrors', 'Ranking', 'explain', 'fit_cause']
