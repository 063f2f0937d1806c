from contextlib import contextmanager


class Grip:
    def __init__(self, part):
        self.part = part
        self.tight = False

    def squeeze(self, on):
        self.tight = on


class Station:
    def __init__(self):
        self.power = False
        self.pressed = 0.0
        self.most = 0.0
        self.grips = []

    @contextmanager
    def powered(self):
        self.power = True
        try:
            yield
        finally:
            self.power = False

    @contextmanager
    def gripping(self, part):
        grip = Grip(part)
        self.grips.append(grip)
        yield grip

    def press(self, mm):
        if not self.power:
            raise RuntimeError("no power")
        self.pressed += mm
        self.most = max(self.most, self.pressed)
