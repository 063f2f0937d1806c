"""Keeps a camera on a target: pan and tilt from what it sees and from a joystick."""

import math

PAN_LIMIT = math.radians(170.0)
TILT_LOW, TILT_HIGH = math.radians(-30.0), math.radians(60.0)
DEAD = 0.05
GAIN = 0.5
FOV = math.radians(60.0)
PIXELS = 640


def wrapped(angle):
    """The same angle between -π and π."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


def clamped(value, low, high):
    return max(low, min(value, high))


class Gimbal:
    """The program."""

    def __init__(self, motors):
        self.motors = motors
        self.target = None
        self.missed = 0

    def point_at(self, x, y, z):
        pan = math.atan2(y, x)
        tilt = math.atan2(z, math.hypot(x, y))
        self.set(pan, tilt)

    def set(self, pan, tilt):
        self.motors.set_pan(math.degrees(clamped(wrapped(pan), -PAN_LIMIT, PAN_LIMIT)))
        self.motors.set_tilt(math.degrees(clamped(tilt, TILT_LOW, TILT_HIGH)))

    def track(self, u, v):
        if u is None:
            self.missed += 1
            if self.missed >= 3:
                self.target = None
                self.set(0.0, 0.0)
            return
        self.missed = 0
        right = (u - PIXELS / 2) / PIXELS * FOV
        down = (v - 240) / PIXELS * FOV
        pan = math.radians(self.motors.read_pan()) - GAIN * right
        tilt = math.radians(self.motors.read_tilt()) - GAIN * down
        self.target = (pan, tilt)
        self.set(pan, tilt)

    def joystick(self, x, y):
        if abs(x) < DEAD:
            x = 0.0
        if abs(y) < DEAD:
            y = 0.0
        pan = math.radians(self.motors.read_pan()) - math.copysign(x * x, x)
        tilt = math.radians(self.motors.read_tilt()) + math.copysign(y * y, y)
        self.set(pan, tilt)

    def error(self):
        if self.target is None:
            return None
        pan = math.radians(self.motors.read_pan())
        tilt = math.radians(self.motors.read_tilt())
        return math.hypot(wrapped(self.target[0] - pan), self.target[1] - tilt)

    def settled(self):
        return not self.motors.is_moving()
