import threading

STATE = threading.local()
STATE.z = STATE.angle = 0.0


class Arm:
    def lift(self, dz):
        STATE.z = round(STATE.z + dz, 6)

    def turn(self, angle):
        STATE.angle += angle
