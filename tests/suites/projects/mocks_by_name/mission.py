from robot import Arm


class Picker:
    """Fetches a part."""

    def __init__(self, arm=None):
        self.arm = arm or Arm()

    def fetch(self, distance):
        self.arm.move_by(distance, speed=0.2)
        self.arm.grip(True)
        if self.arm.position() > 0.3:
            self.arm.move_by(-distance)
        else:
            self.arm.move_by(dx=0.1)

    def drop(self):
        self.arm.grip(closed=False)
        self.arm.move_by(0.05)
