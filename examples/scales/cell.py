"""A small work cell behind text commands: one arm, one box, a feeder in front and a scale on each side.

Kinematics only. The arm stands in the middle and turns about its post; its gripper hangs REACH from the
post and goes up and down. Seen from above, heading 0 points at the feeder and angles count to the left,
so that the left scale lies at 90° and the right one at 270°. Feeder and pans are level: height 0.

Lengths in cm, angles in deg, masses in g, time in s.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

REACH = 40.0
#: height the gripper can reach above the pans
TOP = 12.0
#: feeder and scales have rims this high: what turns must be above them
RIM = 3.0
#: radius of the feeder's and the scales' surface
SURFACE = 8.0
FLOOR = -60.0
#: how far the box may be off the gripper's middle to be gripped
GRASP = 2.0

LIFT_SPEED, TURN_SPEED, FINGER_TIME = 10.0, 60.0, 0.5
#: standard deviation of a scale's reading, and its resolution
WEIGHT_NOISE, WEIGHT_STEP = 0.4, 0.1
#: standard deviation of where a falling box ends, in each direction, per cm of fall
SCATTER = 0.05

PLACES = {"feeder": 0.0, "left": 90.0, "right": 270.0}


class Refused(Exception):  # noqa: N818  # the word the robot itself uses
    """The robot does not take the command; nothing has moved."""


class UnknownCommand(Refused):
    """The robot does not know the command."""


class ProtectiveStop(Exception):  # noqa: N818  # likewise
    """The arm hit something and stopped."""


@dataclass
class Box:
    """The box: colour, mass, and the middle of its bottom face."""

    colour: str
    mass: float
    x: float = REACH
    y: float = 0.0
    z: float = 0.0


@dataclass(frozen=True)
class World:
    """What is true at one moment, without noise."""

    height: float
    heading: float
    holding: bool
    box_x: float
    box_y: float
    box_z: float


class Cell:
    """One cell with a box on the feeder.

    Args:
        seed: decides the box's mass, the scales' noise and how a falling box scatters.
        colour: ``red`` or ``blue``.
    """

    def __init__(self, seed: int, colour: str) -> None:
        self.box = Box(colour, mass=Random(f"{seed} mass").uniform(400.0, 600.0))
        self.height = 0.0
        self.heading = 0.0
        self.holding = False
        self.time = 0.0
        self._noise = Random(f"{seed} scales")
        self._scatter = Random(f"{seed} scatter")
        self._plain: dict[str, Callable[[], None]] = {"pick": self._pick, "release": self._release}
        self._with_number: dict[str, Callable[[float], None]] = {
            "lift": self._lift,
            "drop": lambda amount: self._lift(-amount),
            "turn": self._turn,
        }
        #: what each number may be
        self._limits = {"lift": TOP, "drop": TOP, "turn": 360.0}

    @property
    def world(self) -> World:
        """What is true now, without noise."""
        box = self.box
        return World(self.height, self.heading, self.holding, box.x, box.y, box.z)

    def execute(self, text: str) -> None:
        """Do what the command says. Raises Refused, UnknownCommand or ProtectiveStop."""
        word, slash, number = text.partition("/")
        if word in self._plain and not slash:
            self._plain[word]()
        elif word in self._with_number:
            self._with_number[word](self._number(text, word, number))
        else:
            raise UnknownCommand(f"unknown command {text!r}")

    def reading(self, name: str) -> str:
        """A reading as text. Raises UnknownCommand."""
        if name == "color":
            return self.box.colour
        if name == "height":
            return f"{self.height:.1f}"
        if name == "heading":
            return f"{self.heading:.1f}"
        kind, _, side = name.partition("/")
        if kind == "weight" and side in ("left", "right"):
            noisy = self._load(side) + self._noise.gauss(0.0, WEIGHT_NOISE)
            return f"{round(noisy / WEIGHT_STEP) * WEIGHT_STEP:.1f}"
        raise UnknownCommand(f"unknown reading {name!r}")

    def advance(self, seconds: float) -> None:
        """Simulated time goes on."""
        self.time += seconds

    def _number(self, text: str, word: str, number: str) -> float:
        try:
            value = float(number)
        except ValueError:
            raise UnknownCommand(f"{text!r} needs a number") from None
        limit = self._limits[word]
        if not 0.0 <= value <= limit:
            raise Refused(f"{text!r} is out of range: 0 to {limit:g}")
        return value

    def _pick(self) -> None:
        self.advance(FINGER_TIME)
        x, y = self._tool()
        if math.dist((x, y, self.height), (self.box.x, self.box.y, self.box.z)) <= GRASP:
            self.holding = True
            self._carry()

    def _release(self) -> None:
        self.advance(FINGER_TIME)
        if self.holding:
            self.holding = False
            self._fall()

    def _lift(self, amount: float) -> None:
        height = self.height + amount
        if not 0.0 <= height <= TOP:
            raise Refused(f"height {height:g} cm is out of range: 0 to {TOP:g} cm")
        self.advance(abs(amount) / LIFT_SPEED)
        self.height = height
        self._carry()

    def _turn(self, heading: float) -> None:
        way = (heading - self.heading + 180.0) % 360.0 - 180.0  # the shorter way round
        if way != 0.0 and self.height < RIM:
            raise ProtectiveStop(f"hit a rim {RIM:g} cm high while turning at height {self.height:g} cm")
        self.advance(abs(way) / TURN_SPEED)
        self.heading = heading % 360.0
        self._carry()

    def _carry(self) -> None:
        if self.holding:
            self.box.x, self.box.y = self._tool()
            self.box.z = self.height

    def _fall(self) -> None:
        """The box drops straight down onto what is there, and jumps a little if it falls far."""
        spread = SCATTER * self.box.z
        self.box.x += self._scatter.gauss(0.0, spread)
        self.box.y += self._scatter.gauss(0.0, spread)
        self.box.z = 0.0 if any(self._lies_on(place) for place in PLACES) else FLOOR

    def _load(self, side: str) -> float:
        """Mass that rests on a scale; what the gripper holds does not."""
        return self.box.mass if not self.holding and self._lies_on(side) else 0.0

    def _lies_on(self, place: str) -> bool:
        x, y = _point(PLACES[place])
        return self.box.z <= TOP and math.dist((x, y), (self.box.x, self.box.y)) <= SURFACE

    def _tool(self) -> tuple[float, float]:
        return _point(self.heading)


def _point(heading: float) -> tuple[float, float]:
    angle = math.radians(heading)
    return REACH * math.cos(angle), REACH * math.sin(angle)
