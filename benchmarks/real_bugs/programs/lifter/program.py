"""Lifts a box off the conveyor and sets it down a little farther along."""

import math

from mutabot_cell import Pose, SensorError

#: m: the base stands so high, boxes stand on the conveyor, and are held so far above their bottom
BASE, CONVEYOR, GRIP = 0.9, 1.0, 0.03
ABOVE = 0.12
DOWN = (180, 0, 90)
READY = (0, 26, 180, -78, 0, -76, 90)
#: N at each finger
GENTLE, FIRM = 40, 120
#: m: what is let go hangs so far above the conveyor
CLEARANCE = 0.002
WIDTH = 0.05


class Lifter:
    """The program."""

    def __init__(self, cell):
        self.cell = cell
        self.grips = 0

    def shift(self, along):
        """Set the box down so far along the conveyor (y, m); return what became of it."""
        self.grips = 0
        self.open()
        self.cell.arm.move_joints(READY)
        for force in (GENTLE, FIRM):
            box = self.find()
            if box is None:
                return self.end("nothing there")
            if self.grip(box, force):
                break
        else:
            return self.end("slipped")
        self.cell.arm.move_by(y=along)
        if not self.holds():
            self.open()
            return self.end("lost")
        self.cell.arm.move_by(z=CLEARANCE - ABOVE)
        self.open()
        self.cell.arm.move_by(z=ABOVE)
        return self.end("shifted" if self.is_at(box.x, box.y + along) else "astray")

    def find(self):
        """Where the camera sees the box, if it stands on the conveyor; world frame."""
        try:
            box = self.cell.sensors.box_position()
        except SensorError:
            return None
        return box if abs(box.z - CONVEYOR) < 0.01 else None

    def grip(self, box, force):
        """Grip the box and lift it; whether it comes along."""
        self.grips += 1
        self.cell.arm.move_to(Pose(box.x, box.y, box.z - BASE + GRIP + ABOVE, *DOWN))
        self.cell.arm.move_by(z=-ABOVE)
        self.cell.gripper.set_force(force)
        self.cell.gripper.command(1)
        self.cell.wait(0.8)
        self.cell.arm.move_by(z=ABOVE)
        held = self.holds()
        if not held:
            self.open()
        return held

    def holds(self):
        return self.cell.gripper.holding() and abs(self.cell.gripper.opening() - WIDTH) < 0.005

    def open(self):
        self.cell.gripper.command(0)
        self.cell.wait(0.8)

    def is_at(self, x, y):
        box = self.find()
        return box is not None and math.hypot(box.x - x, box.y - y) < 0.01

    def end(self, outcome):
        self.cell.arm.home()
        return outcome
