"""A sensor of one's own: counts the strokes of the jigsaw and says how fast the shaft turns.

Start it beside a rig, in the same domain; it needs nothing of kapitsa_ros but the messages:

    ROS_DOMAIN_ID=7 python examples/tachometer.py

It reads `jigsaw/pivot`, and publishes the `velocity` of `shaft` (rad/s) on `tachometer/reading`, a message a step.
"""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

NETWORK = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)


class Tachometer(Node):
    """The pivot of a Scotch yoke is a harmonic oscillation: y'' = -omega^2 y while the speed is steady."""

    def __init__(self) -> None:
        super().__init__('tachometer')
        self.reading = self.create_publisher(JointState, 'tachometer/reading', NETWORK)
        self.create_subscription(JointTrajectory, 'jigsaw/pivot', self.measure, NETWORK)

    def measure(self, motion: JointTrajectory) -> None:
        """Read the speed off one step: mean square of the acceleration over that of the stroke."""
        stroke = sum(point.positions[0] ** 2 for point in motion.points)
        acceleration = sum(point.accelerations[0] ** 2 for point in motion.points)
        reading = JointState(header=motion.header)
        if stroke > 0:
            reading.name = ['shaft']
            reading.velocity = [math.sqrt(math.sqrt(acceleration / stroke))]
        self.reading.publish(reading)


def main() -> None:
    """Measure until a signal comes."""
    rclpy.init()
    try:
        rclpy.spin(Tachometer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
