"""Names of files as text: on the disk they are bytes, which need not be UTF-8."""

from __future__ import annotations

import re

_CONTROL = re.compile('[\x00-\x1f\x7f-\x9f\u2028\u2029]')


def encodable(text: str) -> str:
    r"""Return a text that holds names of files, with bytes that are no UTF-8 written out, as `\xe9`."""
    try:
        raw = text.encode('utf-8', 'surrogateescape')
    except UnicodeEncodeError:  # half a sign, which no name of a file can bring in
        raw = text.encode('utf-8', 'backslashreplace')
    return raw.decode('utf-8', 'backslashreplace')


def shown_name(name: str) -> str:
    """Return the name of a file as it can be shown in a line."""
    return _CONTROL.sub(lambda found: found[0].encode('unicode_escape').decode(), encodable(name))
