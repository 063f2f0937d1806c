from contextvars import ContextVar

HEIGHT = ContextVar("height", default=0.0)
ANGLE = ContextVar("angle", default=0.0)


class Arm:
    def lift(self, dz):
        HEIGHT.set(round(HEIGHT.get() + dz, 6))

    def turn(self, angle):
        ANGLE.set(ANGLE.get() + angle)
