"""How well tags tell where a robot is: random poses in rooms with six tags, from rendered pictures alone.

python benchmarks/tag_poses.py --poses 100 --rooms 1
"""

from __future__ import annotations

import argparse
import math

import numpy as np

from pix2pred.domains.cleanup import CleanupDomain
from robots.test_localising import hung, looked, random_places


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=100)
    parser.add_argument("--rooms", type=int, default=1)
    args = parser.parse_args()
    from pix2pred.domains.home.roaming.tags import SIZE
    from pix2pred.robots.localising.tags import TagFinder

    finder, tags = TagFinder(SIZE), hung(SIZE)
    for seed in range(args.rooms):
        home = CleanupDomain().roaming("new-objects", seed, 0)
        off, turn, unseen, silent = [], [], 0, 0
        for place in random_places(home, args.poses, seed):
            fix = tags.locate(looked(home, finder, place))
            if fix is None:
                unseen += 1
                continue
            off.append(fix.place.distance(place))
            turn.append(math.degrees(fix.place.turn_to(place)))
            silent += off[-1] > 0.2 and fix.certain
        good = sum(o < 0.05 and t < 3 for o, t in zip(off, turn, strict=True))
        home.close()
        print(
            f"room {seed}: {good} of {args.poses} within 5 cm and 3 degrees; median {1000 * np.median(off):.1f} mm and "
            f"{np.median(turn):.2f} degrees, worst {1000 * max(off):.0f} mm; no tag seen {unseen}; "
            f"more than 20 cm off without saying so {silent}"
        )


if __name__ == "__main__":
    main()
