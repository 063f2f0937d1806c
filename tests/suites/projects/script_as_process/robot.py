import json
import sys


class OutOfReach(Exception):
    pass


class Feeder:
    """Moves along a rail of 1 m, and writes down where parts were put."""

    def __init__(self, log):
        self.x = 0.0
        self.log = log

    def move_to(self, x):
        if not 0.0 <= x <= 1.0:
            raise OutOfReach(f"{x} m is not on the rail")
        self.x = x

    def move_by(self, dx):
        self.move_to(round(self.x + dx, 6))

    def release(self, part):
        with open(self.log, "a") as file:
            json.dump({"part": part, "x": self.x}, file)
            file.write("\n")

    def position(self):
        return self.x


def say(text):
    print(text, file=sys.stderr)
