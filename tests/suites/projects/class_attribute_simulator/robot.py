class Sorter:
    """Every instance talks to the one machine."""

    parts = ["good", "bad", "good"]
    index = 0
    open = False
    rejected = []
    kept = []

    def look(self):
        return Sorter.parts[Sorter.index % len(Sorter.parts)]

    def flap(self, is_open):
        Sorter.open = is_open

    def advance(self, steps):
        (Sorter.rejected if Sorter.open else Sorter.kept).append(self.look())
        Sorter.index += steps
