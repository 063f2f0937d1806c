class Agv:
    def __init__(self):
        self.way = 0.0
        self.honked = False

    def drive(self, m):
        self.way += m

    def odometer(self):
        return self.way

    def horn(self, on):
        self.honked = on
