class Rover:
    def __init__(self):
        self.trip = 0.0
        self.total = 0.0

    def drive(self, m):
        self.trip = m
        self.total += abs(m)

    def odometer(self):
        return self.trip

    def battery(self):
        return round(100 - 5 * self.total, 3)
