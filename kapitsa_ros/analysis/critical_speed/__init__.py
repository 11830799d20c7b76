"""The critical speed with its interval, from tables and from runs."""

from kapitsa_ros.analysis.critical_speed.budget import Budget, uncertainty_budget
from kapitsa_ros.analysis.critical_speed.direct_fit import CriticalSpeed, direct_fit
from kapitsa_ros.analysis.critical_speed.errors_in_variables import LineFit, errors_in_variables
from kapitsa_ros.analysis.critical_speed.from_motion import evidence_from_motion
from kapitsa_ros.analysis.critical_speed.timings_fit import TimingsFit, fit_timings
from kapitsa_ros.analysis.evidence import Bound, Evidence, evidence_of
from kapitsa_ros.analysis.ruler import Ruler, ruler_of

__all__ = [
    'Bound',
    'Budget',
    'CriticalSpeed',
    'Evidence',
    'LineFit',
    'Ruler',
    'TimingsFit',
    'direct_fit',
    'errors_in_variables',
    'evidence_from_motion',
    'evidence_of',
    'fit_timings',
    'ruler_of',
    'uncertainty_budget',
]
