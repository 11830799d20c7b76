"""One seed for an experiment, one independent stream of it for each instrument and run."""

from __future__ import annotations

import hashlib

import numpy as np

from kapitsa_ros.instruments.errors import InstrumentError


def random_stream(seed: int, instrument: str, run: int) -> np.random.Generator:
    """Open the random stream that belongs to one instrument in one run.

    The seed sequence and the bit generator are named outright, since numpy promises their bits for good, and not those
    of `default_rng`. (What `Generator` makes of the bits may change with a release of numpy: NEP 19.)

    Parameters
    ----------
    seed
        Seed of the experiment, 0 or more.
    instrument
        Name of the instrument, for instance ``'stopwatch'``.
    run
        Number of the run, 0 or more.

    Raises
    ------
    InstrumentError
        The seed or the run is negative.

    """
    if seed < 0 or run < 0:
        raise InstrumentError(f'seed {seed}, run {run}: neither may be negative')
    name = int.from_bytes(hashlib.blake2b(instrument.encode(), digest_size=8).digest(), 'little')
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(name, run))))
