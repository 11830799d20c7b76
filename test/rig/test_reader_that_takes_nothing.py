"""A reader that takes nothing, and is not of the rig, is named where the experiment was started, and ends it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from kapitsa_ros.rig.domain import reserved_domain

pytestmark = pytest.mark.xdist_group('processes')
SLEEPER = """
import sys
import rclpy
from rclpy.node import Node
from kapitsa_ros.network.registry import PIVOT
from kapitsa_ros.ros.qos import STREAM, message_class
rclpy.init(domain_id=int(sys.argv[1]))
node = Node('sleeper')
node.create_subscription(message_class(PIVOT.type), PIVOT.name, print, STREAM, raw=True)
sys.stdin.read()
"""
SHORT = """<dds xmlns="http://www.eprosima.com"><profiles>
<data_reader profile_name="short" is_default_profile="true"><topic><resourceLimitsQos><max_samples>10</max_samples>
<max_instances>10</max_instances><max_samples_per_instance>10</max_samples_per_instance>
<allocated_samples>1</allocated_samples></resourceLimitsQos></topic></data_reader></profiles></dds>"""


@pytest.mark.slow
def test_an_experiment_that_is_held_up_says_by_whom_and_ends(tmp_path: Path) -> None:
    with reserved_domain() as number:  # the experiment reserves it itself
        pass
    profile, protocol = tmp_path / 'short.xml', tmp_path / 'protocol.yaml'
    profile.write_text(SHORT, encoding='utf-8')
    protocol.write_text(yaml.safe_dump({'speeds': ['2640 rpm'], 'swings': 1, 'repeats': 700}), encoding='utf-8')
    own = os.environ | {'ROS_DOMAIN_ID': str(number)}
    reader = subprocess.Popen(
        [sys.executable, '-c', SLEEPER, str(number)],
        stdin=subprocess.PIPE,
        env=own | {'FASTRTPS_DEFAULT_PROFILES_FILE': str(profile)},
    )
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--bags', tmp_path / 'A', '--protocol', protocol]
    try:
        done = subprocess.run(command, env=own, capture_output=True, text=True, timeout=600, check=False)
    finally:
        reader.kill()
        reader.communicate()
    assert done.returncode == 1
    *_, warning, error = done.stderr.splitlines()
    assert warning.startswith('kapitsa: warning: jigsaw: jigsaw/pivot is full: waiting for a reader that has stopped (')
    assert warning.endswith(', of which sleeper is not of this rig')
    told = 'kapitsa: error: jigsaw died with status 1: jigsaw/pivot has been full for 25 s: sleeper reads it'
    assert error.startswith(told)
