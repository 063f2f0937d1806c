class Belt:
    def __init__(self):
        self.at = 0.0
        self.colour = "off"

    def forward(self, m):
        self.at += m

    def light(self, colour):
        self.colour = colour


class Scale:
    def __init__(self, belt):
        self.belt = belt

    def read(self):
        return 12.5 if self.belt.at == 0.5 else 0.0
