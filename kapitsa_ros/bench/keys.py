"""The keys of the bench, and the action of the screen that each stands for; `guide` explains them."""

from __future__ import annotations

from textual.binding import Binding, BindingType

KEYS: list[BindingType] = [
    Binding('up', 'speed(10)', 'faster', key_display='↑', show=False),
    Binding('down', 'speed(-10)', 'slower', key_display='↓', show=False),
    Binding('pageup', 'speed(100)', show=False),
    Binding('pagedown', 'speed(-100)', show=False),
    Binding('s', "ask('speed')", 'speed', key_display='↑↓ s', priority=True),
    Binding('right', 'touch(1)', show=False),
    Binding('left', 'touch(-1)', show=False),
    Binding('right_square_bracket', 'dial(100)', show=False),
    Binding('left_square_bracket', 'dial(-100)', show=False),
    Binding('d', "ask('dial')", 'lamp', key_display='←→ d', priority=True),
    *(Binding(str(number), f'images({number})', show=False) for number in range(1, 6)),
    Binding('r', 'release', 'release'),
    Binding('a', "ask('angle')", show=False, priority=True),
    Binding('space', 'watch', 'watch', key_display='space'),
    Binding('plus,equals_sign', 'swings(1)', show=False),
    Binding('minus', 'swings(-1)', show=False),
    Binding('c', 'clear', show=False),
    Binding('w', 'write_down', 'write'),
    Binding('u', 'strike_out', show=False),
    Binding('p', 'pause', show=False),
    Binding('n', 'step', show=False),
    Binding('less_than_sign', 'pace(0.5)', show=False),
    Binding('greater_than_sign', 'pace(2.0)', show=False),
    Binding('x', 'new_run', 'next run'),
    Binding('question_mark', 'guide', 'help', key_display='?'),
    Binding('q', 'leave', 'quit'),
    Binding('ctrl+c', 'leave', show=False, priority=True),
    Binding('escape', 'answer_nothing', show=False),
]
