class Line:
    def __init__(self):
        self.at = 0.0
        self.running = True

    def forward(self, m):
        self.at += m

    def stop(self):
        self.running = False
