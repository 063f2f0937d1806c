class OutOfReach(Exception):
    pass


class Arm:
    def __init__(self):
        self.x = 0.0
        self.yaw = 0.0
        self.rail = 0.0
        self.notes = []

    def move_to(self, x):
        if abs(x) > 1.0:
            raise OutOfReach(f"{x} m is out of reach")
        self.x = x

    def turn_to(self, yaw):
        self.yaw = yaw % 360.0

    def slide(self, x):
        if abs(x) > 2.0:
            return "blocked"
        self.rail = x
        return "ok"

    def note(self, text):
        self.notes.append(text)
