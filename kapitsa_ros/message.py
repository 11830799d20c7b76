"""A sentence for a person, which can be said in another language."""

from __future__ import annotations

from typing import Any, Self


class Message(str):
    """A sentence in English, which knows what it was made of, so that it can be said in another language.

    Parameters
    ----------
    template
        Of `str.format`; it is what a catalogue of another language is asked for.
    values
        What it is filled with; other messages among them are said in the same language.

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
        values = {name: said_by(value, words) for name, value in self.values.items()}
        return template.format(**values) if values else template


def said_by(text: Any, words: dict[str, str]) -> Any:
    """Return a sentence by a catalogue; what does not know what it was made of stays as it is."""
    return text.said_by(words) if isinstance(text, Message) else text
