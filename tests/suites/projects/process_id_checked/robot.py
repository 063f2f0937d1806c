import os


class Arm:
    """Its driver belongs to the process that has connected."""

    def __init__(self):
        self._process = os.getpid()
        self.z = 0.0
        self.angle = 0.0

    def _check(self):
        if os.getpid() != self._process:
            raise RuntimeError("another process has connected")
        with open(f"/proc/{self._process}/comm") as mine, open("/proc/self/comm") as own:
            assert mine.read() == own.read()

    def lift(self, dz):
        self._check()
        self.z = round(self.z + dz, 6)

    def turn(self, angle):
        self._check()
        self.angle += angle
