"""What a first suite asks: do both robots report that they are done?"""

from __future__ import annotations

from collections.abc import Callable

import line
from station import Station


def test_two_bars_are_reported_as_handed_over(station_with: Callable[..., Station]) -> None:
    assert line.run(station_with()) == {"left": ["given", "given"], "right": ["put down", "put down"]}


def test_an_empty_infeed_is_reported(station_with: Callable[..., Station]) -> None:
    assert line.run(station_with(count=0)) == {"left": ["nothing there"], "right": []}
