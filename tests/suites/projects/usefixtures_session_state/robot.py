class Spindle:
    def __init__(self):
        self.speed = 0
        self.cooled = False
        self.steps = 0

    def accelerate(self, by):
        self.speed += by
        self.steps += 1

    def rpm(self):
        return self.speed

    def coolant(self, on):
        self.cooled = on
