"""Warnings on bags, on stderr: which count twice, and what is missing or damaged in them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.recording.naming import repeats

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path


def warn(warning: str) -> None:
    """Print a warning."""
    click.echo(f'kapitsa: warning: {warning}', err=True)


def warn_of_repeats(bags: Sequence[Path]) -> None:
    """Say so where a bag is given twice: its readings count twice, and the interval is too narrow."""
    for warning in repeats(bags):
        warn(warning)


def warn_of_defects(runs: Iterable[Mapping[str, Any]]) -> None:
    """Say what is missing or damaged in bags, whose values these are."""
    for warning in dict.fromkeys(f'{run["bag"]}: {defect}' for run in runs for defect in run['defects']):
        warn(warning)
