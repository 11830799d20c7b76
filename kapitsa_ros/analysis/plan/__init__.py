"""What to measure next: the cheapest protocol for an aim, and the measurement that decides between two causes."""

from kapitsa_ros.analysis.plan.cheapest import Plan, cheapest_plan
from kapitsa_ros.analysis.plan.separation import Separation, best_separation

__all__ = ['Plan', 'Separation', 'best_separation', 'cheapest_plan']
