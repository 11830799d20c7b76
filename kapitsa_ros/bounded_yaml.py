"""YAML from anybody: a document is read when it is of a size and depth that people and recorders write."""

from __future__ import annotations

from typing import Any

import yaml

_DEEPEST, _LARGEST = 40, 200_000
_MOST_DIGITS = 300
"""Of a whole number: longer ones become neither a float nor, in the end, a text."""
_BASE: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
"""That of libyaml is ten times as fast; not everybody has it."""


class _Loader(_BASE):  # type: ignore[misc]
    """Refuses a number that nothing can take, and a name that stands twice in a mapping.

    Of the values of such a name YAML would take the last without a word.
    """

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> Any:  # noqa: FBT001, FBT002  # yaml's own
        lines: dict[str, int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag == 'tag:yaml.org,2002:merge':
                continue
            line = key.start_mark.line + 1
            if key.value in lines:
                raise yaml.YAMLError(f'{key.value!r} stands twice, in lines {lines[key.value]} and {line}')
            lines[key.value] = line
        return super().construct_mapping(node, deep)

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        if len(node.value) > _MOST_DIGITS:
            line = node.start_mark.line + 1
            raise yaml.YAMLError(f'a whole number in line {line} has more than {_MOST_DIGITS} digits')
        number: int = super().construct_yaml_int(node)
        return number


_Loader.add_constructor('tag:yaml.org,2002:int', _Loader.construct_yaml_int)


class _TagBlindLoader(_Loader):
    """Takes what has a tag that nobody knows here for the mapping, sequence or scalar that it is."""


def _construct_untagged(loader: Any, _: str, node: yaml.Node) -> Any:
    if isinstance(node, yaml.MappingNode):
        return loader.construct_mapping(node, deep=True)
    if isinstance(node, yaml.SequenceNode):
        return loader.construct_sequence(node, deep=True)
    return loader.construct_scalar(node)


_TagBlindLoader.add_multi_constructor('', _construct_untagged)


def load_yaml(text: str, *, any_tag: bool = False) -> Any:
    """Return what a YAML document holds.

    Aliases count with all that they stand for: a few lines can stand for more than a memory holds.

    Parameters
    ----------
    text
        The document.
    any_tag
        Whether a tag that nobody knows is overlooked; else it is refused.

    Raises
    ------
    yaml.YAMLError
        The text is not YAML, or nests or repeats itself beyond what is read here.

    """
    _check_size(text)
    try:
        return yaml.load(text, Loader=_TagBlindLoader if any_tag else _Loader)  # noqa: S506 - safe ones
    except (ValueError, OverflowError, RecursionError) as error:  # a date or a number that there is not
        raise yaml.YAMLError(str(error)) from error


def _check_size(text: str) -> None:
    sizes: dict[str, int] = {}
    """By anchor: how many nodes it stands for."""
    open_nodes: list[tuple[str | None, int]] = []
    total = 0
    for event in yaml.parse(text, Loader=_BASE):
        if isinstance(event, yaml.AliasEvent):
            total += sizes.get(event.anchor or '', _LARGEST)  # within itself, it has no end
        elif isinstance(event, yaml.ScalarEvent):
            total += 1
            if event.anchor is not None:
                sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionStartEvent):
            total += 1
            open_nodes.append((event.anchor, total))
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_nodes.pop()
            if anchor is not None:
                sizes[anchor] = total - before + 1
        if len(open_nodes) > _DEEPEST:
            raise yaml.YAMLError(f'it nests deeper than {_DEEPEST} levels')
        if total > _LARGEST:
            raise yaml.YAMLError(f'it stands for more than {_LARGEST} values')
