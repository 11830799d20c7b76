"""What a count of successes says of their share."""

from __future__ import annotations

from scipy.special import betaincinv


def share_range(held: int, given: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return the two-sided range of a share, by Clopper and Pearson, where `held` of `given` held."""
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if not held else float(betaincinv(held, given - held + 1, tail))
    high = 1.0 if held == given else float(betaincinv(held + 1, given - held, 1.0 - tail))
    return low, high
