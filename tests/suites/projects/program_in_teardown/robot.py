class Hand:
    def __init__(self):
        self.at = 0.0
        self.closed = False

    def move(self, m):
        self.at += m

    def close(self, on):
        self.closed = on
