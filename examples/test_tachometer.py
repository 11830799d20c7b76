"""The test of a node of one's own against the rig."""

import pytest
import rclpy
from sensor_msgs.msg import JointState
from tachometer import NETWORK, Tachometer


def test_the_tachometer_agrees_with_the_strobe(rig):
    rclpy.init(domain_id=rig.domain)
    tachometer, said = Tachometer(), []
    tachometer.create_subscription(JointState, 'tachometer/reading', said.append, NETWORK)
    rig.request_speed(2500)
    strobe = rig.wait_for('strobe/reading')
    while not (said and said[-1].velocity and said[-1].velocity[0] > 0.99 * strobe.speed):
        rclpy.spin_once(tachometer, timeout_sec=10)
    assert said[-1].velocity[0] == pytest.approx(strobe.speed, rel=0.01)
    rclpy.shutdown()
