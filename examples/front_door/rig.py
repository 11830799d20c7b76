"""A rig in your hands."""

import kapitsa_ros as kr

with kr.Rig(kr.Plant(length='9.75 in', damping=0.1), seed=1) as rig:
    rig.request_speed('2500 rpm')
    rig.release('7 deg')
    print(rig.wait_for('stopwatch/reading'))
