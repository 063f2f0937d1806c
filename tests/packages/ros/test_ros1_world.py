"""What nodes of ROS 1 hear is disturbed, and their clocks run apart, over a real master."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import mutabot_ros
from tests.packages.world.belts import project, run

from .both import MASTER, needs_ros1

FILES = {
    "belt.toml": """
        [[operation]]
        topic = "/pose"
        direction = "receive"
        type = "geometry_msgs/PoseStamped"
        fields."pose.position.x" = { kind = "position", axis = "x", unit = "m", frame = "map" }
        """,
    "belt.py": """
        import time

        import genpy.dynamic
        import rospy
        from geometry_msgs.msg import PoseStamped, TransformStamped

        STAMPED = "geometry_msgs/TransformStamped"
        TEXT = f"{STAMPED}[] transforms\\n{'=' * 80}\\nMSG: {STAMPED}\\n{TransformStamped._full_text}"
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            TFMessage = genpy.dynamic.generate_dynamic("tf2_msgs/TFMessage", TEXT)["tf2_msgs/TFMessage"]


        class Station:
            def __init__(self):
                self.pose = rospy.Publisher("/pose", PoseStamped, queue_size=10)
                self.frames = rospy.Publisher("/tf", TFMessage, queue_size=10)

            def say(self):
                now = rospy.Time.from_sec(time.time())
                pose = PoseStamped()
                pose.pose.position.x, pose.header.stamp = 1.0, now
                frames = [TransformStamped(child_frame_id=name) for name in ("camera", "wrist")]
                for frame in frames:
                    frame.header.stamp, frame.header.frame_id = now, "base"
                    frame.transform.translation.x, frame.transform.rotation.w = 0.5, 1.0
                self.pose.publish(pose)
                self.frames.publish(TFMessage(transforms=frames))
        """,
    "mission.py": """
        import time

        import rospy
        from belt import TFMessage
        from geometry_msgs.msg import PoseStamped

        try:
            import tf2_ros
        except ImportError:
            tf2_ros = None


        class Mission:
            def __init__(self):
                self.x, self.late, self.frames = [], [], {}
                rospy.Subscriber("/pose", PoseStamped, self.on_pose)
                if tf2_ros is not None:
                    self.buffer = tf2_ros.Buffer()
                    self.listener = tf2_ros.TransformListener(self.buffer)
                else:
                    rospy.Subscriber("/tf", TFMessage, self.on_frames)

            def on_pose(self, pose):
                self.late.append(abs((rospy.Time.now() - pose.header.stamp).to_sec()))
                self.x.append(pose.pose.position.x)

            def on_frames(self, message):
                assert message._connection_header["callerid"] == "/mission"  # tf2 asks for it
                for one in message.transforms:
                    self.frames[one.child_frame_id] = one

            def frame(self, name):
                if tf2_ros is None:
                    return self.frames.get(name)
                try:
                    return self.buffer.lookup_transform("base", name, rospy.Time())
                except tf2_ros.TransformException:
                    return None
        """,
    "conftest.py": MASTER,
    "tests/test_mission.py": """
        import time

        import belt
        import mission
        import pytest
        import rospy


        @pytest.fixture(scope="session")
        def node(master):
            rospy.init_node("mission", disable_rosout=True, disable_signals=True)


        def test_it_knows_where_things_are(node):
            station, program = belt.Station(), mission.Mission()
            end = time.monotonic() + 15.0
            while not (len(program.x) >= 3 and program.frame("wrist")) and time.monotonic() < end:
                station.say()
                time.sleep(0.05)
            wrist, camera = program.frame("wrist"), program.frame("camera")
            assert abs(wrist.transform.translation.x - 0.5) < 0.03
            assert camera is not None, "no camera"
            assert abs(camera.transform.translation.x - 0.5) < 0.03
            assert abs(camera.transform.rotation.z) < 0.2
            assert len(program.x) >= 3
            assert max(abs(x - 1.0) for x in program.x) < 0.03
            assert max(program.late) < 20.0
        """,
}
#: parameter, with its direction, to what is meant of it and the ladder; the test notices the last one alone
ROWS = {
    "position x +": ("/pose", [10, 50]),
    "frame x -": ("camera", [10, 50]),
    "frame turned +": ("camera", [10, 50]),
    "frame delay": ("camera", [60000]),
    "frame loss": ("camera", [100]),
    "delay": ("/pose", [1, 60000]),
    "loss": ("/pose", [100]),
    "clock offset +": ("/mission", [200, 60000]),
    "clock rate +": ("/nobody", [5]),
}


def parameters(*rows: str) -> str:
    """The shipped parameters, with other ladders."""
    text = Path(mutabot_ros.__file__).with_name("ros1.toml").read_text(encoding="utf-8")
    shipped = tomllib.loads(text)
    found = [f"of = {shipped['of']}"]
    for row in rows:
        name = row.rstrip(" +-")
        (table,) = [known_table for known_table in shipped["parameter"] if known_table["name"] == name]
        meant, ladder = ROWS[row]
        directions = [row[-1]] if row[-1] in "+-" else []
        keys = {"name": name, "apply": table["apply"], "names": meant, "directions": directions}
        keys |= {key: table[key] for key in ("of", "change", "unit") if key in table}
        found += [
            "[[tool.mutabot.world.parameter]]",
            *(f"{key} = {value_given!r}" for key, value_given in keys.items()),
        ]
        found += [f"ladder = {ladder}"]
        found += [f'options = {{ axis = "{table["options"]["axis"]}" }}'] if "options" in table else []
    return "\n".join(found)


@needs_ros1
@pytest.mark.parametrize(
    "rows",
    [
        ("position x +", "frame loss"),
        pytest.param(tuple(ROWS), marks=pytest.mark.whole),
    ],
)
def test_what_a_node_hears_is_disturbed(rows: tuple[str, ...], tmp_path: Path) -> None:
    folder = project(tmp_path, "", **FILES)
    text = (folder / "pyproject.toml").read_text().replace('of = ["belt:Belt"]', parameters(*rows))
    (folder / "pyproject.toml").write_text(text)
    found = run(folder, "-o", "rounds=1")
    for row in rows:
        if row.startswith("clock rate"):
            assert "no node is named '/nobody'; the last one is /mission" in found[row]["sentence"]
        else:
            assert found[row]["noticed_from"] == ROWS[row][1][-1], found[row]
