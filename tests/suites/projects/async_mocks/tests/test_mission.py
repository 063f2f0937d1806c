import asyncio
from unittest.mock import AsyncMock, call, create_autospec

import mission
import pytest
from robot import Arm


def test_sweeps():
    arm = AsyncMock(spec=Arm)
    arm.position.return_value = 0.2
    asyncio.run(mission.sweep(arm))
    assert arm.move_by.await_args_list == [call(0.2), call(dx=-0.1)]
    arm.stop.assert_awaited_once()


def test_goes_on_when_it_is_near():
    arm = create_autospec(Arm, instance=True)
    arm.position.return_value = 0.1
    assert asyncio.run(mission.sweep(arm)) == 0.1
    arm.stop.assert_not_awaited()


def test_hands_on_what_fails():
    arm = AsyncMock()
    arm.move_by.side_effect = ConnectionError("gone")
    with pytest.raises(ConnectionError, match="gone"):
        asyncio.run(mission.sweep(arm))
