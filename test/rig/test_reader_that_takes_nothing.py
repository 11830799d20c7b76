"""A reader that takes nothing, and is not of the rig, is named where the experiment was started, and ends it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from reader_that_takes_nothing import reader_that_takes_nothing

from kapitsa_ros.network.registry import PIVOT
from kapitsa_ros.rig.domain import reserved_domain

pytestmark = pytest.mark.xdist_group('processes')


@pytest.mark.slow
def test_an_experiment_that_is_held_up_says_by_whom_and_ends(tmp_path: Path) -> None:
    with reserved_domain() as number:  # the experiment reserves it itself
        pass
    protocol = tmp_path / 'protocol.yaml'
    protocol.write_text(yaml.safe_dump({'speeds': ['2640 rpm'], 'swings': 1, 'repeats': 700}), encoding='utf-8')
    own = os.environ | {'ROS_DOMAIN_ID': str(number)}
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--bags', tmp_path / 'A', '--protocol', protocol]
    with reader_that_takes_nothing(PIVOT.name, 'sleeper', number, tmp_path):
        done = subprocess.run(command, env=own, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 1
    *_, warning, error = done.stderr.splitlines()
    assert warning.startswith('kapitsa: warning: jigsaw: jigsaw/pivot is full: waiting for a reader that has stopped (')
    assert warning.endswith(', of which sleeper is not of this rig')
    told = 'kapitsa: error: jigsaw died with status 1: jigsaw/pivot has been full for 25 s: sleeper reads it'
    assert error.startswith(told)
