import multiprocessing

import mission
import pytest


def places_of(method, stations):
    context = multiprocessing.get_context(method)
    queue = context.SimpleQueue()
    process = context.Process(target=mission.tour, args=(queue, stations))
    process.start()
    process.join()
    assert process.exitcode == 0
    return queue.get()


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_two_stations(method):
    assert places_of(method, 2) == ([90, 180], 180)


def test_round_trip():
    places, end = places_of("fork", 4)
    assert len(places) == 4
    assert end == 0
