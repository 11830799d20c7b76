"""A recorded run once more through the graph."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.xdist_group('harness')
SHIPPED = Path(__file__).parents[2] / 'bags'


def test_the_graph_gives_a_shipped_run_again(kapitsa: Callable[..., Any]) -> None:
    [told] = kapitsa('verify', SHIPPED / 'run_02_2640rpm', '--graph', '--json').json['bags']
    assert told['identical']
    assert (told['run'], told['first_difference'], told['largest_ulp']) == (2, None, 0)
    assert told['digest'] == '4c80cba47e51f178996bd25e3b4d9d8d03706f329d9375d0a72815363ee39507'


def test_a_digest_that_is_another_is_no_success(kapitsa: Callable[..., Any]) -> None:
    answer = kapitsa('verify', SHIPPED / 'run_02_2640rpm', '--digest', '00', '--json')
    assert answer.status == 1
    assert not json.loads(answer.out)['bags'][0]['identical']
