import mission
import pytest
from robot import Arm


@pytest.fixture
def arm(mocker):
    mocker.patch.object(Arm, "__init__", return_value=None)
    for name in ("move_by", "grip"):
        mocker.patch.object(Arm, name, autospec=True)
    mocker.patch.object(Arm, "position", return_value=0.5)
    return Arm()


def test_it_fetches_from_far(mocker, arm):
    done = mocker.stub("done")
    mission.fetch(0.4, done)
    assert [one.args[1:] for one in Arm.move_by.call_args_list] == [(0.4,), (-0.4,)]
    done.assert_called_once_with(0.4)


def test_it_fetches_from_near(mocker):
    kind = mocker.patch("mission.Arm", autospec=True)
    kind.return_value.position.return_value = 0.1
    mission.fetch(0.2, mocker.stub())
    kind.return_value.move_by.assert_called_once_with(0.2, speed=0.2)
    kind.return_value.grip.assert_called_once_with(True)


class Line:
    def __init__(self):
        self.said = []

    def write(self, text):
        self.said.append(text)

    def readline(self):
        return b"0.25"


def test_it_drops(mocker):
    mocker.patch("builtins.open", return_value=Line())
    arm = Arm()
    mocker.stopall()
    moved, gripped = mocker.spy(arm, "move_by"), mocker.spy(arm, "grip")
    assert mission.drop(arm) == 0.25
    gripped.assert_called_once_with(False)
    moved.assert_called_once_with(dx=0.05)
    assert moved.spy_return is None


def test_it_tidies_up(mocker):
    kind = mocker.patch("robot.Arm")
    mission.tidy([0.1, -0.2])
    assert kind.return_value.move_by.mock_calls == [mocker.call(0.1), mocker.call(-0.2)]
