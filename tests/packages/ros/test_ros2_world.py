"""What nodes of ROS 2 hear is disturbed, and their clocks run apart, over the simulation and over DDS."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.packages.world.belts import project, run
from tests.plugins.test_plugins import python

pytestmark = pytest.mark.skipif(
    find_spec("rclpy") is None or find_spec("greenlet") is None,
    reason="no ROS 2 with greenlet: pip install -r requirements-ros2.lock",
)

FILES = {
    "belt.toml": """
        [[operation]]
        topic = "/pose"
        direction = "receive"
        type = "geometry_msgs/PoseStamped"
        fields."pose.position.x" = { kind = "position", axis = "x", unit = "m", frame = "map" }
        """,
    "belt.py": """
        import rclpy
        from geometry_msgs.msg import PoseStamped, TransformStamped


        class Station:
            def __init__(self):
                self.node = rclpy.create_node("station")
                self.pose = self.node.create_publisher(PoseStamped, "/pose", 10)
                self.frame = self.node.create_publisher(TransformStamped, "/frame", 10)
                self.node.create_timer(0.1, self.say)

            def say(self):
                pose, frame = PoseStamped(), TransformStamped(child_frame_id="camera")
                pose.pose.position.x, frame.transform.translation.x = 1.0, 0.5
                pose.header.stamp = self.node.get_clock().now().to_msg()
                self.pose.publish(pose)
                self.frame.publish(frame)
        """,
    "mission.py": """
        import rclpy
        from geometry_msgs.msg import PoseStamped, TransformStamped
        from rclpy.time import Time


        class Mission:
            def __init__(self):
                self.node = rclpy.create_node("mission")
                self.x, self.camera, self.late = [], [], []
                self.node.create_subscription(PoseStamped, "/pose", self.on_pose, 10)
                self.node.create_subscription(TransformStamped, "/frame", self.on_frame, 10)

            def on_pose(self, pose):
                sent = Time.from_msg(pose.header.stamp)
                self.late.append(abs((self.node.get_clock().now() - sent).nanoseconds) / 1e9)
                self.x.append(pose.pose.position.x)

            def on_frame(self, frame):
                self.camera.append(frame.transform.translation.x)
        """,
    "tests/test_mission.py": """
        import time

        import belt
        import mission
        import rclpy
        from rclpy.executors import SingleThreadedExecutor


        def test_it_knows_where_things_are():
            with rclpy.init(args=[]):
                station, program = belt.Station(), mission.Mission()
                executor = SingleThreadedExecutor()
                for one in (station, program):
                    executor.add_node(one.node)
                end = time.monotonic() + 10.0
                while len(program.x) < 3 and time.monotonic() < end:
                    executor.spin_once(0.02)
                executor.shutdown()
            assert len(program.x) >= 3
            assert max(abs(x - 1.0) for x in program.x) < 0.03
            assert program.camera, "no camera"
            assert max(abs(x - 0.5) for x in program.camera) < 0.03
            assert max(program.late) < 0.8
        """,
}
#: parameter to the function, what is meant, the ladder, and more; the test notices the last magnitude alone
ROWS = {
    "pose": ("bias", "/pose", [0.01, 0.05], 'options = { axis = "x" }'),
    "frame": ("frame_position", "camera", [0.01, 0.05], 'options = { axis = "x" }'),
    "delay": ("delay", "/pose", [0.2, 1.5], ""),
    "loss": ("loss", "/pose", [1.0], ""),
    "late frame": ("frame_delay", "camera", [60.0], ""),
    "lost frame": ("frame_loss", "camera", [1.0], ""),
    "clock": ("clock_offset", "/mission", [0.2, 1.5], 'of = ["rclpy.node:Node"]'),
    "nothing": ("frame_position", "wrist", [1.0], 'options = { axis = "x" }'),
}


def parameters(*names: str) -> str:
    found = []
    for name in names:
        function, meant, ladder, more = ROWS[name]
        found += ["[[tool.mutabot.world.parameter]]", f'name = "{name}"', f'names = "{meant}"', more]
        found += [f'apply = "mutabot_ros.disturbances:{function}"', f"ladder = {ladder}"]
        found += ['directions = ["+"]']
    return "\n".join(found)


@pytest.mark.parametrize(
    ("simulation", "names"),
    [
        ("auto", ("pose", "loss")),
        pytest.param(
            "auto",
            ("frame", "delay", "late frame", "lost frame", "clock", "nothing"),
            marks=pytest.mark.whole,
        ),
        pytest.param("never", tuple(ROWS), marks=pytest.mark.whole),
    ],
)
def test_what_a_node_hears_is_disturbed(simulation: str, names: tuple[str, ...], tmp_path: Path) -> None:
    folder = project(tmp_path, "", **FILES)
    text = (folder / "pyproject.toml").read_text()
    text = text.replace('of = ["belt:Belt"]', 'of = ["rclpy.subscription:Subscription"]')
    text += f'{parameters(*names)}\n[tool.mutabot.ros]\nsimulation = "{simulation}"\n'
    (folder / "pyproject.toml").write_text(text)
    found = run(folder, "-o", "rounds=1")
    for name in names:
        if name == "nothing":
            assert "nothing came that it disturbs" in found["nothing +"]["sentence"]
        else:
            assert found[f"{name} +"]["noticed_from"] == ROWS[name][2][-1], name


GONE = """
import rclpy
from geometry_msgs.msg import PoseStamped
from mutabot_ros import disturbances

rclpy.init(args=[])
node = rclpy.create_node("mission")
subscription = node.create_subscription(PoseStamped, "/pose", lambda one: None, 10)
node.destroy_node()
rclpy.shutdown()
for function, world in ((disturbances.loss, subscription), (disturbances.clock_offset, node)):
    try:
        function(world, float, names="*", random=None, acts=print)
    except LookupError as error:
        print(error)
"""


def test_what_was_destroyed_in_an_earlier_test_is_nothing_to_disturb() -> None:
    done = python(None, "-c", GONE)
    assert done.stdout.splitlines() == ["the last one was destroyed"] * 2, done.stderr
