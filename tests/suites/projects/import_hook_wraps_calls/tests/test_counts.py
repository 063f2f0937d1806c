import counts
import mission


class Log:
    def __init__(self):
        self.said = []

    def move(self, x):
        self.said.append(x)

    def grip(self, closed):
        self.said.append(closed)

    def __str__(self):
        return f"{self.said}"


def test_rehearsal_calls_what_stands_there():
    counts.CALLS.clear()
    assert mission.rehearse(Log(), -2.0) == "[2.0, False]"
    assert counts.CALLS == ["abs", "move", "grip", "str"]


def test_moves():
    assert mission.go(-2.0).x == 2.0


def test_grips():
    assert mission.go(-2.0).closed
    assert not mission.go(2.0).closed
