"""Messages of one step come together whatever the order in which they arrive."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kapitsa_ros.network.errors import SequenceError
from kapitsa_ros.network.step import Step
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.network.synchronizer import StepSynchronizer


def run(number: int, steps: int) -> list[StepId]:
    return [*(StepId(number, step) for step in range(steps)), StepId(number, steps, end=True)]


LEADING = run(1, 4) + run(2, 3) + run(2, 2)  # the last as when a bag is played twice
FOLLOWING = [*run(1, 4)[:-1], StepId(1, 4), StepId(1, 5), *run(2, 3), *run(2, 2)]  # ran two steps ahead of a reset
TOPICS = {'a': LEADING, 'b': LEADING, 'command': FOLLOWING}


def taken(order: list[str]) -> list[Step]:
    synchronizer = StepSynchronizer(('a', 'b'), ('command',))
    messages = {topic: iter(step_ids) for topic, step_ids in TOPICS.items()}
    steps = []
    for topic in order:
        step_id = next(messages[topic])
        assert synchronizer.put(topic, step_id, f'{topic} {step_id}'.encode())
        while (step := synchronizer.take()) is not None:
            steps.append(step)
    return steps


IN_ORDER = list(itertools.chain.from_iterable([topic] * len(step_ids) for topic, step_ids in TOPICS.items()))


@given(st.permutations(IN_ORDER))
def test_the_order_of_arrival_changes_nothing(order: list[str]) -> None:
    steps = taken(order)
    assert steps == taken(IN_ORDER)
    assert [step.id for step in steps] == LEADING
    for step in steps:
        assert set(step.raw) == ({'a', 'b'} if step.id.end else {'a', 'b', 'command'})
        assert all(raw.decode() == f'{topic} {step.id}' for topic, raw in step.raw.items())


def test_steps_seen_before_are_not_taken_twice() -> None:
    synchronizer = StepSynchronizer(('a',))
    assert synchronizer.put('a', StepId(1, 0), b'')
    assert synchronizer.put('a', StepId(1, 1), b'')
    assert not synchronizer.put('a', StepId(1, 1), b'again')
    assert not synchronizer.put('a', StepId(1, 0), b'again')


def test_a_missing_step_is_named() -> None:
    synchronizer = StepSynchronizer(('a',))
    synchronizer.put('a', StepId(1, 0), b'')
    with pytest.raises(SequenceError, match='gap on a: run 1 step 2 came after run 1 step 0'):
        synchronizer.put('a', StepId(1, 2), b'')


def test_whoever_comes_late_is_told_so() -> None:
    with pytest.raises(SequenceError, match='joined late'):
        StepSynchronizer(('a',)).put('a', StepId(1, 57), b'')


@given(st.integers(1, 10**6), st.integers(0, 10**9), st.booleans())
def test_numbers_come_back_from_their_text(number: int, step: int, end: bool) -> None:  # noqa: FBT001
    assert StepId.parse(str(StepId(number, step, end=end))) == StepId(number, step, end=end)


@pytest.mark.parametrize(
    'text',
    ['', 'run 1', 'run -1 step 0', 'run 1 step 2 start', 'run 1 step x', 'run 1  step 0', 'run \u0661 step 0'],
)
def test_other_texts_are_no_numbers(text: str) -> None:
    with pytest.raises(ValueError, match='is not of the form'):
        StepId.parse(text)
