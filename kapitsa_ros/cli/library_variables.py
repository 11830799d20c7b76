"""Variables of the environment that libraries read while they are loaded, and end in tracebacks over."""

from __future__ import annotations

import os
import re

from kapitsa_ros.errors import KapitsaError

_NEEDED: dict[str, tuple[str, str]] = {
    'NUMBA_CPU_FEATURES': (r'([+-][^,]+(,[+-][^,]+)*)?', 'names with + or - before each'),
    'NUMBA_NUM_THREADS': (r'0*[1-9]\d{0,8}', 'a number of threads, 1 or more'),
    'SOURCE_DATE_EPOCH': (r'\d{1,18}', 'whole seconds since 1970'),
}
"""By name, what a value looks like that can be used, and what it is."""


class VariableError(KapitsaError):
    """A variable of the environment has a value that a library cannot use."""


def check_library_variables() -> None:
    """Forget what nothing here needs, and see that the libraries can use the rest.

    Raises
    ------
    VariableError
        They cannot.

    """
    os.environ.pop('MPLBACKEND', None)  # of windows: we draw into files, and Jupyter's is not there without Jupyter
    for name, (pattern, what) in _NEEDED.items():
        given = os.environ.get(name)
        if given is not None and re.fullmatch(pattern, given, re.ASCII) is None:
            raise VariableError(f'{name}={given}: must be {what}; correct or unset it')
