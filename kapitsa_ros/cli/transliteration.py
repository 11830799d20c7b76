"""Signs that a terminal cannot show, written out: λ as lambda, ² as ^2."""

from __future__ import annotations

import codecs
import sys
import unicodedata

NAME = 'kapitsa_transliterate'
_WRITTEN = {
    '−': '-', '–': '-', '′': "'", '″': "''", '·': '*', '±': '+/-', '√': 'sqrt', '→': '->', '←': '<-', '…': '...',
    '≫': '>>', '≤': '<=', '≥': '>=', '×': 'x', '∞': 'inf', '½': '1/2', '°': 'deg', 'µ': 'u', '\xa0': ' ',
    '²': '^2', '³': '^3',
}  # fmt: skip


def transliterate(text: str) -> str:
    """Return a text in ASCII; a sign that is not known is written as its number."""
    return ''.join(map(_ascii, text))


def _ascii(sign: str) -> str:
    if sign.isascii():
        return sign
    if sign in _WRITTEN:
        return _WRITTEN[sign]
    name = unicodedata.name(sign, '')
    if name.startswith('GREEK'):  # as GREEK CAPITAL LETTER OMEGA
        letter = name.split('WITH')[0].split()[-1].lower().replace('lamda', 'lambda')  # Unicode's spelling
        return letter.capitalize() if 'CAPITAL' in name else letter
    plain = unicodedata.normalize('NFKD', sign).encode('ascii', 'ignore').decode()
    return plain or sign.encode('ascii', 'backslashreplace').decode()


def showable(text: str, encoding: str) -> str:
    """Return a text in which the signs that an encoding lacks are written out."""
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return ''.join(sign if _is_known(sign, encoding) else _ascii(sign) for sign in text)
    return text


def _is_known(sign: str, encoding: str) -> bool:
    try:
        sign.encode(encoding)
    except UnicodeEncodeError:
        return False
    return True


def write_out_unknown_signs() -> None:
    """Let stdout and stderr write out what their encoding lacks, instead of failing."""
    codecs.register_error(NAME, _handle)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, 'reconfigure'):
            stream.reconfigure(errors=NAME)


def _handle(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return transliterate(error.object[error.start : error.end]), error.end
