"""Simulated time, counted in communication steps.

Each run takes place on a day of its own: run n begins at n times 86,400 s. So no stamp is zero, stamps grow from run to
run, and the stamps of one run depend on nothing that happened in another.
"""

from __future__ import annotations

from dataclasses import dataclass

_DIGITS = 10
"""Of the largest number of a run or a step."""


@dataclass(frozen=True, slots=True)
class StepId:
    """The number of a message: one a topic and step."""

    run: int
    """Counts from 1; a reset begins the next."""
    step: int
    """Counts from 0 in each run."""
    end: bool = False
    """The run is over before this step: no data comes with it."""

    def __str__(self) -> str:
        """Return the form that travels in `header.frame_id`."""
        return f'run {self.run} step {self.step} end' if self.end else f'run {self.run} step {self.step}'

    @classmethod
    def parse(cls, text: str) -> StepId:
        """Read what `str` wrote.

        Raises
        ------
        ValueError
            The text is not the number of a step.

        """
        match text.split(' '):
            case ['run', run, 'step', step, *rest] if rest in ([], ['end']) and is_count(run) and is_count(step):
                return cls(int(run), int(step), end=bool(rest))
            case _:
                raise ValueError(f'{text!r} is not of the form "run 1 step 0"')

    def follows(self, last: StepId | None) -> bool:
        """Whether this number comes right after `last` (None: nothing was heard before)."""
        if last is None or last.end:
            return self.step == 0
        return self.run == last.run and self.step == last.step + 1


def is_count(text: str) -> bool:
    """Whether a text is a number that a run or a step can have."""
    return len(text) <= _DIGITS and text.isascii() and text.isdecimal()


def ends_session(step_id: StepId) -> bool:
    """Whether a number says that no run will follow: a run that ends before its first step."""
    return step_id.end and step_id.step == 0
