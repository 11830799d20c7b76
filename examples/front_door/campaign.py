"""Sixteen virtual experiments."""

import kapitsa_ros as kr

if __name__ == '__main__':
    found = kr.campaign('bearing', experiments=16)
    print(found)
    found.plot().savefig('campaign.png')
