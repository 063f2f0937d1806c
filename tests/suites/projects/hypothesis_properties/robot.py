class Arm:
    def __init__(self):
        self.x = 0.0
        self.moving = True

    def forward(self, m):
        self.x += m

    def stop(self):
        self.moving = False
