"""The address space that the shell allows: where it is too small, libraries hang or die in their own words."""

from __future__ import annotations

import resource

from kapitsa_ros.errors import FAILED, KapitsaError

MEGABYTE = 10**6
OF_A_COMMAND = 500 * MEGABYTE
"""What numpy, scipy and numba take while they are loaded; with less, OpenBLAS asks for ever, deaf to signals."""
OF_A_RIG = 1500 * MEGABYTE
"""What the process takes that nodes are forked from, and each of them with its threads."""


class AddressSpaceError(KapitsaError):
    """The process may not take the address space that it needs."""

    exit_status = FAILED


def refuse_small_address_space(need: int) -> None:
    """Check that the process may take so many bytes.

    Raises
    ------
    AddressSpaceError
        It may not.

    """
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY and allowed < need:
        raise AddressSpaceError(
            'the address space is limited to {allowed} MB, and {need} MB are needed: allow more, with ulimit -v',
            allowed=allowed // MEGABYTE,
            need=need // MEGABYTE,
        )
