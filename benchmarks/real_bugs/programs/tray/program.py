"""A node that takes trays with a gripper and counts them."""

import json

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool, Trigger

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: per cent of the stroke
OPEN, CLOSED = 100.0, 0.0
#: m: between the fingers, with a tray in them
TRAY = (0.018, 0.022)
STROKE = 0.08
PATIENCE = 1.5


class Trays(Node):
    """The program."""

    def __init__(self, **options):
        super().__init__("trays", **options)
        self.declare_parameter("attempts", 2)
        self.command = self.create_publisher(Float64, "gripper/command", 10)
        self.report = self.create_publisher(String, "trays/report", LATCHED)
        self.create_subscription(JointState, "gripper/joints", self.on_joints, 10)
        self.motor = self.create_client(SetBool, "gripper/motor")
        self.create_service(Trigger, "trays/take", self.on_take)
        self.create_service(Trigger, "trays/give", self.on_give)
        self.patience = self.create_timer(PATIENCE, self.on_no_tray, autostart=False)
        self.state, self.attempts, self.taken = "idle", 0, 0
        self.opening = None

    def on_joints(self, joints):
        """The fingers, each by its name: how far they are apart."""
        places = dict(zip(joints.name, joints.position))
        if "left_finger" not in places or "right_finger" not in places:
            return
        self.opening = places["left_finger"] + places["right_finger"]
        speeds = dict(zip(joints.name, joints.velocity))
        stands = abs(speeds["left_finger"]) < 0.001
        if self.state == "closing" and stands and self.holds():
            self.patience.cancel()
            self.taken += 1
            self.become("holding")

    def holds(self):
        return TRAY[0] <= self.opening <= TRAY[1]

    def on_take(self, request, response):
        if self.state not in ("idle", "failed"):
            response.message = f"not while it is {self.state}"
            return response
        self.attempts = 0
        answer = self.motor.call_async(SetBool.Request(data=True))
        answer.add_done_callback(self.on_motor)
        self.become("starting")
        response.success = True
        return response

    def on_motor(self, answer):
        if answer.result().success:
            self.close()
        else:
            self.become("failed")

    def close(self):
        self.attempts += 1
        self.become("closing")
        self.command.publish(Float64(data=CLOSED))
        self.patience.reset()

    def on_no_tray(self):
        self.patience.cancel()
        self.command.publish(Float64(data=OPEN))
        if self.attempts < self.get_parameter("attempts").value:
            self.close()
        else:
            self.motor.call_async(SetBool.Request(data=False))
            self.become("failed")

    def on_give(self, request, response):
        response.success = self.state == "holding"
        if response.success:
            self.command.publish(Float64(data=OPEN))
            self.motor.call_async(SetBool.Request(data=False))
            self.become("idle")
        return response

    def become(self, state):
        self.state = state
        millimetres = None if self.opening is None else round(1000.0 * self.opening, 1)
        told = {"state": state, "taken": self.taken, "opening": millimetres}
        self.report.publish(String(data=json.dumps(told)))
