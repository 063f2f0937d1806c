"""Probes deviate in units of the original's own spread; angles, orientations and clocks by what they mean."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.vocabulary_fit import refuse_unfit
from mutabot.campaign.comparison import Difference, Observation, ProbeSpread, TraceCall, compare, farthest
from mutabot.campaign.verdict import stable_first
from mutabot.errors import ConfigurationError
from mutabot.model import Kind, Path, Probe, Quantity, Vocabulary
from mutabot.model.events import TestEnd

TARGET = "cell:world"


def part(path: str, kind: Kind, **meaning: Any) -> Quantity:
    return Quantity(path, Path.parse(path, rooted=False), kind=kind, **meaning)


#: what the work cell's own probe is marked with
MARKED = Probe(
    TARGET,
    tolerance=0.001,
    result=(
        part('["*tool"]', Kind.EULER, unit="deg", order="xyz"),
        part('["*.tilt"]', Kind.ANGLE, unit="deg"),
        part(".time", Kind.STAMP),
    ),
)
WORLD = {
    "tool.x": 0.5,
    "tool.theta_x": 180.0,
    "tool.theta_y": 0.0,
    "tool.theta_z": 90.0,
    "box.tilt": 0.0,
    "time": 10.0,
}


def seen(prefix: str = "", **changes: float) -> Observation:
    values = {**WORLD, **{name.replace("__", "."): value for name, value in changes.items()}}
    return Observation(probes={f"{TARGET}.{prefix}{name}": value for name, value in values.items()})


def spread(*runs: Observation) -> ProbeSpread:
    return ProbeSpread.between(runs[0], runs[1:], [MARKED])


@pytest.mark.parametrize("prefix", ["", "left/"])
def test_the_same_orientation_a_full_turn_apart_is_no_difference(prefix: str) -> None:
    found = compare(seen(prefix), seen(prefix, tool__theta_x=-180.0), [MARKED])
    assert found.indistinguishable
    assert found.distance == pytest.approx(0.0, abs=1e-6)


def test_an_orientation_is_turned_by_one_angle() -> None:
    found = compare(seen(), seen(tool__theta_x=0.0, tool__theta_y=180.0, tool__theta_z=280.0), [MARKED])
    (line,) = found.divergence
    assert line.startswith("world.tool: ")
    assert line.endswith("(turned by 10 deg)")
    assert found.distance == pytest.approx(10.0 / 0.5)


def test_degrees_weigh_by_their_own_tolerance() -> None:
    found = compare(seen(), seen(box__tilt=80.0, tool__x=0.6), [MARKED])
    assert found.distance == pytest.approx(160.0)
    assert [line.partition(":")[0] for line in found.divergence] == ["world.box.tilt", "world.tool.x"]


def test_a_clock_is_named_as_one_and_is_no_distance() -> None:
    found = compare(seen(), seen(time=13.2), [MARKED])
    assert found.divergence == ("the clock world.time: 13.2 s instead of 10 s (3.2 s later)",)
    assert not found.indistinguishable
    assert found.distance == pytest.approx(0.0, abs=1e-6)


def test_a_probe_deviates_in_units_of_the_originals_spread() -> None:
    runs = [seen(), seen(tool__x=0.52), seen(tool__x=0.49)]
    mutant = seen(tool__x=0.7, box__tilt=2.0)
    assert compare(runs[0], mutant, [MARKED]).divergence[0].startswith("world.tool.x")
    found = compare(runs[0], mutant, [MARKED], spread=spread(*runs))
    assert found.distance == pytest.approx(0.2 / 0.02)
    assert not compare(runs[0], seen(tool__x=0.51), [MARKED], spread=spread(*runs)).indistinguishable


def test_what_spreads_comes_after_what_is_always_the_same() -> None:
    runs = [seen(), seen(tool__x=0.9)]
    found = compare(runs[0], seen(tool__x=0.7, box__tilt=2.0), [MARKED], spread=spread(*runs))
    assert found.divergence[0].startswith("world.box.tilt")


def test_along_the_way_spreads_count_too() -> None:
    def along(x: float) -> Observation:
        read = {f"{TARGET}.tool.x": x}
        return Observation([TraceCall("a.py:1 move")], seen().probes, moments=[(1, read, True)])

    runs = [along(0.5), along(0.6)]
    assert compare(along(0.5), along(0.8), [MARKED]).way == pytest.approx(300.0)
    assert compare(along(0.5), along(0.8), [MARKED], spread=spread(*runs)).way == pytest.approx(3.0)


def first_words(found: Difference) -> list[str]:
    return [line.partition(":")[0].partition(",")[0] for line in found.divergence]


@pytest.mark.parametrize(
    ("end", "lines"),
    [
        ({"tool__theta_z": 90.2}, ["on the way", "world.tool"]),
        ({"tool__theta_z": 91.0}, ["world.tool", "on the way"]),
        ({"tool__theta_z": 90.2, "time": 11.7}, ["on the way", "the clock world.time", "world.tool"]),
        ({"tool__theta_z": 90.2, "time": 10.05}, ["on the way", "world.tool", "the clock world.time"]),
    ],
)
def test_an_end_within_the_originals_spread_is_reported_after_a_detour_and_a_delay(
    end: dict[str, float], lines: list[str]
) -> None:
    def along(y: float, **changes: float) -> Observation:
        read = {f"{TARGET}.driver.y": y}
        return Observation([TraceCall("a.py:1 move")], seen(**changes).probes, moments=[(1, read, True)])

    assert first_words(compare(along(0.08), along(-0.08, **end), [MARKED])) == lines


def test_the_test_with_the_detour_is_reported_before_one_whose_end_is_nearly_the_same() -> None:
    same = Difference(False, 0.06, ("world.tool: turned by 0.03 deg",), way=0.1)
    detour = Difference(False, 0.02, ("on the way: off by 0.16",), way=160.0)
    elsewhere = Difference(False, 3.0, ("world.box: off by 3 mm",), way=3.0)
    told = farthest([same, detour, elsewhere]).divergence
    assert told == (*elsewhere.divergence, *detour.divergence, *same.divergence)


def test_lines_name_calls_without_columns() -> None:
    before = Observation([TraceCall("sorting.py:118:4-118:93 Arm.move_by", {"z": 1.0})])
    after = Observation([TraceCall("sorting.py:118:4-118:93 Arm.move_by", {"z": 2.0})])
    (line,) = compare(before, after).divergence
    assert line.startswith("call 1, sorting.py:118 Arm.move_by: wrote ")


def test_a_pattern_of_parts_may_stand_for_none() -> None:
    end = TestEnd("test", "passed", probes={f"{TARGET}.time": 1.0})
    baseline = Baseline(ends={(0, "test"): end})
    refuse_unfit(baseline, Vocabulary(probes=(MARKED,)))
    whole = Probe(TARGET, result=(part(".tool", Kind.EULER, unit="deg", order="xyz"),))
    with pytest.raises(ConfigurationError, match="never reads such a part"):
        refuse_unfit(baseline, Vocabulary(probes=(whole,)))


def test_a_test_whose_end_scatters_comes_last() -> None:
    lost = Difference(False, 400.0, ("box.x: lost",), way=9.0)
    placed = Difference(False, 3.0, ("box.x: placed",), way=2.0)
    both = {"lost": lost, "placed": placed}
    assert stable_first(both, {"lost"}) == Difference(False, 3.0, ("box.x: placed", "box.x: lost"), way=2.0)
    assert stable_first(both, set()).divergence[0] == "box.x: lost"
    assert stable_first({"lost": lost}, {"lost"}) == lost


def test_runs_in_which_something_else_was_to_be_done_are_no_spread() -> None:
    red, again, blue = (
        replace(seen(tool__x=x), events=(TraceCall("mission.py:5 Sensor.colour", read={"result": colour}),))
        for x, colour in ((0.5, "red"), (0.502, "red"), (0.7, "blue"))
    )
    assert spread(red, again, blue).ends[f"{TARGET}.tool.x"] == pytest.approx(0.002)
    assert spread(red, blue).ends[f"{TARGET}.tool.x"] == pytest.approx(0.2)


@pytest.mark.parametrize(("x", "expected"), [(0.8, ["world.tool.x"]), (0.5, ["world.tool"])])
def test_beside_what_matters_differences_far_below_the_spread_are_left_out(
    x: float, expected: list[str]
) -> None:
    found = compare(seen(), seen(tool__x=x, tool__theta_z=90.005), [MARKED])
    assert [line.partition(":")[0] for line in found.divergence] == expected
    assert not found.indistinguishable
