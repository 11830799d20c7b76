import numpy as np
import pytest

from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.random_streams import random_stream


def bits(seed, instrument, run):
    return random_stream(seed, instrument, run).bit_generator.random_raw(4).tolist()


def test_same_seed_same_stream():
    assert bits(1, 'strobe', 2) == bits(1, 'strobe', 2)


def test_bits_are_those_of_every_other_day():
    # numpy promises them for good (NEP 19): they may not change with its version or the machine's
    assert bits(1, 'stopwatch', 0)[:2] == [11840911971371080365, 16966114754324336341]


def test_streams_differ_by_seed_instrument_and_run():
    seen = {tuple(bits(s, i, r)) for s in (0, 1, 2**40) for i in ('strobe', 'stopwatch') for r in (0, 1, 2)}
    assert len(seen) == 18


def test_streams_are_uncorrelated():
    draws = np.array(
        [random_stream(7, name, run).standard_normal(4000) for name in ('strobe', 'stopwatch') for run in (0, 1)]
    )
    correlation = np.corrcoef(draws) - np.eye(4)
    assert abs(correlation).max() < 5 / np.sqrt(4000)


@pytest.mark.parametrize(('seed', 'run'), [(-1, 0), (0, -1)])
def test_negative_numbers_are_refused(seed, run):
    with pytest.raises(InstrumentError, match='negative'):
        random_stream(seed, 'strobe', run)
