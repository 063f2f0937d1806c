"""Measures a box with the distance sensor in the palm and with the fingers."""

from mutabot_cell import Pose, SensorError

BASE, CONVEYOR = 0.9, 1.0
#: m: from the palm to between the fingers; where the tool stands to look down, above the conveyor
PALM, HIGH = 0.035, 0.15
#: m: the tool, above the conveyor, when the fingers feel the box
LOW = 0.025
DOWN = (180, 0, 90)
READINGS = 5
#: mm: height and width that are allowed
HEIGHTS, WIDTHS = (45.0, 55.0), (48.0, 52.0)
STROKE = 0.085


class Gauge:
    """The program."""

    def __init__(self, cell):
        self.cell = cell
        self.results = []

    def measure(self):
        """Height and width in mm, whether the box is good, and its colour; None if there is no box."""
        self.cell.gripper.command(0)
        try:
            box = self.cell.sensors.box_position()
        except SensorError:
            return None
        self.cell.arm.move_to(Pose(box.x, box.y, CONVEYOR - BASE + HIGH, *DOWN))
        height = self.height()
        if height < 10.0:
            return None
        self.cell.arm.move_by(z=LOW - HIGH)
        width = self.width()
        self.cell.arm.move_by(z=HIGH - LOW)
        found = {
            "height": round(height, 1),
            "width": round(width, 1),
            "colour": self.cell.sensors.colour(),
            "good": self.is_in(height, HEIGHTS) and self.is_in(width, WIDTHS),
        }
        self.results.append(found)
        return found

    def height(self):
        """The mean of some readings, mm."""
        readings = []
        for _ in range(READINGS):
            readings.append(self.cell.sensors.distance())
            self.cell.wait(0.02)
        return 1000.0 * (HIGH + PALM - sum(readings) / len(readings))

    def width(self):
        """How far apart the fingers are that touch the box, mm."""
        self.cell.gripper.set_force(20)
        self.cell.gripper.command(1)
        self.cell.wait(1.0)
        opening = self.cell.gripper.opening() if self.cell.gripper.holding() else 0.0
        self.cell.gripper.command(0)
        self.cell.wait(0.5)
        return 1000.0 * opening

    def is_in(self, value, limits):
        low, high = limits
        return low <= value <= high

    def summary(self):
        """How many were good, of how many of each colour."""
        counts = {"red": 0, "blue": 0}
        for one in self.results:
            counts[one["colour"]] += 1
        good = sum(one["good"] for one in self.results)
        return {"good": good, **counts}
