class Arm:
    def __init__(self, table):
        self.table = table
        self.at = 0
        self.carried = None

    def go(self, place):
        self.at = place

    def suck(self, on):
        if on and self.carried is None:
            self.carried = self.table.pop(self.at, None)
        elif not on and self.carried is not None:
            self.table[self.at] = self.carried
            self.carried = None
