"""All open pages of a bench: one works it, the others watch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.web.errors import PageRequestError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.web.page_client import PageClient

MOST_PAGES = 16
RETURN = 3.0
"""Wall seconds for which the bench is kept for a page whose link was lost, before another may work it."""


class PageClients:
    """The pages in the order in which they came."""

    def __init__(self) -> None:
        self._pages: list[PageClient] = []
        self._at_work: PageClient | None = None
        """The page that works the bench."""
        self._key: str | None = None
        """Of that page, or of the last that did."""
        self._kept_until = 0.0
        """Wall time until which nobody else may work it."""

    def __iter__(self) -> Iterator[PageClient]:
        return iter(self._pages)

    def join(self, page: PageClient, now: float) -> None:
        """Take a page in, at a wall time.

        Raises
        ------
        PageRequestError
            There are too many already.

        """
        if len(self._pages) >= MOST_PAGES:
            raise PageRequestError('{most} pages are open at this bench already: close one', most=MOST_PAGES)
        self._pages.append(page)
        lost = self._at_work
        if lost is not None and (lost.key, lost.load) == (page.key, page.load):
            self._at_work = page  # that the other link is lost will be noticed later
        self.hand_on(now)

    def leave(self, page: PageClient, now: float) -> None:
        """Let a page go."""
        self._pages.remove(page)
        if page is self._at_work:
            self._at_work = None
            self._kept_until = now + RETURN if self._pages else now  # who comes to an empty bench need not wait
            self.hand_on(now)

    def hand_on(self, now: float) -> None:
        """Give the bench back to the page that worked it, or, where that did not come back, to the oldest."""
        if self._at_work is not None:
            return
        returned = [page for page in self._pages if page.key == self._key]
        candidates = returned or (self._pages if now >= self._kept_until else [])
        if candidates:
            self._at_work, self._key = candidates[0], candidates[0].key

    def works(self, page: PageClient) -> bool:
        """Whether a page works the bench; of two with one key (a tab that was doubled) the older one does."""
        return page is self._at_work
