class Agv:
    def __init__(self, level):
        self.level = level
        self.at = 0.0
        self.plugged = False

    def battery(self):
        return self.level

    def forward(self, m):
        self.at += m

    def plug(self, on):
        self.plugged = on and abs(self.at - 5.0) < 0.1
