class Arm:
    def __init__(self):
        raise RuntimeError("no arm is connected")

    def lift(self, height):
        """Done by the arm."""

    def height(self):
        """Told by the arm."""

    def open(self):
        """Done by the arm."""

    def close(self):
        """Done by the arm."""
