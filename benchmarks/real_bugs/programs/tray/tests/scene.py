"""The nodes of a test: the program's, and one that plays the gripper."""

import json
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger

from program import LATCHED, STROKE, Trays

STEP = 0.05


class Scene:
    """Use as a context manager. ``between``: what the fingers close on, m; ``order``: of names."""

    def __init__(
        self, between=0.02, works=True, order=("left_finger", "right_finger", "wrist"), **parameters
    ):
        rclpy.init(args=[])
        given = [Parameter(name, value=value) for name, value in parameters.items()]
        self.program = Trays(parameter_overrides=given)
        self.between, self.works, self.order = between, works, order
        self.opening, self.goal, self.motor = STROKE, STROKE, False
        self.log, self.reports, self.heard = [], [], []
        self.world = rclpy.create_node("world")
        self.joints = self.world.create_publisher(JointState, "gripper/joints", 10)
        self.world.create_subscription(Float64, "gripper/command", self.on_command, 10)
        self.world.create_service(SetBool, "gripper/motor", self.on_motor)
        self.asked = {name: self.world.create_client(Trigger, f"trays/{name}") for name in ("take", "give")}
        self.world.create_timer(STEP, self.on_step)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.program)
        self.executor.add_node(self.world)
        self.spin(0.2)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        self.program.destroy_node()
        self.world.destroy_node()
        rclpy.try_shutdown()

    def on_command(self, command):
        self.log.append(("opening", command.data))
        self.goal = STROKE * command.data / 100.0

    def on_motor(self, request, response):
        self.log.append(("motor", request.data))
        self.motor = request.data and self.works
        response.success = self.works
        return response

    def on_step(self):
        goal = max(self.goal, self.between) if self.motor else self.opening
        step = max(-0.01, min(goal - self.opening, 0.01))
        self.opening += step
        message = JointState(name=list(self.order))
        places = {"left_finger": 0.4 * self.opening, "right_finger": 0.6 * self.opening, "wrist": 0.02}
        message.position = [places[name] for name in self.order]
        message.velocity = [0.0 if name == "wrist" else step / STEP for name in self.order]
        self.joints.publish(message)

    def listen(self):
        """Hear the reports from now on, and the last one before."""
        self.world.create_subscription(
            String, "trays/report", lambda report: self.reports.append(json.loads(report.data)), LATCHED
        )
        self.spin(0.1)

    def seen(self):
        """What the world has got from the program."""
        return {"log": list(self.log), "reports": list(self.reports), "opening": self.opening}

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def ask(self, name):
        answer = self.asked[name].call_async(Trigger.Request())
        self.spin(0.05)
        return answer.result().success
