import logging

_log = logging.getLogger("arm")


class Arm:
    def lift(self, dz):
        _log.setLevel(_log.level + round(dz * 100))

    def turn(self, angle):
        _log.disabled = angle < 0
