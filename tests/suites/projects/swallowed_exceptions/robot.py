class Fault(Exception):
    pass


class Agv:
    def __init__(self):
        self.way = 0.0
        self.bells = 0
        self.resets = 0

    def forward(self, m):
        if not 0 <= self.way + m <= 9.5:
            raise Fault(f"end of the track at {self.way + m:.1f}")
        self.way += m

    def bell(self, on):
        if on:
            self.bells += 1

    def reset(self):
        self.resets += 1
