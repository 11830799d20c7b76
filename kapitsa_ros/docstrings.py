"""Docstrings that are shown to users, who may have told Python to leave them out (-OO, PYTHONOPTIMIZE=2)."""

from __future__ import annotations

import ast
import inspect
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType


def docstring_of(owner: ModuleType | Callable[..., Any]) -> str:
    """Return the docstring of a module or a function, from its source where the interpreter has left it out."""
    if owner.__doc__ is not None:
        return owner.__doc__
    try:
        source = ast.parse(inspect.getsource(owner))
    except OSError:  # there is no source
        return ''
    found: Any = source if inspect.ismodule(owner) else source.body[0]
    return ast.get_docstring(found) or ''
