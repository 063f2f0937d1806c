"""What the controller holds of forks that wait for their parent: hundreds of mutants, each with all tests."""

from __future__ import annotations

import pickle

from mutabot.campaign.baseline.baseline import observation
from mutabot.campaign.engines.forks import _RunInForks
from mutabot.evidence.recording import Recording, to_text
from mutabot.model.events import TestEnd
from mutabot.model.mutant import Mutant, Place, Role, Site, Span

SITE = Site(Span("mission.py", 1, 0, 1, 9, "go"), "arm.move", 1, Role.PROGRAM)
MOVE = Mutant(1, "robot", "skip", SITE, "robot:Arm.move", None, None, "", "")


def ended() -> TestEnd:
    trace = tuple((0, [0.1 * number], [number], None) for number in range(1000))
    return TestEnd("tests/test_mission.py::test_mission", "passed", trace=trace)


def test_what_waits_takes_less_than_a_third_of_itself() -> None:
    end = ended()
    seen = observation(end, {0: Place.of(MOVE)})
    run = _RunInForks(MOVE, 0, (end.test,))
    run.hold(end, seen)
    assert not run.held
    assert sum(map(len, run.packed)) < len(pickle.dumps((end, seen))) / 3
    run.unpack()
    assert (run.own, run.observations, run.packed) == ({end.test: end}, {end.test: seen}, [])


def test_short_tests_are_packed_together_and_take_less_than_a_fifth() -> None:
    names = [f"tests/test_mission.py::test_{number}" for number in range(1010)]
    ends = [TestEnd(name, "passed", hits=1, recording=to_text(Recording())) for name in names]
    run = _RunInForks(MOVE, 0, tuple(end.test for end in ends))
    for end in ends:
        run.hold(end, observation(end, {}))
    assert len(run.packed) * 50 + len(run.held) == len(ends)
    assert sum(map(len, run.packed)) < sum(len(pickle.dumps((end, observation(end, {})))) for end in ends) / 5
    run.unpack()
    assert list(run.own.values()) == ends
    assert len(run.observations) == len(ends)
    assert (run.held, run.packed) == ([], [])


def test_a_failed_test_has_nothing_to_compare() -> None:
    end = TestEnd("tests/test_mission.py::test_mission", "failed")
    run = _RunInForks(MOVE, 0, (end.test,))
    run.hold(end, None)
    run.unpack()
    assert (run.own, run.observations) == ({end.test: end}, {})


def test_the_calls_of_a_site_share_what_shows_it() -> None:
    events = observation(ended(), {0: Place.of(MOVE)}).events
    assert len({id(call.key) for call in events}) == 1
