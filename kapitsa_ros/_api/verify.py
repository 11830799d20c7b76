"""`verify`: recorded runs computed again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.laboratory.verification import verify_run
from kapitsa_ros.recording.naming import run_folders
from kapitsa_ros.recording.reader import runs_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kapitsa_ros.laboratory.verification import Verification
    from kapitsa_ros.recording.reader import RunBag


@dataclass(frozen=True, kw_only=True)
class VerifiedRun:
    """A recorded run, and what computing it again came to."""

    bag: RunBag
    verification: Verification

    @property
    def identical(self) -> bool:
        """Whether every message is the same."""
        return self.verification.identical


def verify(
    bags: str | Path | Sequence[str | Path],
    digest: str | None = None,
    *,
    graph: bool = False,
    on_progress: Callable[[dict[str, str]], None] | None = None,
) -> tuple[VerifiedRun, ...]:
    """Compute recorded runs again from their commands, settings and seed, and compare them message by message.

    Parameters
    ----------
    bags
        Folders of the runs, or folders that hold runs.
    digest
        What the digest of a run has to be, in hexadecimal; its bag is then needed for commands and settings only.
    graph
        Let the nodes do the runs again, instead of the same parts in this process.
    on_progress
        Called with what the nodes report.

    Returns
    -------
    tuple of VerifiedRun
        `.identical`, and `.verification` with the first difference.

    Raises
    ------
    KapitsaError
        A bag cannot be read, lacks a step, or its settings are of another version.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> [run.identical for run in kr.verify('bags')]
    [True, True, True]

    """
    paths = run_folders(Path(path) for path in ([bags] if isinstance(bags, str | Path) else bags))
    if not graph:
        return tuple(VerifiedRun(bag=bag, verification=verify_run(bag, digest)) for bag in runs_of(paths))
    from kapitsa_ros.rig.verification import verify_through_graph  # noqa: PLC0415  # rclpy takes its time

    progress = on_progress or (lambda _: None)
    return tuple(
        VerifiedRun(bag=bag, verification=verify_through_graph(bag, digest, progress)) for bag in runs_of(paths)
    )
