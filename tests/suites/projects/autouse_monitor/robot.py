class Disc:
    def __init__(self):
        self.spinning = False
        self.pressure = 0.0
        self.events = []

    def spin(self, on):
        self.spinning = on

    def press(self, bar):
        self.pressure = round(self.pressure + bar, 6)
        if self.pressure > 0.5 or (self.pressure > 0 and not self.spinning):
            self.events.append(("scratch", self.pressure))
