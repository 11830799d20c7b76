"""What the participants of this process and of the nodes are told about the network."""

import os
import re
import sys
from pathlib import Path
from threading import Barrier, Event, Thread

from kapitsa_ros.resources import resource_path
from kapitsa_ros.rig.environment import node_environment, on_loopback

RANGE, PROFILE = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'FASTRTPS_DEFAULT_PROFILES_FILE'


def test_a_context_that_overlaps_another_keeps_to_loopback_until_it_is_left(monkeypatch) -> None:
    monkeypatch.delenv(RANGE)
    monkeypatch.delenv(PROFILE, raising=False)
    first, second = on_loopback(), on_loopback()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert os.environ[RANGE] == 'LOCALHOST'
    assert os.environ[PROFILE].endswith('loopback.xml')
    second.__exit__(None, None, None)
    assert RANGE not in os.environ
    assert PROFILE not in os.environ


def test_threads_that_enter_at_once_all_keep_to_loopback(monkeypatch) -> None:
    monkeypatch.delenv(RANGE)
    together, seen = Barrier(8), []

    def work() -> None:
        for _ in range(50):
            together.wait()
            with on_loopback():
                seen.append(os.environ.get(RANGE))

    threads = [Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == ['LOCALHOST'] * 400
    assert RANGE not in os.environ


def test_a_node_keeps_to_loopback_whatever_other_threads_enter_and_leave(monkeypatch) -> None:
    """A snapshot of the environment must not lie half before and half after another thread's context."""
    monkeypatch.delenv(RANGE)
    monkeypatch.delenv(PROFILE, raising=False)
    done = Event()

    def enter_and_leave() -> None:
        while not done.is_set():
            with on_loopback():
                pass

    threads = [Thread(target=enter_and_leave) for _ in range(3)]
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    for thread in threads:
        thread.start()
    try:
        environments = [node_environment(1) for _ in range(3000)]
    finally:
        done.set()
        for thread in threads:
            thread.join()
        sys.setswitchinterval(interval)
    assert {environment.get(RANGE) for environment in environments} == {'LOCALHOST'}
    assert all(PROFILE in environment for environment in environments)


def test_what_somebody_sets_within_a_context_stays(monkeypatch) -> None:
    monkeypatch.delenv(RANGE)
    monkeypatch.delenv(PROFILE, raising=False)
    with on_loopback():
        monkeypatch.setenv(RANGE, 'SUBNET')
    assert os.environ[RANGE] == 'SUBNET'
    assert PROFILE not in os.environ


def test_slow_heartbeats_are_all_that_tells_the_two_profiles_apart() -> None:
    def said(profile: str) -> str:
        text = Path(str(resource_path('config', profile))).read_text(encoding='utf-8')
        return re.sub(r'<!--.*?-->|\s+', '', text, flags=re.DOTALL)

    usual = said('loopback.xml')
    slow = usual.replace('<nanosec>50000000</nanosec></heartbeatPeriod>', '<sec>1</sec></heartbeatPeriod>')
    assert slow != usual
    assert said('loopback_slow_heartbeats.xml') == slow.replace('brisk_writer', 'slow_heartbeat_writer')
