"""A new interpreter that runs a module of this package."""

from __future__ import annotations

import sys


def run_by_new_interpreter(module: str, *arguments: str) -> list[str]:
    """Return the command; the interpreter looks for modules where this one does.

    Of itself it would look into the current folder first, where a user's file may be called as a module is.
    """
    path = [each for each in sys.path if isinstance(each, str)]
    begin = f'import sys; sys.path[:] = {path!a}; from runpy import run_module'
    return [sys.executable, '-P', '-c', f'{begin}; run_module({module!r}, None, "__main__", True)', *arguments]
