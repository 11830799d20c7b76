"""How wide the screen is, where the environment says so."""

from __future__ import annotations

import os

NARROWEST = 20
"""Columns; what claims less does not know its width."""


def forget_useless_width() -> None:
    """Leave the width to the terminal, or to the usual 80 columns, where COLUMNS gives none that can hold a table."""
    text = os.environ.get('COLUMNS', '')
    if not (text.isdecimal() and int(text) >= NARROWEST):
        os.environ.pop('COLUMNS', None)
