"""The bench's terminal application: key bindings in, panels out."""

from __future__ import annotations

import asyncio
import signal
import time
from typing import TYPE_CHECKING, ClassVar

from textual.app import App, ComposeResult
from textual.containers import Horizontal, Vertical
from textual.message import Message
from textual.widgets import Footer, Input, Static

from kapitsa_ros.bench import panels
from kapitsa_ros.bench.bench_controls import PATIENCE, BenchControls
from kapitsa_ros.bench.help_screen import HelpScreen
from kapitsa_ros.bench.help_text import help_text
from kapitsa_ros.bench.keys import KEYS
from kapitsa_ros.errors import said_of
from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.units import RPM, parse_angle, parse_speed

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.text import Text
    from textual import events
    from textual.binding import BindingType

    from kapitsa_ros.bench.bench_state import BenchState
    from kapitsa_ros.rig.harness import Rig

WIDTH, HEIGHT = 80, 24
"""Smallest terminal, characters."""
_FRAME_RATE = 20.0
"""Hz."""
_QUESTIONS = {
    'speed': 'speed of the shaft (2240, 37.3Hz, 234rad/s): ',
    'dial': 'dial of the lamp, flashes a minute (4480, 75Hz): ',
    'angle': 'release angle (0.12, 7deg): ',
}


class _Callback(Message):
    """A call for the screen's own thread, posted from another one."""

    def __init__(self, act: Callable[[], None]) -> None:
        super().__init__()
        self.act = act


class BenchApp(App[RigError]):
    """The bench; it returns the error of a rig that died.

    Parameters
    ----------
    rig
        Started with the protocol `manual`; the screen alone uses it while it runs.
    state
        Of this rig's bench.
    title
        What is on the bench.

    """

    ENABLE_COMMAND_PALETTE = False
    AUTO_FOCUS = None
    CSS = """
    #bench { height: 1fr; }
    #status { height: 1; background: $primary-background; }
    #seen { height: 1fr; }
    #read { height: 8; }
    #rod, #marks, #knobs, #own-readings, #rig-readings { border: round $primary; padding: 0 1; height: 100%; }
    #rod { width: 1fr; }
    #marks { width: 22; }
    #knobs { width: 36; }
    #own-readings { width: 36; }
    #rig-readings { width: 1fr; }
    #messages { height: 3; padding: 0 1; color: $warning; }
    #question { height: 1; }
    #question Static { width: auto; padding: 0 0 0 1; }
    #question Input { border: none; height: 1; width: 1fr; padding: 0; }
    #small { display: none; }
    .small #bench { display: none; }
    .small #small { display: block; }
    """
    BINDINGS: ClassVar[list[BindingType]] = KEYS

    def __init__(self, rig: Rig, state: BenchState, title: str) -> None:
        super().__init__()
        self.title = title
        self.state = state
        self.hung_up = False
        """Whether the terminal was closed."""
        self.controls = BenchControls(rig, state, self._post, self.exit)
        self._question: str | None = None
        """What is being typed; None: keys are knobs."""
        self._leaving = False
        self._shown: dict[str, Text] = {}

    def compose(self) -> ComposeResult:
        """Lay the panels out."""
        with Vertical(id='bench'):
            yield Static(id='status')
            with Horizontal(id='seen'):
                yield _panel('rod', 'the pendulum')
                yield _panel('marks', 'under the lamp')
                yield _panel('knobs', 'your hands')
            with Horizontal(id='read'):
                yield _panel('own-readings', 'your table')
                yield _panel('rig-readings', 'the rig reads')
            yield Static(id='messages')
            with Horizontal(id='question'):
                yield Static(id='question-text')
                yield Input(id='answer')
        yield Static(id='small')
        yield Footer()

    def on_mount(self) -> None:
        """Start the rig's thread, signal handlers and drawing."""
        self.query_one('#question').display = False
        self.query_one('#small', Static).update(f'the bench needs {WIDTH} columns and {HEIGHT} lines')
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, self.exit)
        loop.add_signal_handler(signal.SIGHUP, self._hang_up)
        self.state.notify('? explains the keys')
        self.controls.start()
        self.set_interval(1 / _FRAME_RATE, self._draw)

    def on_unmount(self) -> None:
        """Stop the rig's thread."""
        self.controls.stop()

    def on_resize(self, event: events.Resize) -> None:
        """Say so where there is too little room."""
        self.screen_stack[0].set_class(event.size.width < WIDTH or event.size.height < HEIGHT, 'small')

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:  # noqa: ARG002
        """Let questions, whose keys go before all others so that no digit is lost, leave letters to what is typed."""
        return action != 'ask' or (self._question is None and len(self.screen_stack) == 1)

    def action_speed(self, change: int) -> None:
        """Ask for another speed."""
        self.controls.change_speed(change)

    def action_touch(self, count: int) -> None:
        """Turn the dial by a touch."""
        self.state.turn_dial(self.state.dial + count * self.state.lamp_dial.touch)

    def action_dial(self, change: int) -> None:
        """Turn the dial."""
        self.state.turn_dial(self.state.dial + change)

    def action_images(self, count: int) -> None:
        """Note how many images are seen."""
        self.state.images = count

    def action_release(self) -> None:
        """Have the pendulum caught and let go."""
        self.controls.release()

    def action_watch(self) -> None:
        """Press the stopwatch."""
        self.state.press_watch(self.controls.now())

    def action_clear(self) -> None:
        """Set the stopwatch to zero."""
        self.state.watch.clear()

    def action_swings(self, change: int) -> None:
        """Note how many swings are timed."""
        self.state.swings = max(1, self.state.swings + change)

    def action_write_down(self) -> None:
        """Write a line into the table."""
        self.state.write_down(self.controls.now())

    def action_strike_out(self) -> None:
        """Strike out the last line."""
        self.state.strike_out()

    def action_pause(self) -> None:
        """Stop time, or let it run."""
        self.controls.toggle_pause()

    def action_step(self) -> None:
        """Make one step of a paused rig."""
        self.controls.step()

    def action_pace(self, factor: float) -> None:
        """Change the pace of time."""
        self.controls.change_pace(factor)

    def action_new_run(self) -> None:
        """End the run and begin the next."""
        self.controls.begin_run()

    def action_guide(self) -> None:
        """Explain the keys."""
        self.push_screen(HelpScreen(help_text(self.state.plant)))

    def action_ask(self, what: str) -> None:
        """Let something be typed."""
        self._question = what
        self.query_one('#question-text', Static).update(_QUESTIONS[what])
        answer = self.query_one('#answer', Input)
        answer.value = ''
        self.query_one('#question').display = True
        self.set_focus(answer)

    def action_answer_nothing(self) -> None:
        """Leave a question open."""
        self._question = None
        self.query_one('#question').display = False
        self.set_focus(None)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Do what was typed, or say why not."""
        question, typed = self._question, event.value.strip()
        self.action_answer_nothing()
        if not typed:
            return
        try:
            if question == 'speed':
                self.controls.set_speed(parse_speed(typed) / RPM)
            elif question == 'dial':
                self.state.turn_dial(parse_speed(typed) / RPM)
            else:
                self.state.set_release(parse_angle(typed))
        except (ValueError, InstrumentError) as error:
            self.state.messages.append(said_of(error))

    def action_leave(self) -> None:
        """End the run, so that its bag is complete, and leave; at once when asked again."""
        if self._leaving or not self.state.run:
            self.exit()
            return
        self._leaving = True
        self.state.notify('the run is being ended … (q again: leave at once)')
        self.controls.end_run(self.exit)
        self.set_timer(PATIENCE, self.exit)

    def _hang_up(self) -> None:
        self.hung_up = True
        self.exit()

    def _post(self, act: Callable[[], None]) -> None:
        """Let the screen's own thread make a call; may be called from any thread."""
        self.post_message(_Callback(act))

    def on__callback(self, message: _Callback) -> None:
        """Make a call that another thread has posted."""
        message.act()

    def _draw(self) -> None:
        wall, now = time.monotonic(), self.controls.now()
        self.state.check_fall(now)
        if self.screen is not self.screen_stack[0]:
            return
        self._show('status', panels.status(self.state, self.title, now, wall))
        for name, panel in panels.PANELS.items():
            width, height = self.query_one(f'#{name}', Static).content_size
            if width > 0 and height > 0:
                self._show(name, panel(self.state, now, width, height))

    def _show(self, name: str, text: Text) -> None:
        """Redraw a panel if it changed: most do not from one frame to the next."""
        if self._shown.get(name) != text:
            self._shown[name] = text
            self.query_one(f'#{name}', Static).update(text)


def _panel(name: str, title: str) -> Static:
    panel = Static(id=name)
    panel.border_title = title
    return panel
