"""A node as a process: what it says and how it ends, whoever has started it."""

import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from rcl_interfaces.msg import Log
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.rig.environment import node_environment, on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.ros.qos import LATCHED

PATIENCE = 180.0
SHARED_MEMORY = Path('/dev/shm')  # noqa: S108  # nothing is put there


def script(text: str) -> list[str]:
    return [sys.executable, '-c', text]


def interrupt_once_joined(node: subprocess.Popen[str]) -> None:
    assert node.stderr is not None
    assert next(line for line in node.stderr if 'joins domain' in line)
    node.send_signal(signal.SIGINT)


@pytest.mark.parametrize(
    'arguments', [['player'], ['pendulum', '--ros-args', '-p', 'length:=-1.0'], ['player', '--help']]
)
def test_a_node_that_is_refused_leaves_no_shared_memory(domain: int, arguments: list[str]) -> None:
    """Fast DDS opens it where no profile says otherwise, and only a node that is destroyed takes it away."""
    environment = {name: value for name, value in os.environ.items() if 'RTPS' not in name and 'FASTDDS' not in name}
    command = [sys.executable, '-m', 'kapitsa_ros.nodes', *arguments]
    before = set(SHARED_MEMORY.glob('fastrtps_port*'))  # of who was killed
    own = {'ROS_DOMAIN_ID': str(domain), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    done = subprocess.run(command, env=environment | own, capture_output=True, timeout=PATIENCE, check=False)
    assert done.returncode == (0 if '--help' in arguments else 2)
    first = 7400 + 250 * domain
    left = {path.name for path in set(SHARED_MEMORY.glob('fastrtps_port*')) - before}
    assert left.isdisjoint(f'fastrtps_port{port}' for port in range(first, first + 250))


HOST = """
import signal, threading
from kapitsa_ros.nodes.__main__ import main

def signals():
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    return [signal.getsignal(number) for number in numbers], signal.pthread_sigmask(signal.SIG_BLOCK, ())

before = signals()
print(main(['pendulum']), main(['pendulum']), signals() == before)
threading.Event().wait(2.0)  # the watchdog of the node would have struck by now
print('alive', flush=True)
"""


def test_the_program_that_ran_a_node_lives_on(domain: int) -> None:
    """It hears signals as before, and can run another node."""
    host = subprocess.Popen(
        script(HOST), env=node_environment(domain), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    for _ in range(2):  # one node after the other
        interrupt_once_joined(host)
    out, err = host.communicate(timeout=PATIENCE)
    assert out == '0 0 True\nalive\n', err
    assert host.returncode == 0


IN_THE_MIDDLE = """
import os, signal, time
import rclpy
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main

asked = []

def interrupting(call):
    def ask():
        asked.append(call)
        if len(asked) == 3:
            os.kill(os.getpid(), signal.SIGINT)
            # Where it is let through, rclpy's own thread shuts the context, and tells nobody of that.
            while signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ()) and rclpy.ok():
                time.sleep(0.01)
        return call()
    return ask

class Interrupted(pendulum.PendulumNode):
    def __init__(self, *given):
        super().__init__(*given)
        for waitable in self.waitables:
            waitable.get_num_entities = interrupting(waitable.get_num_entities)

pendulum.create = Interrupted
print(main(['pendulum']), len(asked) > 3)
"""


def test_a_signal_while_the_executor_registers_a_node_ends_that_alone(domain: int) -> None:
    """What was half registered made the executor's destructor abort, and the program with it."""
    done = run(IN_THE_MIDDLE, domain)
    assert (done.stdout, done.returncode) == ('0 True\n', 0)


AFTER_HELP = """
from kapitsa_ros.nodes.__main__ import main
main(['pendulum', '--help'])
raise SystemExit(main(['pendulum']))
"""


def test_a_node_hears_signals_in_a_program_that_has_asked_for_help(domain: int) -> None:
    host = subprocess.Popen(
        script(AFTER_HELP), env=node_environment(domain), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    interrupt_once_joined(host)
    host.communicate(timeout=PATIENCE)
    assert host.returncode == 0


IN_ROS = """
import rclpy
from kapitsa_ros.nodes.__main__ import main
rclpy.init()
print(main(['pendulum']), main(['pendulum', '--help']), rclpy.ok())
rclpy.shutdown()
"""


def test_a_program_that_is_at_work_with_ros_is_told_so_and_goes_on(domain: int) -> None:
    done = run(IN_ROS, domain)
    assert done.stdout == '2 2 True\n'
    assert done.stderr.splitlines() == 2 * [
        'pendulum: error: ROS is initialised in this program: call rclpy.shutdown() before, or use kapitsa_ros.Rig'
    ]


def test_nobody_in_the_domain_sees_a_node_that_is_asked_for_help(domain: int) -> None:
    """A rig would take it for a second writer."""
    context = Context()
    with on_loopback():
        context.init(domain_id=domain)
        observer = Node('observer', context=context)
    seen: set[str] = set()
    helped = subprocess.Popen(
        [sys.executable, '-m', 'kapitsa_ros.nodes', 'strobe', '--help'],
        env=node_environment(domain),
        stdout=subprocess.DEVNULL,
    )
    while helped.poll() is None:
        seen.update(observer.get_node_names())
    observer.destroy_node()
    context.shutdown()
    assert (helped.returncode, seen) == (0, {'observer'})


BUG = """
import sys
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main

class Broken(pendulum.PendulumNode):
    def poll(self):
        raise {error}

pendulum.create = Broken
sys.exit(main(['pendulum']))
"""


def run(text: str, domain: int) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        script(text), env=node_environment(domain), capture_output=True, text=True, timeout=180, check=False
    )


OF_A_CALLBACK = """
import sys
from std_srvs.srv import Trigger
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main

class Broken(pendulum.PendulumNode):
    def __init__(self, *given):
        super().__init__(*given)
        self.create_subscription(Trigger.Event, 'broken', self.break_down, 10)
        self.create_service(Trigger, 'broken', self.break_down)
        self.told = self.{tells}
        self.called = []

    def break_down(self, *given):
        raise ValueError('shapes')

    def poll(self):
        {call}
        return 0.05

pendulum.create = Broken
sys.exit(main(['pendulum']))
"""


@pytest.mark.parametrize(
    ('tells', 'call'),
    [
        ("create_publisher(Trigger.Event, 'broken', 10)", 'self.told.publish(Trigger.Event())'),
        ("create_client(Trigger, 'broken')", 'self.called.append(self.told.call_async(Trigger.Request()))'),
    ],
)
def test_a_bug_of_a_callback_ends_its_node(tells: str, call: str, domain: int) -> None:
    """What rclpy's own callbacks cannot use is refused, and the node goes on; ours have no such excuse."""
    bug = run(OF_A_CALLBACK.format(tells=tells, call=call), domain)
    assert bug.returncode == 1
    assert 'refused' not in bug.stderr
    assert bug.stderr.rstrip().endswith('ValueError: shapes')


def test_a_bug_is_shown_with_its_traceback_and_a_mistake_of_the_user_in_one_line(domain: int) -> None:
    bug = run(BUG.format(error="ValueError('shapes')"), domain)
    assert bug.returncode == 1
    assert 'Traceback (most recent call last)' in bug.stderr
    assert bug.stderr.rstrip().endswith('ValueError: shapes')

    mistake = run('from kapitsa_ros.ros.errors import NodeError\n' + BUG.format(error="NodeError('no')"), domain)
    assert mistake.returncode == 1
    assert 'Traceback' not in mistake.stderr
    assert mistake.stderr.rstrip().endswith('pendulum: error: no')


AFTER_A_SIGNAL = """
import sys
import rclpy
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main

class Broken(pendulum.PendulumNode):
    def close(self):
        raise RuntimeError('a bug on the way out')

pendulum.create = Broken
sys.exit(main(['pendulum']))
"""


def test_a_bug_after_a_signal_is_no_success(domain: int) -> None:
    node = subprocess.Popen(script(AFTER_A_SIGNAL), env=node_environment(domain), stderr=subprocess.PIPE, text=True)
    interrupt_once_joined(node)
    _, err = node.communicate(timeout=PATIENCE)
    assert 'RuntimeError: a bug on the way out' in err
    assert node.returncode == 1


def test_a_node_started_through_a_shell_of_the_rig_lives_on(domain: int) -> None:
    """What a rig tells its own nodes does not reach those that somebody starts from its environment."""
    environment = node_environment(domain)
    command = f'{sys.executable} -m kapitsa_ros.nodes pendulum; :'
    shell = subprocess.Popen(['/bin/sh', '-c', command], env=environment, stderr=subprocess.PIPE, text=True)
    assert shell.stderr is not None
    assert next(line for line in shell.stderr if 'joins domain' in line)
    assert next(line for line in shell.stderr if 'waiting for' in line)
    (node,) = Path(f'/proc/{shell.pid}/task/{shell.pid}/children').read_text().split()
    os.kill(int(node), signal.SIGINT)
    shell.communicate(timeout=PATIENCE)


ORPHANS = """
import os, sys
from kapitsa_ros.rig.node_group import NodeGroup
node = NodeGroup(['pendulum'], {{}}, {domain})['pendulum']
assert node.wait_for_line('joins domain', 30.0)
print(node.pid, flush=True)
os._exit(0)
"""


def test_a_node_of_a_rig_that_was_killed_ends(domain: int) -> None:
    done = subprocess.run(
        script(ORPHANS.format(domain=domain)), capture_output=True, text=True, timeout=180, check=True
    )
    pidfd = None
    try:
        pidfd = os.pidfd_open(int(done.stdout))
    except ProcessLookupError:
        return
    try:
        poll = select.poll()
        poll.register(pidfd, select.POLLIN)
        assert poll.poll(PATIENCE * 1000), 'it outlives its rig'
    finally:
        os.close(pidfd)


def test_what_a_rig_starts_is_known_by_its_role(domain: int) -> None:
    with NodeGroup(['pendulum'], {'length': -1.0}, domain) as nodes:
        assert select.select([nodes['pendulum'].sentinel], [], [], PATIENCE)[0]
        assert nodes['pendulum'].status() == 2
        assert 'parameter length' in nodes['pendulum'].last_error_lines()


def test_a_parameter_that_no_role_has_is_reported(domain: int) -> None:
    command = [sys.executable, '-m', 'kapitsa_ros.nodes', 'pendulum', '--ros-args', '-p', 'lenght:=0.3']
    node = subprocess.Popen(command, env=node_environment(domain), stderr=subprocess.PIPE, text=True)
    assert node.stderr is not None
    said = []
    for line in node.stderr:
        said.append(line)
        if 'joins domain' in line:
            break
    node.send_signal(signal.SIGINT)
    node.communicate(timeout=PATIENCE)
    assert any('parameter lenght is unknown: length may be meant' in line for line in said)


def test_parameters_of_other_roles_are_known(domain: int, tmp_path: Path) -> None:
    """A rig gives all of them to each of its nodes."""
    with NodeGroup(ROLE_NAMES, parameters(Setup(bags=tmp_path)), domain) as nodes:
        for role in ROLE_NAMES:
            assert nodes[role].wait_for_line('joins domain', PATIENCE)
            assert 'is unknown' not in nodes[role].last_error_lines()


LATE = """
import sys
import kapitsa_ros.nodes.pendulum as pendulum
from kapitsa_ros.nodes.__main__ import main
from kapitsa_ros.ros.errors import NodeError

class Broken(pendulum.PendulumNode):
    def poll(self):
        if self._rosout.get_subscription_count():
            raise NodeError('the rod is ' + 1000 * 'very ' + 'broken')
        return 0.05

pendulum.create = Broken
sys.exit(main(['pendulum']))
"""


def test_why_a_node_ends_reaches_rosout_and_is_no_longer_than_a_line(domain: int) -> None:
    context, heard = Context(), []
    with on_loopback():
        context.init(domain_id=domain)
        listener = Node('listener', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(listener)
    listener.create_subscription(Log, '/rosout', heard.append, LATCHED)
    node = subprocess.Popen(script(LATE), env=node_environment(domain), stderr=subprocess.PIPE, text=True)
    try:
        while not any(message.level == Log.FATAL for message in heard):
            executor.spin_once(timeout_sec=PATIENCE)
        _, err = node.communicate(timeout=PATIENCE)
    finally:
        node.kill()
        executor.shutdown()
        listener.destroy_node()
        context.try_shutdown()
    [fatal] = [message for message in heard if message.level == Log.FATAL]
    assert (fatal.name, len(fatal.msg)) == ('pendulum', 400)
    assert fatal.msg.startswith('the rod is very')
    assert err.splitlines()[-1] == f'pendulum: error: {fatal.msg}'


THREAD = """
import threading
from kapitsa_ros.nodes.__main__ import main
thread = threading.Thread(target=lambda: print(main(['pendulum'])))
thread.start()
thread.join()
"""


def test_a_node_in_another_thread_is_refused_in_one_line(domain: int) -> None:
    done = run(THREAD, domain)
    assert done.stdout == '1\n'
    assert done.stderr.startswith('kapitsa: error: a node takes the signals of its process')
    assert done.stderr.count('\n') == 1


@pytest.mark.parametrize(
    ('role', 'lines'),
    [
        (
            'player',
            ['bags: folders of the runs to play, in this order', 'rate: ', 'seek: ', 'expect: roles of the graph'],
        ),
        ('strobe', ['dial_resolution: ', 'seed: ', 'expect: ']),
    ],
)
def test_the_help_of_a_node_lists_its_parameters(role: str, lines: list[str], domain: int) -> None:
    done = subprocess.run(
        [sys.executable, '-m', 'kapitsa_ros.nodes', role, '--help'],
        env=node_environment(domain), capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f'usage: {role} [--ros-args')
    listed = done.stdout.partition('parameters:\n')[2].splitlines()
    assert all(any(line.strip().startswith(start) for line in listed) for start in lines)
    assert all('(default ' in line for line in listed)


@pytest.mark.parametrize(
    ('role', 'given', 'words'),
    [
        ('recorder', 'bags:=/dev/null/runs', '/dev/null/runs cannot be written; give a folder you can write to'),
        ('strobe', 'seed:=[]', 'parameter seed is empty: it must be an integer'),
        ('strobe', 'use_sim_time:=perhaps', "'use_sim_time' to 'perhaps' of type 'STRING', expecting type 'BOOL'"),
    ],
)
def test_a_parameter_that_cannot_be_used_is_one_line(role: str, given: str, words: str, domain: int) -> None:
    done = subprocess.run(
        [sys.executable, '-m', 'kapitsa_ros.nodes', role, '--ros-args', '-p', given],
        env=node_environment(domain), capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith(f'{role}: error: parameter')
    assert words in done.stderr
    assert done.stderr.count('\n') == 1


def test_a_help_that_cannot_be_written_is_one_line(domain: int) -> None:
    with open('/dev/full', 'w') as full:  # noqa: PTH123
        done = subprocess.run(
            [sys.executable, '-m', 'kapitsa_ros.nodes', 'strobe', '--help'],
            env=node_environment(domain), stdout=full, stderr=subprocess.PIPE, text=True, timeout=180, check=False,
        )  # fmt: skip
    assert (done.returncode, done.stderr) == (1, 'kapitsa: error: [Errno 28] No space left on device\n')
