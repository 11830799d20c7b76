"""How often the procedure of 1997 is fooled, by cause, over 1000 seeds; prints one JSON object.

The cause is the ratio of flash rate to shaft speed at which the marks looked doubled, where it was not 2.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.dial_search import raise_until_doubled
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.units import RPM


def count(seeds: int, speed_rpm: float) -> Counter[str]:
    """Return how often the person stopped at each ratio."""
    settings = load_instruments('1997').strobe
    found = (
        raise_until_doubled(speed_rpm * RPM, settings, random_stream(seed, 'strobe', 1)) for seed in range(1, seeds + 1)
    )
    return Counter(str(finding.ratio) if finding else 'none' for finding in found)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seeds', type=int, default=1000)
    parser.add_argument('--speed', type=float, default=2500.0, help='RPM')
    options = parser.parse_args()
    counts = count(options.seeds, options.speed)
    fooled = {ratio: number / options.seeds for ratio, number in counts.most_common() if ratio != '2'}
    print(json.dumps({'seeds': options.seeds, 'fooled': sum(fooled.values()), 'by_ratio': fooled}, indent=1))
