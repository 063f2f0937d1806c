"""How a mutant's world differs from the original's: when, how far, and what happened, in a sentence."""

from __future__ import annotations

from array import array

import pytest

from mutabot.evidence.differences import noise_between
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.recording import RecordedCall, Recording, Track, TrackKind
from mutabot.evidence.spread import spread_between
from mutabot.evidence.story import diverged
from mutabot.model.world_difference import Diverged
from tests.evidence.worlds import SHELF, TABLE, Place, apart, line, recorded, story

#: up from the shelf, over to the table, down, and away
UP: Place = (0.0, 0.0, 0.825)
OVER: Place = (1.0, 0.0, 0.325)
WAY = [SHELF, *line(SHELF, UP, 1.0), *line(UP, OVER, 2.0), *line(OVER, TABLE, 1.0)]
CARRIED = [*WAY, *line(TABLE, OVER, 1.0)]
BOX = [*WAY, *[TABLE] * 10]
HELD, LYING, THERE = ("box", "gripper"), ("box", "shelf"), ("box", "table")


def held_until(number: int, lands: int | None = 40) -> object:
    """Held until a moment; on the table from another one."""

    def touching(now: int) -> set[tuple[str, str]]:
        found = {LYING} if now == 0 else set()
        if now < number:
            found.add(HELD)
        if lands is not None and now >= lands:
            found.add(THERE)
        return found

    return touching


ORIGINAL = recorded(
    CARRIED, BOX, held_until(41), [RecordedCall(4.0, 4.2, "arm:open", "mission.py:9", None, {}, {})]
)  # type: ignore[arg-type]


def test_equal_recordings_do_not_differ() -> None:
    assert apart(ORIGINAL, recorded(CARRIED, BOX, held_until(41), ORIGINAL.calls)) is None  # type: ignore[arg-type]


def test_a_box_that_slips_is_reported() -> None:
    fallen: Place = (0.5, 0.0, -2.0)
    over_shelf = WAY[:16]
    box = [*over_shelf, *line(over_shelf[-1], fallen, 1.0), *[fallen] * 60][: len(CARRIED)]
    text = story(ORIGINAL, recorded(CARRIED, box, held_until(16, None), ORIGINAL.calls))  # type: ignore[arg-type]
    assert text.startswith(
        "box never touched table (original: at 4.0 s); box was lost at 1.6 s (original: let go at 4.1 s)"
    )
    assert "box ended" in text


def test_a_box_that_is_let_go_too_early_is_reported() -> None:
    dropped = [*WAY[:31], *[TABLE] * 20][: len(CARRIED)]
    opened = [RecordedCall(3.0, 3.2, "arm:open", "mission.py:9", None, {}, {})]
    text = story(ORIGINAL, recorded(CARRIED, dropped, held_until(31, 32), opened))  # type: ignore[arg-type]
    assert text.startswith(
        "box was let go at 3.1 s, 0.3 m above the table (original: at 4.1 s, on the table) "
        "and hit it at 2.5 m/s"
    )


def test_a_box_that_is_held_to_the_end_is_reported() -> None:
    text = story(ORIGINAL, recorded(CARRIED, CARRIED, held_until(99, 40), ORIGINAL.calls))  # type: ignore[arg-type]
    assert "box was never let go (original: at 4.1 s)" in text


def with_fingers(recording: Recording, *openings: float) -> Recording:
    """The recording with fingers that are as far open at its moments, the last to its end."""
    values = [*openings, *openings[-1:] * (len(recording.times) - len(openings))]
    recording.tracks["fingers"] = Track("fingers", TrackKind.VALUE, array("f", values), unit="m")
    return recording


@pytest.mark.parametrize(("far", "differs"), [(5e-9, False), (2e-6, False), (0.004, True)])
def test_the_trembling_of_what_stands_still_is_no_difference(far: float, differs: bool) -> None:
    way = [SHELF] * 9
    still, other = (with_fingers(recorded(way), 0.085, 0.085 + 1e-8, 0.085 + end) for end in (0.0, far))
    assert (apart(still, other) is not None) is differs


def test_what_is_merely_late_is_no_distance() -> None:
    late = [CARRIED[0]] * 5 + CARRIED
    found = apart(recorded(CARRIED), recorded(late))
    assert found is not None
    assert found.story == "the same movements happened up to 0.5 s later"
    assert found.deviation <= 1.0
    (tool,) = found.apart
    assert tool.largest > 0.1
    assert tool.aside == pytest.approx(0.0, abs=1e-3)


def test_a_detour_is_as_far_as_it_leads() -> None:
    detour = [*CARRIED[:20], *((x, 0.2, z) for x, _, z in CARRIED[20:25]), *CARRIED[25:]]
    found = apart(recorded(CARRIED), recorded(detour))
    assert found is not None
    assert found.apart[0].aside == pytest.approx(0.2, abs=0.01)
    assert found.story.startswith("tool left its path by up to 0.2 m but reached the correct end position")
    assert found.at == pytest.approx(2.0, abs=0.11)


def ended_after_a_call(began: float) -> Diverged:
    """A mutant's test that ends at 1.9 s; its last call took 0.3 s."""
    calls = [RecordedCall(began, began + 0.3, "arm:move", "mission.py:8", None, {}, {})]
    original = recorded(CARRIED, BOX, held_until(41), [*calls, *ORIGINAL.calls])  # type: ignore[arg-type]
    mutant = recorded(CARRIED[:20], BOX[:20], held_until(41), calls)  # type: ignore[arg-type]
    found = apart(original, mutant, is_cut=True)
    assert found is not None
    return found


def test_of_a_test_that_was_cut_only_what_was_is_compared() -> None:
    found = apart(recorded(CARRIED), recorded(CARRIED[:20]), is_cut=True)
    assert found is None
    cut = apart(ORIGINAL, recorded(CARRIED[:20], BOX[:20], held_until(41)), is_cut=True)  # type: ignore[arg-type]
    assert cut is not None
    assert cut.story == "the test ended at 1.9 s instead of 5.0 s"
    assert cut.what == "mission.py:9 open is no longer called"
    assert ended_after_a_call(1.2).at == pytest.approx(1.5)


def test_what_equal_runs_differ_by_is_no_difference() -> None:
    shaken = [(x, y + 0.004, z) for x, y, z in CARRIED]
    noise = noise_between(RecordedPaths(recorded(CARRIED)), RecordedPaths(recorded(shaken)))
    other = [(x, y - 0.006, z) for x, y, z in CARRIED]
    assert apart(recorded(CARRIED), recorded(other)) is not None
    assert diverged("t", RecordedPaths(recorded(CARRIED)), RecordedPaths(recorded(other)), noise) is None


def test_rounding_is_no_difference_of_a_call() -> None:
    original = Recording(calls=[RecordedCall(0.0, 1.0, "s:read", "m.py:1", None, {}, {"x": -0.329123321209})])
    mutant = Recording(calls=[RecordedCall(0.5, 1.0, "s:read", "m.py:1", None, {}, {"x": -0.329123321207})])
    assert apart(original, mutant) is None


@pytest.mark.parametrize(
    ("calls", "what"),
    [
        ([("arm:move", {"x": 1.0}), ("arm:grip", {})], "m.py:2 grip is called instead of m.py:2 move"),
        ([("arm:move", {"x": 1.0})], "m.py:2 move is no longer called"),
        ([("arm:move", {"x": 2.0}), ("arm:move", {"x": 1.0})], "m.py:1 move sends x 2 instead of 1"),
    ],
)
def test_the_first_call_that_differs_is_named(calls: list[tuple[str, dict[str, float]]], what: str) -> None:
    def told(made: list[tuple[str, dict[str, float]]]) -> Recording:
        found = [
            RecordedCall(float(number), number + 0.5, name, f"m.py:{number + 1}", None, values, {})
            for number, (name, values) in enumerate(made)
        ]
        return Recording(calls=found)

    original = told([("arm:move", {"x": 1.0}), ("arm:move", {"x": 1.0})])
    found = apart(original, told(calls))
    assert found is not None
    assert found.what == what


def test_a_text_command_is_named_by_its_text() -> None:
    original, mutant = (
        Recording(calls=[RecordedCall(0.0, 0.5, "link:send", "m.py:1", pattern, {}, {})])
        for pattern in ("turn/{angle:g}", "release")
    )
    found = apart(original, mutant)
    assert found is not None
    assert found.what == "m.py:1 send release is called instead of m.py:1 send turn/{angle}"


def with_arm(recording: Recording, height: float) -> Recording:
    """The same with an arm that is drawn."""
    values = array("f", [0.0, 0.0, 0.0, 0.0, 0.0, height]) * len(recording.times)
    recording.tracks["arm"] = Track("arm", TrackKind.LINE, values, radii=(0.05, 0.05))
    return recording


def test_what_is_only_drawn_is_no_difference() -> None:
    places = [*line(SHELF, TABLE, 1.0)]
    assert apart(with_arm(recorded(places), 0.5), with_arm(recorded(places), 0.9)) is None


def test_what_is_only_drawn_changes_nothing_of_a_difference() -> None:
    places, others = [*line(SHELF, TABLE, 1.0)], [*line(SHELF, SHELF, 1.0)]
    bare = apart(recorded(places), recorded(others))
    assert bare is not None
    assert apart(with_arm(recorded(places), 0.5), with_arm(recorded(others), 0.9)) == bare


def test_what_is_only_drawn_changes_no_spread() -> None:
    runs = [recorded([*line(SHELF, (1.0, 0.0, z), 1.0)], [SHELF] * 10) for z in (0.02, 0.03)]
    bare = spread_between([RecordedPaths(run) for run in runs])
    drawn = [with_arm(run, height) for run, height in zip(runs, (0.1, 0.9), strict=True)]
    assert spread_between([RecordedPaths(recording) for recording in drawn]) == bare
