"""One open page: what is on its way to it, bounded whatever the page does."""

from __future__ import annotations

import asyncio
from collections import deque

_MOTIONS_KEPT = 30
"""Steps under way to a page; of one that reads too slowly the oldest are dropped."""


class PageClient:
    """Holds the newest text of each kind, and the last steps of the motion, until they are sent.

    Parameters
    ----------
    key
        By which the page is known again when it is loaded anew.
    load
        One loading of the page: by this it is known again after a lost link, of which the server may not know yet.
    language
        That it is told things in.

    """

    def __init__(self, key: str, load: str, language: str) -> None:
        self.key = key
        self.load = load
        self.language = language
        self._texts: dict[str, str] = {}
        self._told: dict[str, str] = {}
        self._motions: deque[bytes] = deque(maxlen=_MOTIONS_KEPT)
        self._filled = asyncio.Event()

    def tell(self, kind: str, text: str) -> None:
        """Send a text, in place of an older one of its kind; not again what was sent last."""
        if self._told.get(kind) != text:
            self._told[kind] = self._texts[kind] = text
            self._filled.set()

    def show(self, motion: bytes) -> None:
        """Send a step of the motion."""
        self._motions.append(motion)
        self._filled.set()

    async def next(self) -> list[str | bytes]:
        """Wait for something to send, and return it: texts first."""
        await self._filled.wait()
        self._filled.clear()
        frames: list[str | bytes] = [*self._texts.values(), *self._motions]
        self._texts.clear()
        self._motions.clear()
        return frames
