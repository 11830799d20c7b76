"""Messages of one step come together whatever the order in which they arrive."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kapitsa_ros.nodes.errors import SequenceError
from kapitsa_ros.nodes.join import Join
from kapitsa_ros.physics.steps import Tick


def run(number: int, steps: int) -> list[Tick]:
    return [*(Tick(number, step) for step in range(steps)), Tick(number, steps, end=True)]


LEADING = run(1, 4) + run(2, 3) + run(2, 2)  # the last as when a bag is played twice
FOLLOWING = [*run(1, 4)[:-1], Tick(1, 4), Tick(1, 5), *run(2, 3), *run(2, 2)]  # ran two steps ahead of a reset
TOPICS = {'a': LEADING, 'b': LEADING, 'command': FOLLOWING}


def taken(order: list[str]) -> list[tuple[Tick, dict[str, bytes]]]:
    join = Join(('a', 'b'), ('command',))
    messages = {topic: iter(ticks) for topic, ticks in TOPICS.items()}
    steps = []
    for topic in order:
        tick = next(messages[topic])
        assert join.put(topic, tick, f'{topic} {tick}'.encode())
        while (step := join.take()) is not None:
            steps.append(step)
    return steps


IN_ORDER = list(itertools.chain.from_iterable([topic] * len(ticks) for topic, ticks in TOPICS.items()))


@given(st.permutations(IN_ORDER))
def test_the_order_of_arrival_changes_nothing(order: list[str]) -> None:
    steps = taken(order)
    assert steps == taken(IN_ORDER)
    assert [tick for tick, _ in steps] == LEADING
    for tick, messages in steps:
        assert set(messages) == ({'a', 'b'} if tick.end else {'a', 'b', 'command'})
        assert all(raw.decode() == f'{topic} {tick}' for topic, raw in messages.items())


def test_steps_seen_before_are_not_taken_twice() -> None:
    join = Join(('a',))
    assert join.put('a', Tick(1, 0), b'')
    assert join.put('a', Tick(1, 1), b'')
    assert not join.put('a', Tick(1, 1), b'again')
    assert not join.put('a', Tick(1, 0), b'again')


def test_a_missing_step_is_named() -> None:
    join = Join(('a',))
    join.put('a', Tick(1, 0), b'')
    with pytest.raises(SequenceError, match='gap on a: run 1 step 2 came after run 1 step 0'):
        join.put('a', Tick(1, 2), b'')


def test_whoever_comes_late_is_told_so() -> None:
    with pytest.raises(SequenceError, match='joined late'):
        Join(('a',)).put('a', Tick(1, 57), b'')


@given(st.integers(1, 10**6), st.integers(0, 10**9), st.booleans())
def test_numbers_come_back_from_their_text(number: int, step: int, end: bool) -> None:  # noqa: FBT001
    assert Tick.parse(str(Tick(number, step, end=end))) == Tick(number, step, end=end)


@pytest.mark.parametrize('text', ['', 'run 1', 'run -1 step 0', 'run 1 step 2 start', 'run 1 step x', 'run 1  step 0'])
def test_other_texts_are_no_numbers(text: str) -> None:
    with pytest.raises(ValueError, match='is not of the form'):
        Tick.parse(text)
