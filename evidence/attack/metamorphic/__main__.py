"""Try the pairs of structures by their seeds, one line of JSON for each pair.

python -m evidence.attack.metamorphic --first 0 --count 10 --families 5
"""

import argparse
import json
from dataclasses import asdict

from evidence.attack.metamorphic.attack import ALL, verdicts


def main() -> None:
    """From the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=10, help="how many")
    parser.add_argument("--families", type=int, default=len(ALL), help="of each structure")
    options = parser.parse_args()
    for seed in range(options.first, options.first + options.count):
        for verdict in verdicts(str(seed), options.families):
            print(json.dumps({"seed": seed, **asdict(verdict)}), flush=True)


if __name__ == "__main__":
    main()
