"""A controller in the operator's place: finds the critical speed by bisection, as the pendulum stays or falls.

Start the rig without its operator, and this beside it; it needs nothing of kapitsa_ros but the messages:

    ROS_DOMAIN_ID=7 python examples/bisection.py

One run a speed: the pendulum is held while the shaft runs up, and let go. Above the critical speed it swings through
upright, below it falls over. The last line on stdout is the critical speed in RPM.
"""

import math

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState, TimeReference
from trajectory_msgs.msg import JointTrajectory

RPM = 2 * math.pi / 60
DAY = 86_400  # s: run n takes place on day n
STEP = 0.1  # s
IN_FLIGHT = 4  # steps from what is seen to the command that answers it; the jigsaw is told the same
SPIN_UP = 20  # steps until the shaft is at its speed
RELEASE = 0.01  # rad; a larger swing needs a higher speed, by the square of the angle over four
FALLEN = 1.0  # rad
NETWORK = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
READERS = {'jigsaw', 'pendulum', 'analyser', 'recorder'}


class Bisection(Node):
    """One command a step, each in answer to the motion of four steps before."""

    def __init__(self, low: float = 1000 * RPM, high: float = 2000 * RPM, within: float = 0.5 * RPM) -> None:
        super().__init__('operator')
        self.low, self.high, self.within = low, high, within
        self.run = 0
        self.over = False
        self.ended = False
        self.command = self.create_publisher(JointState, 'operator/command', NETWORK)
        self.create_subscription(JointTrajectory, 'pendulum/motion', self.watch, NETWORK)
        # The rig waits until whoever is the operator reads both instruments.
        self.create_subscription(JointState, 'strobe/reading', lambda _: None, NETWORK)
        self.create_subscription(TimeReference, 'stopwatch/reading', lambda _: None, NETWORK)

    @property
    def speed(self) -> float:
        """The speed to try next, rad/s."""
        return (self.low + self.high) / 2

    def readers(self) -> set[str]:
        """Return which nodes of the rig read commands now."""
        return READERS & {reader.node_name for reader in self.get_subscriptions_info_by_topic('operator/command')}

    def everyone_is_there(self) -> bool:
        """Whether no command would be missed, and no motion."""
        return self.readers() == READERS and self.count_publishers('pendulum/motion') > 0

    def open_run(self) -> None:
        """Say what holds until the first motion can be answered; or that no run will follow."""
        self.run += 1
        self.ended = False
        if self.high - self.low < self.within:
            self.say(0, end=True)
            self.over = True
            return
        for step in range(IN_FLIGHT):
            self.say(step, hold=RELEASE)

    def watch(self, motion: JointTrajectory) -> None:
        """Answer the motion over one step."""
        _, run, _, step, *end = motion.header.frame_id.split()
        if end:
            self.open_run()
        if end or self.ended or int(run) != self.run:
            return
        angle = motion.points[-1].positions[0]
        if int(step) < SPIN_UP:
            self.say(int(step) + IN_FLIGHT, hold=RELEASE)
        elif 0 < angle < FALLEN:
            self.say(int(step) + IN_FLIGHT)
        else:
            self.narrow(stays=angle <= 0)
            self.say(int(step) + IN_FLIGHT, end=True)

    def narrow(self, *, stays: bool) -> None:
        """Take the half in which the critical speed lies."""
        self.get_logger().info(f'{self.speed / RPM:.1f} RPM: {"stays" if stays else "falls"}')
        if stays:
            self.high = self.speed
        else:
            self.low = self.speed

    def say(self, step: int, *, hold: float | None = None, end: bool = False) -> None:
        """Publish the command for a step: the shaft's speed, and the pendulum's angle where it is held."""
        self.ended = end
        command = JointState()
        command.header.frame_id = f'run {self.run} step {step}' + ' end' * end
        nanoseconds = round((self.run * DAY + step * STEP) * 1e9)
        command.header.stamp.sec, command.header.stamp.nanosec = divmod(nanoseconds, 10**9)
        if not end:
            held = hold is not None
            command.name = ['shaft', 'pendulum'] if held else ['shaft']
            command.position = [0.0, hold] if held else [0.0]
            command.velocity = [self.speed, 0.0] if held else [self.speed]
        self.command.publish(command)


def main() -> None:
    """Bisect."""
    rclpy.init()
    controller = Bisection()
    while not controller.everyone_is_there():
        rclpy.spin_once(controller, timeout_sec=0.1)
    controller.open_run()
    while not controller.over:
        rclpy.spin_once(controller)
    controller.command.wait_for_all_acked(Duration(seconds=5))
    print(f'{controller.speed / RPM:.1f}')
    # The rig's nodes leave now; Fast DDS may hang in a node that is taken down while it hears of others that leave.
    while controller.readers():
        rclpy.spin_once(controller, timeout_sec=0.2)
    controller.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
