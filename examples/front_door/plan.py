"""The cheapest protocol for one per cent."""

import kapitsa_ros as kr

found = kr.plan('bearing', target=1.0, max_speed='2500 rpm')
print(found)
print(found.to_pandas())
