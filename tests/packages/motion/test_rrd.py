"""Recordings for Rerun, read back by Rerun's own library."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.evidence.paths import RecordedPaths
from mutabot_motion.viewers import viewers_of
from packages.motion.sample import STEPS, recording, shown

pytest.importorskip("rerun")

from mutabot_motion import rrd


def chunks(file: Path) -> list[Any]:
    from rerun.chunk import RrdReader  # noqa: PLC0415  # an extra

    return list(RrdReader(file).stream().to_chunks())


def column(found: list[Any], entity: str, name: str) -> list[Any]:
    for chunk in found:
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and name in batch.schema.names:
            return [value for row in batch.column(name).to_pylist() for value in row]
    raise AssertionError(f"no {name} of {entity}")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    file = tmp_path_factory.mktemp("rrd") / "a.rrd"
    rrd.write(file, shown())
    return chunks(file)


def test_both_sides_have_their_things_paths_values_and_log(written: list[Any]) -> None:
    entities = {chunk.entity_path for chunk in written}
    for side in ("original", "mutant"):
        for name in ("things/tool", r"things/a\ box", "paths/tool", "values/opening", "log"):
            assert f"/{side}/{name}" in entities
    assert r"/blocks/the\ \<table\>" in entities


def test_poses_come_at_their_simulated_times(written: list[Any]) -> None:
    where = column(written, "/mutant/things/tool", "Transform3D:translation")
    assert len(where) == STEPS
    assert where[10] == pytest.approx([0.5, 0.0, 0.3])
    assert column(written, "/mutant/things/tool", "Transform3D:quaternion")[0] == [0.0, 0.0, 0.0, 1.0]
    moved = next(
        chunk for chunk in written if chunk.entity_path == "/mutant/things/tool" and chunk.timeline_names
    )
    assert moved.timeline_names == ["simulated time"]


def test_the_log_names_commands_contacts_and_the_fault(written: list[Any]) -> None:
    told = column(written, "/mutant/log", "TextLog:text")
    assert told == [
        "Arm.move_by dx=1 (mission.py:3)",
        "FAULT: grip: do nothing → it opens",
        "a box and fingers no longer touch",
        "Camera.find reads x=0.5 (tests/see.py:8)",
    ]
    assert column(written, "/mutant/log", "TextLog:level")[1] == "WARN"
    assert not any("FAULT" in line for line in column(written, "/original/log", "TextLog:text"))


def test_without_a_mutants_recording_the_original_is_there_alone(tmp_path: Path) -> None:
    rrd.write(tmp_path / "a.rrd", shown(mutant=None))
    entities = {chunk.entity_path for chunk in chunks(tmp_path / "a.rrd")}
    assert "/original/things/tool" in entities
    assert not any(name.startswith("/mutant") for name in entities)


def test_times_of_the_wall_clock_are_called_so(tmp_path: Path) -> None:
    rrd.write(tmp_path / "a.rrd", shown(original=RecordedPaths(recording(is_simulated=False)), mutant=None))
    assert {name for chunk in chunks(tmp_path / "a.rrd") for name in chunk.timeline_names} == {"wall clock"}


def test_without_a_screen_the_viewer_is_not_opened_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    (sight,) = viewers_of(tmp_path, rerun=True, rrd=None, mcap=None)
    said = sight(shown())
    assert (tmp_path / "mutant-7-round-2.rrd").read_bytes().startswith(b"RRF2")
    assert "there is no screen to open its viewer on" in said


def test_an_arm_is_a_strip_at_each_moment(written: list[Any]) -> None:
    strips = column(written, "/mutant/robot/arm", "LineStrips3D:strips")
    assert len(strips) == STEPS
    assert strips[10] == [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], pytest.approx([0.5, 0.0, 0.3])]
