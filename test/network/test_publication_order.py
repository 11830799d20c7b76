"""Whose message it is, told from two counts that go on together."""

import pytest

from kapitsa_ros.network.publication_order import Provenance, PublicationOrder
from kapitsa_ros.network.step_id import StepId

OWN, FOREIGN, CONTESTED = Provenance.OWN, Provenance.FOREIGN, Provenance.CONTESTED


def after(steps: int, *, alone: bool = True) -> PublicationOrder:
    """Return the order after some steps of run 1, each the writer's next publication; then `alone` is as given."""
    order = PublicationOrder(lambda: order.alone)
    order.alone = True
    for step in range(steps):
        assert order.classify(step + 1, StepId(1, step)) is OWN
    order.alone = alone
    if not alone:
        order.note_another()
    return order


def test_one_writer_is_heard_over_runs_and_their_ends() -> None:
    order = after(3)
    numbers = [StepId(1, 3), StepId(1, 4, end=True), StepId(2, 0), StepId(2, 1), StepId(3, 0), StepId(4, 0, end=True)]
    assert [order.classify(number, step) for number, step in enumerate(numbers, 4)] == [OWN] * 6


@pytest.mark.parametrize('publication', [1, 2, 3, 9, 50, 1000])
@pytest.mark.parametrize('step', [StepId(1, 7), StepId(1, 10), StepId(1, 12), StepId(1, 10, end=True), StepId(2, 0)])
def test_a_stranger_that_counts_its_own_publications_changes_nothing(publication: int, step: StepId) -> None:
    order = after(10, alone=False)
    assert order.classify(publication, step) is FOREIGN
    assert order.classify(11, StepId(1, 10)) is OWN


def test_a_stranger_that_was_believed_is_found_when_the_writer_speaks() -> None:
    order = after(10, alone=False)
    assert order.classify(11, StepId(1, 10)) is OWN
    assert order.classify(12, StepId(1, 11)) is OWN
    assert order.classify(11, StepId(1, 10)) is CONTESTED


def test_a_stranger_whose_message_came_before_the_news_of_it_is_found_too() -> None:
    """It was believed: what the writer said in its place was refused without a word."""
    order = after(10)
    assert order.classify(11, StepId(1, 10)) is OWN
    order.note_another()
    assert order.classify(11, StepId(1, 10)) is CONTESTED


def test_a_stranger_is_found_by_its_messages_alone_where_the_news_of_it_is_late() -> None:
    """Both had spoken before the match event was heard: the stranger was believed, and the writer refused."""
    order = after(10)
    assert order.classify(11, StepId(1, 10)) is OWN
    assert not order.knows_another
    assert order.classify(11, StepId(1, 10)) is CONTESTED
    assert order.knows_another


def test_a_stranger_that_said_what_cannot_be_read_first_is_found_by_that() -> None:
    order = after(10)
    order.note_unreadable(10)
    assert [order.classify(number + 1, StepId(1, number)) for number in (10, 11)] == [OWN] * 2
    assert order.classify(11, StepId(1, 10)) is CONTESTED


def test_a_stranger_that_has_left_before_anyone_looked_is_found_too() -> None:
    """It had counted on far enough, and the graph shows one writer again."""
    order = after(10)
    assert order.classify(500, StepId(1, 10)) is OWN
    assert order.classify(11, StepId(1, 10)) is CONTESTED


def test_what_was_taken_before_the_stranger_came_is_beyond_doubt() -> None:
    order = after(10, alone=False)
    assert order.classify(11, StepId(1, 10)) is OWN
    assert order.classify(5, StepId(1, 4)) is FOREIGN
    assert order.classify(11, StepId(1, 10)) is CONTESTED


def test_who_was_there_before_the_writer_and_was_believed_is_found_when_the_writer_speaks() -> None:
    """A stranger had spoken and left when its reader began to listen, and the writer had come."""
    order = after(0)
    order.note_another()
    assert [order.classify(number + 1, StepId(1, number)) for number in range(60)] == [OWN] * 60
    assert order.classify(1, StepId(1, 0)) is CONTESTED


def test_the_first_step_of_all_tells_nobody_from_another() -> None:
    order = after(0)
    assert order.classify(1, StepId(1, 0)) is OWN
    order.alone = False
    assert order.classify(1, StepId(1, 0)) is CONTESTED
    assert after(0, alone=False).classify(1, StepId(1, 0)) is CONTESTED


@pytest.mark.parametrize('step', [0, 17, 58])
@pytest.mark.parametrize('alone', [True, False])
def test_who_has_published_something_else_before_is_not_the_writer(step: int, *, alone: bool) -> None:
    """A stranger has left, and one of its last messages is read when the writer is the only one there."""
    order = after(0, alone=alone)
    assert order.classify(step + 4, StepId(1, step)) is FOREIGN
    order.alone = True
    assert order.classify(1, StepId(1, 0)) is OWN


def test_the_writers_own_repetitions_and_idle_words_are_its_own() -> None:
    order = after(2)
    assert order.classify(3, StepId(1, 1)) is OWN
    assert order.classify(5, StepId(1, 2)) is OWN
    assert order.classify(6, StepId(1, 3)) is OWN


def test_a_gap_of_the_only_writer_is_left_to_who_looks_for_gaps() -> None:
    assert after(2).classify(9, StepId(1, 8)) is OWN
    assert after(0).classify(40, StepId(1, 39)) is OWN


def test_where_the_middleware_counts_nothing_everything_is_taken() -> None:
    assert after(2, alone=False).classify(None, StepId(1, 2)) is OWN
