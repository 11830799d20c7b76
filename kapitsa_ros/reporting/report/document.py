"""A document: its text in Markdown, and the figures that the text has places for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kapitsa_ros.file_name_text import encodable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawing:
    """A figure, and what the text says of it."""

    name: str
    """Of its file, without a path: the text has its place by it."""
    title: str
    caption: str
    figure: Figure


@dataclass(frozen=True, kw_only=True, eq=False)
class Document:
    """What can be written in every format."""

    title: str
    text: str
    """Markdown; a figure stands on a line of its own, under its drawing's name."""
    drawings: Sequence[Drawing]

    def __post_init__(self) -> None:
        object.__setattr__(self, 'text', encodable(self.text))  # it names files, and every format is UTF-8


def drawings_named(figures: Sequence[tuple[Figure, str]]) -> list[Drawing]:
    """Return drawings of figures and captions, in their order."""
    return [
        Drawing(name=f'figure_{index}.svg', title=figure.get_suptitle(), caption=caption, figure=figure)
        for index, (figure, caption) in enumerate(figures, start=1)
    ]
