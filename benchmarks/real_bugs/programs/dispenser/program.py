"""Transfers liquid from well to well."""

TIP = 59.9
SAFE = 200.0
LEAST, MOST = 1.0, 200.0
SLOW = 20.0


class Transfers:
    """The program."""

    def __init__(self, pipette, rack):
        self.pipette, self.rack = pipette, rack
        self.done = []

    def transfer(self, volume, source, target, viscous=False):
        if not self.may(volume):
            raise ValueError(f"{volume} µl")
        self.rack.take()
        self.pipette.pick_up()
        speed = SLOW if viscous else 100.0
        self.at(source)
        self.pipette.aspirate(volume, speed=speed)
        self.at(target)
        self.pipette.dispense(volume, speed=speed)
        self.finish()
        self.done.append((source, target, volume))

    def may(self, volume):
        return LEAST <= volume <= MOST

    def at(self, height):
        self.pipette.move_to(SAFE)
        self.pipette.move_to(height + TIP)

    def finish(self):
        self.pipette.move_to(SAFE)
        self.pipette.drop()

    def give_up(self):
        self.finish()
        self.rack.give_back()

    def rinse(self, times):
        for _ in range(times):
            self.pipette.aspirate(50.0, speed=SLOW)
            self.pipette.dispense(50.0, speed=SLOW)
