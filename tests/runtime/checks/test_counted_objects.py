"""What is noted while a test of the original runs makes no object that the test could count."""

from __future__ import annotations

import gc
from collections.abc import Callable

import pytest

from mutabot.model.mutant import Span
from mutabot.model.program_text import TextPlace
from mutabot.runtime.observation.checks import Looks
from mutabot.runtime.program_text.switches import Sightings


def new_objects(deed: Callable[[], object]) -> int:
    """How many more objects the collector knows after the deed."""
    gc.collect()
    gc.disable()
    try:
        before = len(gc.get_objects())
        deed()
        return len(gc.get_objects()) - before
    finally:
        gc.enable()


@pytest.mark.parametrize(
    "compared", [(), (2, ">", 1), (1.5, "<", 2.5), ("left", "==", "left"), ([1], "==", [1])]
)
def test_a_noted_check_makes_no_object_that_the_collector_knows(compared: tuple[object, ...]) -> None:
    looks = Looks()
    assert new_objects(lambda: looks.checked("test_one.py:3", "a > b", *compared)) == 0
    assert [(check.place, check.text, check.times) for check in looks.noted] == [
        ("test_one.py:3", "a > b", 1)
    ]


@pytest.mark.parametrize("is_variable", [False, True])
@pytest.mark.parametrize("value", [1, 2.5, "text", None])
def test_a_place_that_is_looked_at_makes_no_object_that_the_collector_knows(
    value: object, is_variable: bool
) -> None:
    span = Span("program.py", 1, 0, 1, 5, "<module>")
    sightings = Sightings(1, {1: TextPlace(1, span, "other", 1, "Name", variable=is_variable)})

    def look() -> None:
        other = alike = value
        sightings.switches[0](1)
        sightings.switches[1](other)
        del alike

    assert new_objects(look) == 0
    assert [sighting.place for sighting in sightings.seen()] == [1]
