"""What workers saw of tests, with the places of their calls, as it is compared."""

from __future__ import annotations

from collections.abc import Mapping

from mutabot.border.events import SiteSeen, TestEnd
from mutabot.border.job import RefusedAt
from mutabot.campaign.comparing.observation import Event, Observation
from mutabot.campaign.workers.task import Result
from mutabot.model.mutant import Place

from .site_names import Sources


def places_of(result: Result, sources: Sources) -> dict[int, Place]:
    """The places a worker reported, by their index in its traces."""
    return {seen.index: place_of(seen, sources) for seen in result.sites}


def place_of(seen: SiteSeen, sources: Sources) -> Place:
    """The place at which something was seen."""
    return Place(sources.site(seen), seen.operation, seen.pattern)


def observations_of(result: Result, sources: Sources) -> dict[str, Observation]:
    """What is compared of each test of a run."""
    places = places_of(result, sources)
    return {end.test: observation(end, places) for end in result.ends}


def observation(end: TestEnd, places: Mapping[int, Place]) -> Observation:
    """What is compared of a test."""
    events = []
    for index, written, read, _ in end.trace:
        place = places[index]
        events.append(Event(place.key, written, read, (place.operation, place.pattern)))
    prepared, called = end.returned[: end.prepared], end.returned[end.prepared :]
    return Observation(
        events, end.probes, end.truncated, end.unread, end.outcome, prepared, called, end.moments
    )


def refused_of(result: Result) -> dict[str, tuple[RefusedAt, ...]]:
    """The calls that the robot refused in a run, by test."""
    sites = {seen.index: seen for seen in result.sites}
    found: dict[str, tuple[RefusedAt, ...]] = {}
    for end in result.ends:
        numbers: dict[int, set[int]] = {}
        for index, number in end.refused_calls:
            numbers.setdefault(index, set()).add(number)
        if numbers:
            found[end.test] = tuple(
                RefusedAt(
                    sites[index].span, sites[index].operation, sites[index].pattern, tuple(sorted(those))
                )
                for index, those in numbers.items()
            )
    return found
