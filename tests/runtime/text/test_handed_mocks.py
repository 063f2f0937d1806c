"""A mock is handed on as an operation without being asked what it would refuse to tell."""

from __future__ import annotations

from typing import Any, cast
from unittest.mock import MagicMock, create_autospec

import wrapt

from mutabot.runtime.program_text.call_targets import PassedCallables
from tests.runtime.stage import mocks_as_ever


def move(metres: float) -> None:
    """What a robot does."""


def handed_on(found: Any) -> Any:
    """What the program gets instead, which looks like it."""
    passed = PassedCallables(cast("Any", None), {})
    try:
        return passed._wrapped(cast("Any", None), cast("Any", None), None, found, found)
    finally:
        mocks_as_ever()


def test_wrapt_gets_no_refusal_from_a_mock_made_after_a_wrapped_function() -> None:
    """``wrapt`` does not expect one: on Python 3.13 that ends in a SystemError of the user's test."""
    wrapped = wrapt.FunctionWrapper(move, lambda wrapped, instance, args, kwargs: wrapped(*args, **kwargs))
    refused: list[str] = []

    class Asked(MagicMock):
        def __getattr__(self, name: str) -> Any:
            try:
                return super().__getattr__(name)
            except AttributeError:
                refused.append(name)
                raise

    mock = Asked(spec=wrapped)
    assert isinstance(mock, wrapt.FunctionWrapper)  # so it says
    before = dict(vars(mock))
    assert handed_on(mock).__wrapped__ is mock
    assert "_self_binding" not in refused
    assert vars(mock) == before


def test_a_function_made_by_autospec_is_handed_on_as_well() -> None:
    function = create_autospec(move)
    assert handed_on(function).__wrapped__ is function
