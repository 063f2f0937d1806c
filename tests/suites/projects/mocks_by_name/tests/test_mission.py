from unittest.mock import MagicMock, Mock, call, create_autospec, patch

import mission
import pytest
from robot import Arm


def test_it_fetches_from_far():
    arm = MagicMock(spec=Arm)
    arm.position.return_value = 0.5
    mission.Picker(arm).fetch(0.4)
    assert arm.move_by.call_args_list == [call(0.4, speed=0.2), call(-0.4)]
    arm.grip.assert_called_once_with(True)


def test_it_fetches_from_near():
    arm = Mock()
    arm.position.return_value = 0.1
    mission.Picker(arm).fetch(0.2)
    assert arm.method_calls[-1] == call.move_by(dx=0.1)


@patch("mission.Arm")
def test_it_drops(kind):
    mission.Picker().drop()
    kind.return_value.grip.assert_called_once_with(closed=False)


def test_it_says_what_the_arm_refuses():
    arm = create_autospec(Arm, instance=True)
    arm.move_by.side_effect = OSError("no line")
    with pytest.raises(OSError, match="no line"):
        mission.Picker(arm).fetch(0.1)
    arm.grip.assert_not_called()
