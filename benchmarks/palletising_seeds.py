"""Does the unmutated program of `examples/palletising` pass its own tests, whatever the seed?

    python benchmarks/palletising_seeds.py [seeds [first seed]]

Runs the example's suite in this process, every test once per seed, and prints how many passed per test.
"""

from __future__ import annotations

import sys

from pick_and_place_seeds import EXAMPLE, main

if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:3]]
    sys.exit(main(*numbers, *(100, 0)[len(numbers) :], example=EXAMPLE.parent / "palletising"))
