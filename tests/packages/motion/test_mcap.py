"""Recordings for Foxglove, read back by the library of MCAP."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from packages.motion.sample import STEPS, shown

pytest.importorskip("foxglove")
pytest.importorskip("mcap")

from mutabot_motion import mcap
from mutabot_motion.viewers import written


class Found:
    """All of a file: decoded messages with their times by topic, and the names of their schemas."""

    def __init__(self, file: Path) -> None:
        from mcap.reader import make_reader  # noqa: PLC0415  # only tests need it
        from mcap_protobuf.decoder import DecoderFactory  # noqa: PLC0415  # likewise

        self.messages: dict[str, list[tuple[float, Any]]] = defaultdict(list)
        self.schemas: dict[str, str] = {}
        factory = DecoderFactory()
        with file.open("rb") as opened:
            reader = make_reader(opened)
            for schema, channel, message in reader.iter_messages():
                assert schema is not None
                decode = factory.decoder_for(channel.message_encoding, schema) or json.loads
                self.messages[channel.topic].append((message.log_time / 1e9, decode(message.data)))
                self.schemas[channel.topic] = schema.name
            self.about = {record.name: record.metadata for record in reader.iter_metadata()}


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Found:
    file = tmp_path_factory.mktemp("mcap") / "a.mcap"
    said = written(mcap, file, shown())
    assert said.startswith(f"{file}: ")
    return Found(file)


def test_topics_have_the_schemas_of_foxglove(found: Found) -> None:
    for side in ("original", "mutant"):
        assert found.schemas[f"/{side}/tool/pose"] == "foxglove.PoseInFrame"
        assert found.schemas[f"/{side}/a_box/frame"] == "foxglove.FrameTransform"
        assert found.schemas[f"/{side}/a_box/shape"] == "foxglove.SceneUpdate"
        assert found.schemas[f"/{side}/paths"] == "foxglove.SceneUpdate"
        assert found.schemas[f"/{side}/log"] == "foxglove.Log"
    assert found.schemas["/blocks"] == "foxglove.SceneUpdate"


def test_poses_come_at_their_simulated_times(found: Found) -> None:
    poses = found.messages["/mutant/tool/pose"]
    assert len(poses) == STEPS
    time, pose = poses[10]
    assert time == pytest.approx(1.0)
    assert pose.frame_id == "world"
    assert pose.timestamp.seconds == 1
    assert pose.pose.position.x == pytest.approx(0.5)
    assert pose.pose.orientation.w == 1.0


def test_a_thing_is_a_frame_that_its_shape_moves_with(found: Found) -> None:
    (_, shape), (_, frame) = (
        found.messages["/mutant/a_box/shape"][0],
        found.messages["/mutant/a_box/frame"][-1],
    )
    entity = shape.entities[0]
    assert entity.frame_id == frame.child_frame_id
    assert entity.cubes[0].size.x == pytest.approx(0.05)
    assert frame.translation.z == pytest.approx(0.025)


def test_values_blocks_and_what_it_is_are_there(found: Found) -> None:
    assert found.messages["/mutant/opening"][0][1] == {"value": pytest.approx(0.05), "unit": "m"}
    block = found.messages["/blocks"][0][1].entities[0]
    assert (block.id, block.cubes[0].size.z) == ("the <table>", pytest.approx(0.1))
    assert found.about["mutabot"]["id"] == "mission.py:run:grip#1:call:skip"
    assert found.about["mutabot"]["fault"] == "1.000 s"


def test_the_log_names_commands_contacts_and_the_fault(found: Found) -> None:
    told = [line for _, line in found.messages["/mutant/log"]]
    assert [line.message for line in told][:2] == ["Arm.move_by dx=1", "FAULT: grip: do nothing → it opens"]
    assert (told[0].file, told[0].line) == ("mission.py", 3)
    assert told[1].level > told[0].level


def test_messages_lie_in_the_order_of_their_times(found: Found) -> None:
    for lines in found.messages.values():
        times = [time for time, _ in lines]
        assert times == sorted(times)


def test_an_earlier_file_is_written_over(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    for _ in range(2):
        written(mcap, file, shown(mutant=None))
    assert "/mutant/log" not in Found(file).messages
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]
