"""Sorts parts on a belt: a camera names them, a flipper pushes them into their bins."""

BINS = {"nut": 0.4, "bolt": 0.7, "washer": 1.0}
REST = 1.5
BELT = 0.2
SURE = 0.8
FLIP = 0.15


class Sorter:
    """The program."""

    def __init__(self, bus, belt, flipper):
        self.bus, self.belt, self.flipper = bus, belt, flipper
        self.queue = []
        self.counts = {}
        self.last = None
        self.repeated = 0
        self.is_running = False

    def start(self):
        self.queue.clear()
        self.last = None
        self.counts = {}
        self.bus.subscribe("part", self.on_part)
        self.bus.subscribe("jam", self.on_jam)
        self.belt.set_speed(BELT)
        self.is_running = True

    def stop(self):
        self.belt.set_speed(0.0)
        self.bus.unsubscribe("part", self.on_part)
        self.bus.unsubscribe("jam", self.on_jam)
        self.is_running = False

    def on_part(self, label, share, stamp_ms):
        """A part must be seen twice in a row, surely enough, to be believed."""
        if share < SURE:
            return
        if label != self.last:
            self.last, self.repeated = label, 1
            return
        self.repeated += 1
        if self.repeated == 2:
            self.queue.append((label, stamp_ms / 1000.0))

    def on_jam(self, place):
        self.belt.set_speed(0.0)
        self.flipper.retract()
        self.queue.clear()
        self.bus.publish("alarm", f"jam at {place}")

    def due(self, label, seen):
        distance = BINS.get(label, REST)
        return seen + distance / BELT

    def step(self, now):
        """Push what is due; what is long overdue has passed."""
        waiting = []
        for label, seen in self.queue:
            late = now - self.due(label, seen)
            if late < 0:
                waiting.append((label, seen))
            elif late <= FLIP:
                self.push(label)
            else:
                self.counts["missed"] = self.counts.get("missed", 0) + 1
        self.queue = waiting

    def push(self, label):
        if label not in BINS:
            self.counts["other"] = self.counts.get("other", 0) + 1
            return
        self.flipper.extend(label)
        self.belt.wait(FLIP)
        self.flipper.retract()
        self.counts[label] = self.counts.get(label, 0) + 1
        self.bus.publish("sorted", label)

    def report(self):
        return dict(self.counts)
