class Arm:
    def turn(self, angle):
        """Done by the arm."""

    def angle(self):
        """Told by the arm."""

    def vacuum(self, on):
        """Done by the arm."""
