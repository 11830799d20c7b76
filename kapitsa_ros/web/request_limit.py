"""How many requests a page may send."""

from __future__ import annotations

REQUESTS_PER_SECOND = 50.0
"""On average; a person with a held key makes 30."""
BURST = 100.0
"""At once."""
MOST_REFUSED = 1000
"""Of a page that goes on without a pause; then it is cut off."""


class RequestLimit:
    """A token bucket: some requests a second on average, more for a moment.

    Parameters
    ----------
    now
        Wall time, s.

    """

    def __init__(self, now: float) -> None:
        self._left = BURST
        self._filled = now
        self.refused = 0
        """Since the page was last as quiet as it should be."""
        self._told = -1.0

    def allows(self, now: float) -> bool:
        """Count a request, and say whether it may be looked at."""
        self._left = min(BURST, self._left + (now - self._filled) * REQUESTS_PER_SECOND)
        self._filled = now
        if self._left >= BURST:
            self.refused = 0
        if self._left < 1.0:
            self.refused += 1
            return False
        self._left -= 1.0
        return True

    def is_to_be_told(self, now: float) -> bool:
        """Whether a refusal is to be said: once a second, however many there are."""
        if self._told >= 0.0 and now - self._told < 1.0:
            return False
        self._told = now
        return True

    @property
    def exhausted(self) -> bool:
        """Whether so many were refused that nobody listens there."""
        return self.refused >= MOST_REFUSED
