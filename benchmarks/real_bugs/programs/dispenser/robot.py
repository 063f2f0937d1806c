"""A pipette over a rack of tips, as plain objects."""


class RefusedError(Exception):
    """What the pipette cannot do."""


class Pipette:
    """Takes up and gives off; volumes in microlitres, heights in millimetres."""

    def __init__(self):
        self.has_tip = False
        self.volume = 0.0
        self.height = 200.0
        self.log = []

    def move_to(self, height):
        self.height = height
        self.log.append(("height", height))

    def pick_up(self):
        if self.has_tip:
            raise RefusedError("there is a tip")
        self.has_tip = True

    def drop(self):
        self.has_tip = False
        self.log.append(("drop",))

    def aspirate(self, volume, speed=100.0):
        self.volume += volume
        self.log.append(("aspirate", volume, speed))

    def dispense(self, volume, speed=100.0):
        self.volume -= volume
        self.log.append(("dispense", volume, speed))


class Rack:
    """Counts tips."""

    def __init__(self, count=8):
        self.count = count

    def take(self):
        self.count -= 1

    def give_back(self):
        self.count += 1
