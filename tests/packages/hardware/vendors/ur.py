"""A controller of Universal Robots: the secondary interface, which takes URScript, RTDE, and the dashboard.

Its arm is where it was last sent to, at once. It reads motions from the URScript text itself, and from the
registers in which ur_rtde's control script finds its commands.
"""

from __future__ import annotations

import re
import socket
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from tests.packages.hardware.vendors.controller import ADDRESS, Controller, Vendor, exactly, listening

DASHBOARD, SECONDARY, REALTIME, RTDE = 29999, 30002, 30003, 30004
_MOVE = re.compile(r"(move[jlp]|servoc)\((p?)\[([^\]]*)\]")
#: ur_rtde's own numbers of the commands that its control script knows
COMMANDS = {1: "movej", 2: "movej_ik", 3: "movel", 4: "movel_fk"}
_NONE, _WATCHDOG, _STOP = 0, 99, 255
_FORMATS = {"INT32": "i", "UINT32": "I", "DOUBLE": "d", "VECTOR6D": "6d", "UINT8": "B", "UINT64": "Q"}


@dataclass
class UrController(Controller):
    """The controller and its arm.

    Attributes:
        pose: of the tool: m, and a rotation vector, rad.
        registers: of RTDE, by name.
        is_running: whether a program runs.
    """

    pose: list[float] = field(default_factory=lambda: [0.3, 0.0, 0.4, 0.0, 3.14, 0.0])
    registers: dict[str, float] = field(default_factory=lambda: {"output_int_register_0": 1})
    is_running: bool = False
    turn: threading.Lock = field(default_factory=threading.Lock)

    def secondary(self, connection: socket.socket) -> None:
        """Send the state again and again, and take programs in between."""
        connection.settimeout(0.02)
        rest = ""
        while True:
            connection.sendall(_state(self.pose))
            try:
                data = connection.recv(1 << 16)
            except TimeoutError:
                continue
            if not data:
                return
            *lines, rest = (rest + data.decode()).split("\n")
            for line in filter(str.strip, lines):
                self.carry_out(line)

    def carry_out(self, line: str) -> None:
        """Do what a line of URScript says."""
        found = _MOVE.search(line)
        if found is None:
            self.note(line.strip())
            return
        numbers = tuple(float(number) for number in found[3].split(","))
        self.note(found[1], *numbers)
        if found[2]:
            self.pose = list(numbers)

    def script(self, connection: socket.socket) -> None:
        """Take the control script of ur_rtde, which runs from then on, and scripts of the program."""
        text = ""
        while data := connection.recv(1 << 16):
            text += data.decode()
            if not text.endswith("\nend\n"):  # the outermost one
                continue
            if self.is_running:
                self.note("script")
            self.is_running, text = True, ""

    def dashboard(self, connection: socket.socket) -> None:
        connection.sendall(b"Connected: Universal Robots Dashboard Server\n")
        answers = {
            "PolyscopeVersion": "URSoftware 5.11.1.108318 (Sep 22 2021)", "is in remote control": "true",
            "get serial number": "20195500001", "get robot model": "UR5",
        }  # fmt: skip
        with connection.makefile("r") as lines:
            for line in lines:
                connection.sendall(answers.get(line.strip(), "Stopped").encode() + b"\n")

    def rtde(self, connection: socket.socket) -> None:
        """Answer the set-up, then send outputs, and take inputs."""
        recipes: list[list[str]] = []
        outputs: list[str] = []
        while True:
            size, kind = struct.unpack("!HB", exactly(connection, 3))
            data = exactly(connection, size - 3)
            match chr(kind):
                case "V":
                    _send(connection, kind, b"\x01")
                case "v":
                    _send(connection, kind, struct.pack("!4I", 5, 11, 1, 108318))
                case "O":
                    outputs = data[8:].decode().strip(",").split(",")
                    _send(connection, kind, b"\x01" + ",".join(map(_type, outputs)).encode())
                case "I":
                    recipes.append(data.decode().strip(",").split(","))
                    types = ",".join(map(_type, recipes[-1]))
                    _send(connection, kind, bytes([len(recipes)]) + types.encode())
                case "S":
                    _send(connection, kind, b"\x01")
                    threading.Thread(target=self._feed, args=(connection, outputs), daemon=True).start()
                case "P":
                    _send(connection, kind, b"\x01")
                case "U":
                    self._take(recipes[data[0] - 1], data[1:])

    def _feed(self, connection: socket.socket, outputs: list[str]) -> None:
        while True:
            try:
                _send(connection, ord("U"), b"\x01" + b"".join(map(self._packed, outputs)))
            except OSError:
                return
            time.sleep(0.008)

    def _packed(self, name: str) -> bytes:
        form = "!" + _FORMATS[_type(name)]
        if name in ("actual_TCP_pose", "target_TCP_pose"):
            return struct.pack(form, *self.pose)
        if name == "robot_status_bits":
            return struct.pack(form, 1 | self.is_running << 1)
        if name in ("safety_status_bits", "runtime_state"):
            return struct.pack(form, 1 + (self.is_running and name == "runtime_state"))
        count = 6 if form == "!6d" else 1
        return struct.pack(form, *[self.registers.get(name, 0)] * count)

    def _take(self, names: list[str], data: bytes) -> None:
        """What the control script does with the registers that a client has written."""
        form = "!" + "".join(_FORMATS[_type(name)] for name in names)
        with self.turn:
            values = dict(zip(names, struct.unpack(form, data[: struct.calcsize(form)]), strict=True))
            self.registers |= values
            command = values.get("input_int_register_0")
            if command == _NONE:
                self.registers["output_int_register_0"] = 1  # ready
            elif command == _STOP:
                self.is_running = False
            elif command is not None and command != _WATCHDOG:
                numbers = [value for name, value in values.items() if "double" in name]
                name = COMMANDS.get(int(command), f"command {command}")
                self.note(name, *(numbers[:6] if name.startswith("move") else numbers))
                if name in ("movel", "movej_ik"):
                    self.pose = numbers[:6]
                self.registers["output_int_register_0"] = 2  # done


def _type(name: str) -> str:
    if "int_register" in name:
        return "INT32"
    if "double_register" in name:
        return "DOUBLE"
    if name.endswith(("_pose", "_q", "_qd", "_speed", "_force", "_torque")):
        return "VECTOR6D"
    if name.endswith(("_mask", "digital_output")):
        return "UINT8"
    return "UINT32" if name.endswith(("_bits", "_state")) else "DOUBLE"


def _send(connection: socket.socket, kind: int, data: bytes) -> None:
    connection.sendall(struct.pack("!HB", 3 + len(data), kind) + data)


def _state(pose: list[float]) -> bytes:
    """A robot state message of the secondary interface, as software 3.2 sends it."""
    mode = struct.pack("!Q???????BBddd", 0, True, True, True, False, False, False, False, 7, 0, 1.0, 1.0, 1.0)
    joints = struct.pack("!dddffffB", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 253) * 6
    board = struct.pack("!iibbddbbddffffBBb", 0, 0, *(0,) * 2, 0.0, 0.0, 0, 0, *(0.0,) * 6, 0, 0, 0)
    parts = [(0, mode), (1, joints), (3, board), (4, struct.pack("!12d", *pose, *[0.0] * 6))]
    body = b"".join(struct.pack("!iB", 5 + len(data), kind) + data for kind, data in parts)
    return struct.pack("!iB", 5 + len(body), 16) + body


@contextmanager
def serve() -> Iterator[Controller]:
    controller = UrController(address=ADDRESS)
    answers = (controller.dashboard, controller.secondary, controller.script, controller.rtde)
    with listening(*answers, ports=(DASHBOARD, SECONDARY, REALTIME, RTDE)):
        yield controller


_GUARD = """
    [guard]
    box = [{ x = [0.2, 0.5], y = [-0.3, 0.3], z = [0.1, 0.6], frame = "base" }]
    """
_LEAST, _GREATEST = (0.2, -0.3, 0.1, -9.0, -9.0, -9.0), (0.5, 0.3, 0.6, 9.0, 9.0, 9.0)
URX = Vendor(
    packages=("urx",),
    serve=serve,
    prepare="""
        import collections
        import collections.abc

        collections.Iterable = collections.abc.Iterable  # math3d 3 looks for it there
        """,
    program="""
        def place(robot, x, y, z):
            robot.movel([x, -y, z + 0.1, 0.0, 3.14, 0.0], 0.5, 0.1, wait=False)
        """,
    tests="""
        import os
        import time

        import program
        import pytest
        import urx

        PLACE = pytest.approx([0.4, -0.25, 0.25, 0.0, 3.14, 0.0])

        def test_it_is_placed():
            robot = urx.URRobot(os.environ["CONTROLLER"])
            try:
                program.place(robot, 0.4, 0.25, 0.15)
                until = time.monotonic() + 2.0
                while robot.getl() != PLACE and time.monotonic() < until:
                    time.sleep(0.02)
                assert robot.getl() == PLACE
            finally:
                robot.close()
        """,
    vocabulary="""
        [[operation]]
        call = "urx.urrobot:URRobot.send_program"
        message = "prog"
        patterns = [
          { text = "movel(p[{x:g},{y:g},{z:g},{rx:g},{ry:g},{rz:g}], a={a:g}, v={v:g}, r={r:g})", arguments = { x = { kind = "translation", axis = "x", unit = "m", frame = "base", mode = "to" }, y = { kind = "translation", axis = "y", unit = "m", frame = "base", mode = "to" }, z = { kind = "translation", axis = "z", unit = "m", frame = "base", mode = "to" } } },
        ]
        """,  # noqa: E501
    shipped=("urx",),
    guard=_GUARD,
    moving="movel",
    least=_LEAST,
    greatest=_GREATEST,
    operation="urx.urrobot:URRobot.movel",
    unreadable='robot.send_program("def p():\\n  movel(p[9.0,0.0,0.0,0.0,3.14,0.0])\\nend")',
    said="it is none of the commands that the vocabulary describes",
)
#: the same, by a text of URScript that the program writes itself
URSCRIPT = replace(
    URX,
    program="""
        def place(robot, x, y, z):
            robot.send_program(f"movel(p[{x},{-y},{z + 0.1},0.0,3.14,0.0], a=0.5, v=0.1, r=0)")
        """,
    operation="urx.urrobot:URRobot.send_program",
)
UR_RTDE = Vendor(
    packages=("rtde_control", "rtde_receive"),
    serve=serve,
    program="""
        def place(robot, x, y, z):
            robot.moveL([x, -y, z + 0.1, 0.0, 3.14, 0.0], 0.1, 0.5)
        """,
    tests="""
        import os

        import program
        import pytest
        from rtde_control import RTDEControlInterface
        from rtde_receive import RTDEReceiveInterface

        def test_it_is_placed():
            robot = RTDEControlInterface(os.environ["CONTROLLER"])
            program.place(robot, 0.4, 0.25, 0.15)
            state = RTDEReceiveInterface(os.environ["CONTROLLER"], -1.0, ["actual_TCP_pose"])
            assert state.getActualTCPPose() == pytest.approx([0.4, -0.25, 0.25, 0.0, 3.14, 0.0])
        """,
    vocabulary="",
    shipped=("ur_rtde",),
    guard=_GUARD,
    moving="movel",
    least=_LEAST,
    greatest=_GREATEST,
    operation="rtde_control:RTDEControlInterface.moveL",
    unreadable='robot.sendCustomScript("movel(p[9.0, 0.0, 0.0, 0.0, 3.14, 0.0])")',
    said="the vocabulary describes none of its arguments",
)
