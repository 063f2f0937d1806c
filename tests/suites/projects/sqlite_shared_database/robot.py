class Arm:
    def __init__(self):
        self.x = 0.0

    def move(self, dx):
        self.x += dx

    def position(self):
        return self.x

    def home(self):
        self.x = 0.0


class Camera:
    def __init__(self, *colours):
        self.colours = list(colours)

    def colour(self):
        return self.colours.pop(0)
