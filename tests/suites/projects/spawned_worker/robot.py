class Arm:
    def __init__(self, places):
        self.places = places
        self.turn = 0

    def rotate(self, deg):
        self.turn += deg

    def put(self):
        self.places.append(self.turn)

    def angle(self):
        return self.turn
