"""What a count of successes says of their share."""

from __future__ import annotations

from scipy.special import betaincinv


def share_range(held: int, given: int) -> tuple[float, float]:
    """Return the 95 % range of a share, by Clopper and Pearson, where `held` of `given` held."""
    low = 0.0 if not held else float(betaincinv(held, given - held + 1, 0.025))
    high = 1.0 if held == given else float(betaincinv(held + 1, given - held, 0.975))
    return low, high
