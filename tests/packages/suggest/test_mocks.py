"""What mocks were called with can be read in a test, by expressions that call nothing."""

from __future__ import annotations

from typing import Any
from unittest.mock import AsyncMock, MagicMock, Mock, create_autospec

import pytest

from mutabot_suggest import recorder
from mutabot_suggest.candidates import _are_related
from mutabot_suggest.readings import HAND, ReadExpression


class Arm:
    def move(self, x: float, *, speed: float = 0.1) -> None:
        raise NotImplementedError


def _noted(**names: Any) -> dict[str, Any]:
    recorder.note(names)
    return recorder.values()


@pytest.mark.parametrize(
    "make", [Mock, MagicMock, AsyncMock, lambda: MagicMock(spec=Arm), create_autospec(Arm)]
)
@pytest.mark.filterwarnings("ignore:coroutine")
def test_the_last_call_of_each_method_is_read_with_its_positional_and_keyword_arguments(make: Any) -> None:
    arm = make()
    arm.move(1.5, speed=0.2)
    arm.move(2.5, speed=0.3)
    calls = list(arm.method_calls)
    found = _noted(arm=arm)
    assert found == {
        "arm.move.call_count": 2,
        "arm.move.call_args.args[0]": 2.5,
        'arm.move.call_args.kwargs["speed"]': 0.3,
    }
    assert {text: eval(text, {"arm": arm}) for text in found} == found
    assert arm.method_calls == calls


def test_calls_of_a_function_and_of_parts_of_a_mock_are_read() -> None:
    send, cell = Mock(), Mock()
    send("lift/5")
    cell.arm.home()
    assert _noted(send=send, cell=cell, idle=Mock()) == {
        "send.call_count": 1,
        "send.call_args.args[0]": "lift/5",
        "cell.arm.home.call_count": 1,
    }


def test_that_two_commands_had_one_value_is_no_relation() -> None:
    texts = ("arm.lift.call_args.args[0]", "arm.turn.call_args.args[0]")
    first, second = (ReadExpression(text, HAND, 1e-6) for text in texts)
    assert not _are_related(first, second, dict.fromkeys(texts, 0.5))
