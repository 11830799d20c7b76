"""The cheapest protocol for one per cent, on a bearing that has no play."""

import kapitsa_ros as kr

found = kr.plan('bearing', target=1.0, max_speed='2500 rpm', assumptions={'play_probability': 0.0})
print(found)
print(found.to_pandas())
