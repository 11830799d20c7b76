"""One process of a machine writes a topic of a domain."""

import signal
import subprocess
import sys
from contextlib import ExitStack

import pytest

from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.topic_lock import topic_lock

LONG = '/' + '/'.join(['desk'] * 50) + '/jigsaw/pivot'


@pytest.mark.parametrize('topic', ['/jigsaw/pivot', LONG])
def test_a_topic_has_one_holder_until_it_lets_go(domain: int, topic: str) -> None:
    told = f'another process of this machine writes {topic} in domain {domain}: a rig is there already'
    with topic_lock(topic, domain):
        for _ in range(2):
            with pytest.raises(NodeError, match=told), topic_lock(topic, domain):
                pass
    with topic_lock(topic, domain):
        pass


def test_other_topics_and_other_domains_are_free(domain: int) -> None:
    with ExitStack() as held:
        for topic, where in [('/a/pivot', domain), ('/b/pivot', domain), ('/a/pivot', 10 * domain), (LONG, domain)]:
            held.enter_context(topic_lock(topic, where))


def test_a_lock_ends_with_its_process_however_that_ends(domain: int) -> None:
    code = f"""
from kapitsa_ros.ros.topic_lock import topic_lock
with topic_lock('/jigsaw/pivot', {domain}):
    print('held', flush=True)
    input()
"""
    holding = [sys.executable, '-c', code]
    with subprocess.Popen(holding, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == 'held\n'
        with pytest.raises(NodeError, match='a rig is there already'), topic_lock('/jigsaw/pivot', domain):
            pass
        process.send_signal(signal.SIGKILL)
        process.wait()
        with topic_lock('/jigsaw/pivot', domain):
            pass
