import sqlite3

_moves = sqlite3.connect(":memory:")
_moves.execute("CREATE TABLE moves (axis TEXT, step REAL)")


def total(axis):
    found = _moves.execute("SELECT sum(step) FROM moves WHERE axis = ?", (axis,)).fetchone()[0]
    return round(found or 0.0, 6)


class Arm:
    def lift(self, dz):
        _moves.execute("INSERT INTO moves VALUES ('lift', ?)", (dz,))

    def turn(self, angle):
        _moves.execute("INSERT INTO moves VALUES ('turn', ?)", (angle,))
