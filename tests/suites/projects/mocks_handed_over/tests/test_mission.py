import asyncio
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import AsyncMock, MagicMock, Mock, call, create_autospec

import mission
import pytest
from robot import Arm


def test_it_goes_everywhere():
    arm = MagicMock(spec=Arm)
    mission.shift(arm, [0.1, 0.2])
    moves = [call(0.25), call(x=0.5, speed=0.1), call(0.1), call(0.2)]
    assert arm.move.mock_calls == moves


def test_it_lights_up_and_goes_dark():
    arm = create_autospec(Arm, instance=True)
    mission.shift(arm, [])
    assert arm.light.call_args_list == [call(True), call(on=False)]


@pytest.fixture
def pool():
    with ThreadPoolExecutor(1) as made:
        yield made


def test_all_at_once(pool):
    arm = Mock()
    mission.at_once(arm, pool)
    arm.move.assert_called_once_with(0.75)
    assert call(True) in arm.light.mock_calls


def test_the_panel():
    arm, button = Mock(), Mock()
    button.when_pressed.side_effect = lambda action, x: action(x)
    panel = mission.Panel(arm)
    panel.press(button)
    assert panel.on_press is arm.move
    assert panel.is_moving(arm.move)
    arm.move.assert_called_once_with(1.0)


def test_together():
    arm = MagicMock()
    arm.place = AsyncMock()
    asyncio.run(mission.together(arm))
    assert arm.place.await_args_list == [call(0.2), call(0.1)] or arm.place.await_count == 2


def test_watching():
    arm, loop = Mock(), asyncio.new_event_loop()
    mission.watch(arm, loop)
    loop.call_soon(loop.stop)
    loop.run_forever()
    loop.close()
    assert arm.mock_calls == [call.move(0.3), call.light(True)]
