"""A base on a line before a charger, as plain objects; time passes when somebody waits."""


class Base:
    """Drives along a line; the charger is at 0."""

    def __init__(self, place=-2.0, slip=0.0):
        self.place, self.slip = place, slip
        self.time = 0.0
        self.braked = False
        self.pending = 0.0
        self.log = []

    def drive(self, metres, speed=0.2, blocking=False):
        self.log.append(("drive", metres, speed))
        if self.braked:
            return
        self.place += self.pending
        self.pending = metres * (1 - self.slip)
        if blocking:
            self.time += abs(metres) / speed
            self.place, self.pending = self.place + self.pending, 0.0

    def turn(self, angle):
        self.log.append(("turn", angle))

    def brake(self):
        self.braked = True

    def release(self):
        self.braked = False

    def wait(self, seconds):
        self.time += seconds

    def alarm(self, text, level="info"):
        self.log.append(("alarm", text, level))


class Eye:
    """Sees the marker up to 3 m away."""

    def __init__(self, base, bearing=0.1, blind=False):
        self.base, self.bearing, self.blind = base, bearing, blind

    def marker(self):
        distance = -self.base.place
        return None if self.blind or distance > 3.0 else (distance, self.bearing)


class Charger:
    """Charges 2 percent a minute while there is contact."""

    def __init__(self, base, percent=15.0, works=True):
        self.base, self.start, self.works = base, percent, works
        self.since = None
        self.log = []

    def has_contact(self):
        return self.works and self.base.place >= -0.01

    def percent(self):
        gained = 0.0 if self.since is None else (self.base.time - self.since) / 60.0 * 2.0
        return min(100.0, self.start + gained)

    def switch_on(self):
        if self.has_contact():
            self.since = self.base.time
        self.log.append("on")

    def switch_off(self):
        self.start = self.percent()
        self.since = None
        self.log.append("off")
