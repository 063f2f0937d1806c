"""Docks a mobile robot at its charger: find the marker, drive there, make contact, charge."""

LOW, FULL = 20.0, 95.0
NEAR = 0.6
CONTACT = 0.02
TRIES = 3
FAST, SLOW = 0.3, 0.05
BACK = 0.3


class Dock:
    """The program."""

    def __init__(self, base, eye, charger):
        self.base, self.eye, self.charger = base, eye, charger
        self.state = "idle"
        self.tries = 0
        self.log = []

    def needs_charge(self):
        return self.charger.percent() < LOW

    def run(self):
        """Dock and charge; whether the battery is full afterwards."""
        if self.charger.percent() >= FULL:
            return True
        self.tries = 0
        while self.tries < TRIES:
            self.tries += 1
            if self.approach() and self.touch():
                self.enter("charging")
                self.charge()
                self.leave()
                return self.charger.percent() >= FULL
            self.enter("retry")
            self.base.drive(-BACK, speed=FAST, blocking=True)
        self.enter("failed")
        self.base.alarm("no dock", level="error")
        return False

    def approach(self):
        self.enter("approach")
        for _ in range(20):
            seen = self.eye.marker()
            if seen is None:
                return False
            distance, bearing = seen
            if distance <= NEAR:
                return True
            self.base.turn(bearing)
            self.base.drive(min(distance - NEAR / 2, 1.0), speed=FAST, blocking=True)
        return False

    def touch(self):
        self.enter("touch")
        for _ in range(40):
            if self.charger.has_contact():
                self.base.brake()
                return True
            self.base.drive(CONTACT, speed=SLOW, blocking=True)
        return False

    def charge(self):
        self.charger.switch_on()
        for _ in range(100):
            if self.charger.percent() >= FULL or not self.charger.has_contact():
                break
            self.base.wait(60.0)
        self.charger.switch_off()

    def leave(self):
        self.base.release()
        self.base.drive(-BACK, speed=SLOW, blocking=True)
        self.enter("idle")

    def enter(self, state):
        if state != self.state:
            self.log.append((self.state, state))
            self.state = state
