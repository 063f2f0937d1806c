class Guard:
    """Follows a part and reacts to what the line tells."""

    def __init__(self, line, arm):
        self.arm = arm
        line.subscribe(self.on_part)

    def on_part(self, distance):
        if distance < 0.5:
            self.arm.forward(distance)
            self.arm.grab(True)
        else:
            self.arm.wave()
