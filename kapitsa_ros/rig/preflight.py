"""Checks before a rig starts: what cannot work is refused before a node runs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from kapitsa_ros.address_space import OF_A_RIG, refuse_small_address_space
from kapitsa_ros.errors import OPTION
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.physics.jigsaw_parameters import MAX_SPEED
from kapitsa_ros.recording.naming import refuse_existing
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.setup import parameters
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from kapitsa_ros.rig.setup import Setup


def prepare(setup: Setup) -> None:
    """Make the folder for the bags, after a look at what the protocol asks for.

    Raises
    ------
    AddressSpaceError
        The shell allows less memory than nodes take.
    UsageError
        The folder for the bags cannot be written, or the jigsaw cannot turn so fast.
    BagError
        A run of that name is there already.
    ProtocolError
        There is no such protocol.

    """
    refuse_small_address_space(OF_A_RIG)
    # A manual run begins with the shaft at rest.
    speeds = (0.0,) if setup.protocol == MANUAL else setup.carried_out().speeds
    for speed in speeds:
        if speed > MAX_SPEED:
            raise UsageError(
                f'{OPTION} wants {speed / RPM:.0f} RPM: the jigsaw does {MAX_SPEED / RPM:.0f} RPM at most',
                option='protocol',
            )
    refuse_unspeakable(parameters(setup))
    refuse_existing(setup.bags, speeds)
    make_writable(setup.bags)


def refuse_unspeakable(values: Mapping[str, Any]) -> None:
    """Check that parameters can be told to nodes.

    Raises
    ------
    UsageError
        One holds a name that is no UTF-8.

    """
    for name, value in values.items():
        for text in [value] if isinstance(value, str) else value if isinstance(value, list) else ():
            try:
                str(text).encode()
            except UnicodeEncodeError as error:
                shown = str(text).encode(errors='surrogateescape').decode(errors='backslashreplace')
                raise UsageError(
                    f'{OPTION}: no UTF-8, and nodes can be told nothing else; give another name',
                    option=name,
                    value=shown,
                ) from error


def make_writable(folder: Path) -> None:
    """Make the folder for the bags.

    Raises
    ------
    UsageError
        It cannot be made, or not be written.

    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:  # a name with a null byte is none
        why = error.strerror if isinstance(error, OSError) else error
        raise UsageError(
            f'{OPTION}: cannot be made ({why}); give a folder you can write to', option='bags', value=folder
        ) from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UsageError(f'{OPTION}: cannot be written; give a folder you can write to', option='bags', value=folder)
