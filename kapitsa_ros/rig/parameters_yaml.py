"""Parameters of nodes as YAML, as rcl reads it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import yaml

if TYPE_CHECKING:
    from collections.abc import Mapping


class _Dumper(yaml.SafeDumper):
    """Quotes every text: rcl takes more plain words for truth values and numbers (n, inf, 1e3) than PyYAML does."""


_Dumper.add_representer(str, lambda dumper, text: dumper.represent_scalar('tag:yaml.org,2002:str', text, style='"'))


def parameters_yaml(parameters: Mapping[str, Any]) -> str:
    """Return a parameter file that gives these to any node."""
    return yaml.dump({'/**': {'ros__parameters': dict(parameters)}}, Dumper=_Dumper, allow_unicode=True)
