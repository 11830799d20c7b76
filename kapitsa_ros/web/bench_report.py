"""What a page is told of the bench, in the parts in which it changes."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from kapitsa_ros.bench.bench_state import FASTEST, READ_BY_RIG
from kapitsa_ros.bench.notebook import WrittenRow
from kapitsa_ros.instruments.lamp import AFTERIMAGE
from kapitsa_ros.message import Message, said_by
from kapitsa_ros.web.catalogue import words_of
from kapitsa_ros.web.reading_message import reading_message

if TYPE_CHECKING:
    from kapitsa_ros.bench.bench_state import BenchState
    from kapitsa_ros.web.page_client import PageClient
    from kapitsa_ros.web.web_bench import WebBench

_MESSAGES = 6


def report(bench: WebBench, page: PageClient) -> dict[str, str]:
    """Return the parts of the report by kind, each a JSON object with its `kind`."""
    words = words_of(page.language)
    parts = {
        'knobs': _knobs(bench.state, bench.now()),
        'rig': _rig(bench, page, words),
        'book': _book(bench.state, words),
        'fit': bench.fit.values(words),
        'messages': {'messages': _messages(bench, words)},
    }
    return {kind: json.dumps({'kind': kind} | values, allow_nan=False) for kind, values in parts.items()}


def _knobs(state: BenchState, now: float) -> dict[str, Any]:
    watch = state.watch
    return {
        'speed': state.speed,
        'fastest': FASTEST,
        'angle': state.release,
        'dial': state.dial,
        'dial_reading': state.dial_reading,
        'dial_end': state.lamp_dial.end,
        'graduation': state.lamp_dial.graduation,
        'touch': state.lamp_dial.touch,
        'images': state.images,
        'forcing': state.forcing,
        'swings': state.swings,
        'watch_started': watch.started if watch.runs else None,
        'watch_gain': watch.gain,
        'watch_digit': watch.digit,
        'watch_shown': None if watch.runs else watch.shown(now),
        'period': None if watch.runs or not watch.shown(now) else state.period(now),
    }


def _rig(bench: WebBench, page: PageClient, words: dict[str, str]) -> dict[str, Any]:
    state = bench.state
    readings = list(state.rig_readings) if bench.rig_readings_seen else []
    return {
        'sitting': bench.sitting,
        'run': state.run,
        'runs': bench.runs,
        'paused': state.paused,
        'pace': state.clock.rate,
        'length': bench.setup.shown.length,
        'amplitude': bench.setup.shown.amplitude,
        'threshold_rpm': bench.setup.threshold_rpm,
        'afterimage': AFTERIMAGE,
        'mark_width': bench.setup.instruments.strobe.mark_width,
        'works': bench.pages.works(page),
        'failure': None if bench.failure is None else bench.failure.said_by(words),
        'plot_seen': bench.plot_seen,
        'rig_readings_seen': bench.rig_readings_seen,
        'rig_readings': [reading_message(run, reading).said_by(words) for run, reading in readings],
    }


def _messages(bench: WebBench, words: dict[str, str]) -> list[str]:
    newest = list(bench.state.messages)[-_MESSAGES:]
    if not bench.rig_readings_seen:
        of_rig = set(READ_BY_RIG.values())
        newest = [
            Message('run {run} is over', run=each.values['run']) if each.template in of_rig else each for each in newest
        ]
    return [message.said_by(words) for message in newest]


def _book(state: BenchState, words: dict[str, str]) -> dict[str, Any]:
    return {
        'lines': [
            {
                'run': line.row.run,
                'forcing_rpm': line.row.forcing_rpm,
                'period_s': line.row.period_s,
                'swings': line.row.swings,
                'display_s': line.row.display_s,
                'release_rad': None if math.isnan(line.row.release_rad) else line.row.release_rad,
                'struck': line.struck,
            }
            if isinstance(line, WrittenRow)
            else {'note': said_by(line, words)}
            for line in state.notebook.lines
        ]
    }
