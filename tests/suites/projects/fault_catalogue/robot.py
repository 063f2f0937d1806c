"""A cell with an API of every kind of quantity: it notes what it is told, and reads what it is."""

from __future__ import annotations

import math
from dataclasses import dataclass


class Refused(Exception):
    """The robot does not do it."""


class NoImage(Exception):
    """The camera sees nothing."""


@dataclass(frozen=True)
class Pose:
    """mm and degrees."""

    x: float
    y: float
    z: float
    theta_x: float
    theta_y: float
    theta_z: float


@dataclass(frozen=True)
class Seen:
    """Where a part lies, m."""

    x: float
    y: float


class Cell:
    """One arm with a gripper, a camera and a laser."""

    def __init__(self) -> None:
        self.time = 0.0
        self.place = [0.0, 0.0, 100.0]
        self.angles = [180.0, 0.0, 90.0]
        self.quaternion = [1.0, 0.0, 0.0, 0.0]
        self.joints = [0.0] * 6
        self.speed = self.payload = self.force = self.grip = 0.0
        self.width = 85.0
        self.held = False
        self.looks = 0
        self.log = []

    def tick(self, seconds):
        self.time += seconds

    def wait(self, seconds):
        for _ in range(min(round(seconds * 100), 1000)):
            self.tick(0.01)

    def move_to(self, x, y, z):
        if max(abs(x), abs(y), abs(z)) > 900:
            raise Refused(f"({x}, {y}, {z}) is out of reach")
        self._go([x, y, z])

    def move_by(self, x=0.0, y=0.0, z=0.0):
        self._go([self.place[0] + x, self.place[1] + y, self.place[2] + z])

    def _go(self, place):
        self.wait(math.dist(place, self.place) / 1000.0 / max(self.speed, 0.01))
        self.place = place
        self.log.append(("at", [round(part, 3) for part in place]))

    def pose(self):
        return Pose(*self.place, *self.angles)

    def orient(self, quaternion):
        self.quaternion = list(quaternion)

    def turn_to(self, angles):
        self.angles = [float(angle) for angle in angles]

    def move_joints(self, joints):
        self.joints = list(joints)

    def joint_angles(self):
        return tuple(self.joints)

    def set_speed(self, speed):
        self.speed = speed

    def set_payload(self, mass):
        self.payload = mass

    def press(self, force):
        self.force = force

    def set_grip(self, newtons):
        self.grip = newtons

    def open_to(self, width):
        self.wait(0.2)
        self.width = width
        self.held = width < 40 and self.grip >= 30
        self.log.append(("opening", width))

    def distance(self):
        self.looks += 1
        return 0.5 - 0.05 * self.looks

    def pressed(self):
        return min(self.force, 100.0)

    def locate(self, which):
        places = {"nut": (0.2, 0.1), "bolt": (0.3, -0.1), "washer": (0.4, 0.0)}
        return Seen(*places[which])

    def colour(self):
        return "red"
