"""A role in the graph: what a node reads and writes, whoever plays it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kapitsa_ros.network.topic import Topic


@dataclass(frozen=True, kw_only=True, eq=False)
class Role:
    """A node of the graph, by the name of its executable."""

    name: str
    reads: tuple[Topic[Any], ...] = ()
    """Numbered topics; the first that is not followed gives the stamp of a step."""
    writes: tuple[Topic[Any], ...] = ()
    follows: tuple[Topic[Any], ...] = ()
    """Those of `reads` whose writer may run ahead of the end of a run; see `StepSynchronizer`."""
    describes_run: bool = False
    """Whether its settings belong to a run: they are latched, recorded, and needed to analyse it."""
    kernels: bool = False
    """Whether its node runs compiled kernels: its module has `load_kernels`, which takes as long as all else."""
    optional: bool = False
    """Whether runs go without it: only nodes whose `expect` names it wait for it, and bags without it are read."""
