"""A sentence for the person at the bench."""

from __future__ import annotations

from typing import Any, Self


class Message(str):
    """A sentence in English, which knows what it was made of, so that it can be said in another language.

    Parameters
    ----------
    template
        Of `str.format`; it is what a catalogue of another language is asked for.
    values
        What it is filled with.

    """

    __slots__ = ('template', 'values')
    template: str
    values: dict[str, Any]

    def __new__(cls, template: str, **values: Any) -> Self:
        """Fill the template."""
        message = super().__new__(cls, template.format(**values) if values else template)
        message.template, message.values = template, values
        return message

    def said_by(self, words: dict[str, str]) -> str:
        """Return the sentence by a catalogue of English templates; in English where it lacks this one."""
        template = words.get(self.template, self.template)
        return template.format(**self.values) if self.values else template
