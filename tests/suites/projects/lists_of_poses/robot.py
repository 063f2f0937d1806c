class Arm:
    def __init__(self):
        self.at = [0.0, 0.0, 0.5]
        self.state = "off"
        self.drawn = []

    def follow(self, path):
        reached = []
        for x, y, z in path:
            self.at = [x, y, z]
            if self.state == "on":
                self.drawn.append((x, y))
            reached.append(list(self.at))
        return reached

    def tool(self, state):
        self.state = state
