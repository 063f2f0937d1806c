import numpy as np


class Sim:
    def __init__(self):
        self.memory = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
        self.went = None

    def box(self):
        return self.memory[3:6]

    def tool(self):
        return self.memory[0:3].copy()

    def go(self, pose):
        self.went = [float(part) for part in pose]
