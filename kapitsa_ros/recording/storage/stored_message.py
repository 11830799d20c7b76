"""A message where it lies, and what every storage file offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray


class StoredMessage(NamedTuple):
    """A message of a storage file."""

    topic: str
    """Without the slash in front."""
    type: str
    """Such as `std_msgs/msg/Header`."""
    stamp_ns: int
    """When it was recorded, by the clock of the recorder."""
    block: int
    at: int
    """Its place: `StorageFile.read` finds it there again."""
    data: bytes


class StoredTable(NamedTuple):
    """Messages of one topic and one size that lie side by side."""

    topic: str
    type: str
    stamps_ns: NDArray[np.int64]
    """Shape (N,)."""
    data: NDArray[np.uint8]
    """Shape (N, bytes of a message)."""


class StorageFile(Protocol):
    """A file that messages were recorded to."""

    path: Path
    storage: str
    """`mcap` or `sqlite3`."""
    finished: bool
    """Whether its writer has closed it; known once it has been scanned."""
    metadata: str | None
    """The text of the metadata that the recorder has put into the file too; known once it has been scanned."""
    defects: list[str]
    """What is damaged; known once it has been scanned."""
    cut_off: str | None
    """How the file ends that was never closed; None: as it should. Known once it has been scanned."""

    def scan(self) -> Iterator[StoredMessage]:
        """Yield all messages that can be read, in the order of recording.

        Raises
        ------
        BagError
            It is not such a file at all.

        """

    def scan_tables(self) -> Iterator[StoredMessage | StoredTable]:
        """Yield the same, as tables where messages lie so."""

    def read(self, block: int, at: int) -> bytes:
        """Return the data of a message at its place."""

    def close(self) -> None:
        """Leave the file."""
