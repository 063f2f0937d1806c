class Lift:
    def raise_by(self, dz):
        """Done by the lift."""

    def height(self):
        """Told by the lift."""
