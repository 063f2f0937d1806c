import mission
import pytest


class Remote:
    """Sends every call to a server, as remote procedure calls do."""

    def __init__(self, send):
        self._send = send

    def __getattr__(self, name):
        return lambda *values, **named: self._send(name, *values, **named)


class Server:
    def __init__(self):
        self.degrees, self.heard = 0, []
        self.arm = Remote(self.handle)

    def handle(self, name, *values, **named):
        self.heard.append(name)
        if name == "turn":
            self.degrees += named.get("angle", 0) + sum(values)
        return self.degrees


@pytest.fixture
def server():
    return Server()


def test_sees_two_directions(server):
    assert mission.look_around(server) == [90, 60]


def test_turns_twice(server):
    mission.look_around(server)
    assert server.heard.count("turn") == 2


def test_stands_still_at_last(server):
    mission.look_around(server)
    assert server.heard[-1] == "angle"
