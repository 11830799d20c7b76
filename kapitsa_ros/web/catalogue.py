"""What the page says, in the languages it is shipped in: English sentences are the names of all others."""

from __future__ import annotations

import html
import json
import re
from functools import cache
from pathlib import Path

_FOLDER = Path(__file__).parent / 'words'
ENGLISH = 'en'
_MARKED = re.compile(r'\[\[(.+?)\]\]', re.DOTALL)
"""A text of the page."""


@cache
def languages() -> tuple[str, ...]:
    """Return the languages that are shipped, English first."""
    return (ENGLISH, *sorted(path.stem for path in _FOLDER.glob('*.json')))


@cache
def words_of(language: str) -> dict[str, str]:
    """Return the sentences of a language by the English ones; none for English."""
    if language == ENGLISH:
        return {}
    words: dict[str, str] = json.loads((_FOLDER / f'{language}.json').read_text(encoding='utf-8'))
    return words


def choose_language(asked: str | None, accepted: str) -> str:
    """Return the language of a page.

    Parameters
    ----------
    asked
        By the link; None where it asks for none.
    accepted
        Header Accept-Language: what the browser prefers, weights not looked at, for browsers put the best first.

    """
    for wish in (asked or '', *accepted.split(',')):
        language = wish.partition(';')[0].strip().partition('-')[0].lower()
        if language in languages():
            return language
    return ENGLISH


def translated(page: str, language: str) -> str:
    """Return a page whose texts, marked by double brackets, are in a language."""
    words = words_of(language)
    return _MARKED.sub(lambda found: html.escape(words.get(found[1], found[1])), page)
