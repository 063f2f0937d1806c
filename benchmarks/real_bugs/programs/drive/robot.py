"""Motors that count ticks, and a clock, as plain objects."""


class Motor:
    """Counts ticks; the test turns it."""

    def __init__(self, ticks=0):
        self.ticks = ticks
        self.log = []

    def read_ticks(self):
        return self.ticks

    def set_speed(self, turns):
        self.log.append(turns)


class Clock:
    """Simulated time."""

    def __init__(self):
        self.time = 0.0

    def now(self):
        return self.time

    def sleep(self, seconds):
        self.time += seconds
