class Car:
    def __init__(self):
        self.x = 0.0
        self.wheel = 0
        self.turned = 0.0

    def forward(self, m):
        self.x += m
        self.turned += abs(m) * self.wheel

    def steer(self, deg):
        self.wheel = deg


class Truck(Car):
    def __init__(self):
        super().__init__()
        self.trailer = True
