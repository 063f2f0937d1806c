class CartEnv:
    def __init__(self):
        self.position = 0.0
        self.steps = 0

    def reset(self):
        self.position = 0.0
        self.steps = 0
        return self.position, {}

    def step(self, action):
        self.steps += 1
        self.position = round(self.position + action, 6)
        done = self.position >= 1.0
        return self.position, (1.0 if done else -0.1), done, {"steps": self.steps, "log": [self.position]}
