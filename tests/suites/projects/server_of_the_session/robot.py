class Magnet:
    """Holds up to three sheets."""

    def __init__(self):
        self.sheets = 0
        self.height = 0.0

    def lift(self, height):
        self.height += height

    def switch(self, on):
        self.sheets = min(3, self.sheets + 1) if on else 0

    def measured(self):
        return self.height
