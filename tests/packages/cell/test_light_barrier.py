from __future__ import annotations

import pytest

from mutabot_cell import Box, Cell, LightBarrier, Scene, SensorError

ACROSS = LightBarrier("gate", (0.55, -0.5, 1.02), (0.55, 0.5, 1.02))
BESIDE = LightBarrier("exit", (0.70, -0.5, 1.02), (0.70, 0.5, 1.02))
SHORT = LightBarrier("short", (0.55, -0.5, 1.02), (0.55, 0.0, 1.02))
HIGH = LightBarrier("high", (0.55, -0.5, 1.06), (0.55, 0.5, 1.06))


def guarded(*barriers: LightBarrier) -> Cell:
    return Cell(1, scene=Scene(light_barriers=barriers, parts=(Box(jitter=0.0),)))


def test_only_what_stands_between_lamp_and_receiver_interrupts_the_beam() -> None:
    barriers = guarded(ACROSS, BESIDE, SHORT, HIGH).sensors.light_barriers
    seen = {name: barriers.is_interrupted(name) for name in ("gate", "exit", "short", "high")}
    assert seen == {"gate": True, "exit": False, "short": False, "high": False}
    assert barriers.is_interrupted(), "without a name, the first one"


def test_a_beam_is_free_again_when_the_part_has_left_it() -> None:
    cell = guarded(ACROSS)
    cell.simulation.data.joint("box").qpos[0] += 0.1
    cell.simulation.tick()
    assert not cell.sensors.light_barriers.is_interrupted()


def test_marks_on_the_floor_do_not_stop_light_and_the_robot_does() -> None:
    through_mark = LightBarrier("mark", (-0.4, 0.15, 0.80), (-0.4, 0.15, 0.7601))
    through_base = LightBarrier("base", (-0.5, 0.0, 1.0), (0.5, 0.0, 1.0))
    barriers = guarded(through_mark, through_base).sensors.light_barriers
    assert not barriers.is_interrupted("mark")
    assert barriers.is_interrupted("base")


@pytest.mark.parametrize(("rate", "period"), [(100.0, 1), (25.0, 4), (10.0, 10)])
def test_it_looks_at_its_rate_and_holds_what_it_saw(rate: float, period: int) -> None:
    cell = guarded(LightBarrier("gate", ACROSS.start, ACROSS.end, rate=rate))
    box = cell.simulation.data.joint("box")
    seen = []
    for tick in range(40):
        box.qpos[0] = 0.55 if tick < 15 else 0.75
        cell.simulation.tick()
        seen.append(cell.sensors.light_barriers.is_interrupted())
    changes = [tick + 1 for tick in range(1, 40) if seen[tick] != seen[tick - 1]]
    assert len(changes) == 1
    assert changes[0] % period == 0
    assert 16 <= changes[0] < 16 + period


def test_what_passes_between_two_looks_is_missed() -> None:
    cell = guarded(LightBarrier("gate", ACROSS.start, ACROSS.end, rate=10.0))
    box = cell.simulation.data.joint("box")
    box.qpos[0] = 0.75
    cell.wait(0.2)
    seen = []
    for tick in range(20):
        box.qpos[0] = 0.55 if 3 <= tick < 7 else 0.75
        cell.simulation.tick()
        seen.append(cell.sensors.light_barriers.is_interrupted())
    assert not any(seen)


def test_an_unknown_light_barrier_is_a_sensor_error_that_lists_those_there_are() -> None:
    with pytest.raises(SensorError, match="there are: gate"):
        guarded(ACROSS).sensors.light_barriers.is_interrupted("door")
    with pytest.raises(SensorError, match="none"):
        guarded().sensors.light_barriers.is_interrupted()
