class Arm:
    def __init__(self):
        self.z = 0.5

    def down(self, m):
        self.z = round(self.z - m, 6)

    def height(self):
        return self.z


class Camera:
    def __init__(self, colour):
        self._colour = colour

    def colour(self):
        return self._colour
