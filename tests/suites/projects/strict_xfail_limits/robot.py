class Collision(Exception):
    """Hit the table."""


class Arm:
    def __init__(self, height=1.0):
        self.z = height

    def down(self, dz):
        if self.z - dz < 0:
            raise Collision("the table")
        self.z -= dz

    def height(self):
        return self.z
