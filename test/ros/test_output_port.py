"""Each datagram goes once: the output port of our transport is taken, by all processes that open DDS."""

import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from kapitsa_ros.resources import resource_path
from kapitsa_ros.ros.output_port import OUTPUT_PORT, hold_output_port


@pytest.mark.parametrize('profile', ['loopback.xml', 'loopback_slow_heartbeats.xml', 'static_peers.xml'])
def test_the_profiles_have_the_port_that_is_held(profile: str) -> None:
    text = Path(str(resource_path('config', profile))).read_text(encoding='utf-8')
    assert re.findall(r'<output_port>(\d+)</output_port>', text) == [str(OUTPUT_PORT)]


@pytest.mark.parametrize('address', ['127.0.0.1', ''])
def test_it_is_taken_for_who_does_not_share_it(address: str) -> None:
    hold_output_port()
    hold_output_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, pytest.raises(OSError, match='in use'):
        other.bind((address, OUTPUT_PORT))


def test_python_is_not_told_of_a_socket_that_nobody_closed() -> None:
    program = 'from kapitsa_ros.ros.output_port import hold_output_port; hold_output_port()'
    done = subprocess.run([sys.executable, '-W', 'error', '-c', program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, '')
