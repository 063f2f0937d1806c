"""Does the unmutated program of `examples/palletising` pass its own tests, whatever the seed?

    python benchmarks/palletising_seeds.py [seeds [first seed]]

Runs the example's suite in this process, every test once per seed, and prints how many passed per test.
"""

from __future__ import annotations

import sys

from pick_and_place_seeds import EXAMPLE, main, numbers_of

if __name__ == "__main__":
    sys.exit(main(*numbers_of(sys.argv, 100), example=EXAMPLE.parent / "palletising"))
