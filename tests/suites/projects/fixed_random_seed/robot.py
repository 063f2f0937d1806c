import random


class Bin:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.part = self.random.uniform(-0.3, 0.3)


class Scanner:
    def __init__(self, bin):
        self.bin = bin

    def find(self):
        return self.bin.part + self.bin.random.gauss(0, 0.02)


class Arm:
    def __init__(self, bin):
        self.bin = bin
        self.x = 0.0
        self.closed = False

    def reach(self, x):
        self.x = x

    def grip(self, closed):
        self.closed = closed

    def holding(self):
        return self.closed and abs(self.x - self.bin.part) < 0.015
