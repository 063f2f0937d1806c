"""A bus of messages, a belt and a flipper, as plain objects."""


class Bus:
    """Calls what is subscribed; keeps what is published."""

    def __init__(self):
        self.handlers = {}
        self.log = []

    def subscribe(self, topic, handler):
        self.handlers.setdefault(topic, []).append(handler)

    def unsubscribe(self, topic, handler):
        self.handlers[topic].remove(handler)

    def publish(self, topic, text):
        self.log.append((topic, text))

    def arrives(self, topic, *values):
        for handler in list(self.handlers.get(topic, [])):
            handler(*values)


class Belt:
    """Runs; time passes when somebody waits."""

    def __init__(self):
        self.speed = 0.0
        self.time = 0.0

    def set_speed(self, speed):
        self.speed = speed

    def wait(self, seconds):
        self.time += seconds


class Flipper:
    """Is out or in."""

    def __init__(self, belt):
        self.belt = belt
        self.is_out = False
        self.log = []

    def extend(self, label):
        self.is_out = True
        self.log.append(("out", label, self.belt.time))

    def retract(self):
        self.is_out = False
        self.log.append(("in", self.belt.time))
