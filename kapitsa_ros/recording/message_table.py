"""The places of all messages of a bag, in a few bytes each."""

from __future__ import annotations

from array import array

from kapitsa_ros.recording.digest import SIZE


class MessageTable:
    """Places and digests of messages, numbered from 0 in the order of recording."""

    def __init__(self) -> None:
        self._files, self._blocks, self._places = array('i'), array('q'), array('q')
        self._digests = bytearray()

    def __len__(self) -> int:
        return len(self._files)

    def add(self, file: int, block: int, at: int, digest: bytes) -> int:
        """Note a message, and return its number."""
        self._files.append(file)
        self._blocks.append(block)
        self._places.append(at)
        self._digests += digest
        return len(self._files) - 1

    def place(self, message: int) -> tuple[int, int, int]:
        """Return the number of its file, and its place there."""
        return self._files[message], self._blocks[message], self._places[message]

    def digest(self, message: int) -> bytes:
        """Return the digest of a message."""
        return bytes(self._digests[message * SIZE : (message + 1) * SIZE])
