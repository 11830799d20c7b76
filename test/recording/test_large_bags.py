"""A bag larger than the memory that reading it may take."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bag_of_a_made_up_run import CLOCK, step_messages, write

from kapitsa_ros.network.cdr import decode_block, encode_block
from kapitsa_ros.network.registry import MOTION, PIVOT
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.recording.motion import joined_motion
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.writer import RunWriter

GB = 10**9
SHIPPED = Path(__file__).parents[2] / 'bags' / 'run_01_2240rpm'
PEAK = """
import json, sys
from pathlib import Path

def peak():
    '''kB; what getrusage tells begins with the memory of the parent.'''
    lines = Path('/proc/self/status').read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith('VmHWM:'))

"""
READING = """
from kapitsa_ros.recording.reader import RunBag
before = peak()
bag = RunBag(sys.argv[1])
run, samples, lost = bag.run, 0, 0.0
for piece in bag.motion_in_pieces(steps=20):
    samples, lost = samples + piece.angle.size - 1, lost + piece.lost
print(json.dumps([before, peak(), bag.steps, run.complete, bag.integrity.ok, samples, lost, list(bag.defects)]))
"""
ANALYSIS = """
from kapitsa_ros.laboratory.bag_analysis import analyse_bags
[run] = analyse_bags([Path(sys.argv[1])])['runs']
print(json.dumps([peak(), run['samples'], run['gaps'], run['digest_ok'], run['period_s'], run['defects']]))
"""


def record(path: Path, size: int, samples: int, storage: str = 'sqlite3') -> int:
    """Record a run whose steps repeat until there are so many bytes of messages; return their number."""
    writer = RunWriter(path, storage, RunBag(SHIPPED).settings_texts, 5, compression='none')
    first = step_messages(StepId(1, 0), samples)
    blocks = {topic.name: decode_block(first[topic.name]) for topic in (PIVOT, MOTION)}
    steps = size // sum(map(len, first.values()))
    for step in range(steps):
        number = StepId(1, step)
        stamp = CLOCK.start_ns(number)
        moving = {name: encode_block(stamp, number, block) for name, block in blocks.items() if block is not None}
        writer.write_step(stamp, step_messages(number, 2) | moving)
    end = StepId(1, steps, end=True)
    writer.write_step(CLOCK.start_ns(end), step_messages(end))
    writer.close(complete=True)
    return steps


def said_by(program: str, path: Path) -> list[object]:
    done = subprocess.run([sys.executable, '-c', PEAK + program, str(path)], capture_output=True, text=True, check=True)
    values: list[object] = json.loads(done.stdout)
    return values


@pytest.mark.slow
@pytest.mark.parametrize(('storage', 'samples'), [('mcap', 200), ('sqlite3', 1000)])
def test_ten_gigabytes_are_analysed_in_less_than_one(tmp_path: Path, storage: str, samples: int) -> None:
    """As `kapitsa analyse` does it; with 2 kHz, and with larger blocks."""
    if shutil.disk_usage(tmp_path).free < 25 * GB:
        pytest.skip('needs 25 GB of disk')
    try:
        steps = record(tmp_path / 'run', 10 * GB, samples, storage)
        assert max(path.stat().st_size for path in (tmp_path / 'run').iterdir()) > 10 * GB
        after, *found = said_by(ANALYSIS, tmp_path / 'run')
        print('10 GB:', steps, 'steps,', after, 'kB')  # noqa: T201 - the figure
    finally:
        shutil.rmtree(tmp_path / 'run')
    assert found == [samples * steps + 1, 0, True, 0.5, []]
    assert isinstance(after, int)
    assert after * 1024 < GB


@pytest.mark.parametrize('leave_out', [None, 4, 6])
def test_samples_are_counted_in_pieces(tmp_path: Path, leave_out: int | None) -> None:
    bag = RunBag(write(tmp_path / 'run', leave_out=leave_out))
    pieces = bag.motion_in_pieces
    bag.motion_in_pieces = lambda steps: pieces(min(steps, 4))  # type: ignore[method-assign]
    assert bag.motion_counts == (bag.motion.angle.size, bag.motion.gaps)


@pytest.mark.parametrize('late_from', [3, 4])
def test_a_gap_that_no_number_tells_of_counts_where_pieces_meet_too(late_from: int) -> None:
    """Two pieces of four blocks, the second of which begins with block 4."""
    still = SampledMotion(1e-3, *np.zeros((3, 101)))
    late = [500_000_000 if number >= late_from else 0 for number in range(8)]
    blocks = [(number, number * 100_000_000 + late[number], still) for number in range(8)]
    whole, first = joined_motion(blocks), joined_motion(blocks[:4])
    second = joined_motion(blocks[4:], int(first.stamps_ns[-1]))
    assert first.gaps + second.gaps == whole.gaps == 1
    assert first.lost + second.lost == pytest.approx(whole.lost, abs=1e-9)


def test_pieces_make_the_motion(tmp_path: Path) -> None:
    """A step is lost where a piece ends, and one within a piece."""
    for left_out in (None, 4, 6):
        bag = RunBag(write(tmp_path / f'run_{left_out}', leave_out=left_out))
        whole, pieces = bag.motion, list(bag.motion_in_pieces(steps=4))
        assert len(pieces) == 3
        rest = [piece.angle[0 if left_out == 4 and number == 1 else 1 :] for number, piece in enumerate(pieces[1:], 1)]
        assert np.concatenate([pieces[0].angle, *rest]).tobytes() == whole.angle.tobytes()
        assert sum(piece.gaps for piece in pieces) == whole.gaps == (left_out is not None)
        assert sum(piece.lost for piece in pieces) == pytest.approx(whole.lost, abs=1e-9)


def test_memory_grows_by_the_message_and_not_by_the_byte(tmp_path: Path) -> None:
    """Fifty times as many bytes in as many messages: what is unpacked is not kept, but for a few chunks."""
    costs = []
    for samples, size in ((40, 1_400_000), (2000, 70_000_000)):
        path = tmp_path / f'{samples}'
        record(path, size, samples)
        before, after, *_ = said_by(READING, path)
        assert isinstance(before, int)
        assert isinstance(after, int)
        costs.append(1024 * (after - before))
    assert costs[1] - costs[0] < 20_000_000
