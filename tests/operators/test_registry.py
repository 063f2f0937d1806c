"""Operators by name."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

import mutabot
from mutabot.errors import OperatorError
from mutabot.operators import names, operator, registry


def test_an_unknown_operator_is_named_with_the_nearest() -> None:
    with pytest.raises(OperatorError, match="did you mean 'reverse'"):
        operator("revers")


@pytest.mark.parametrize("name", ["skip", "identity", "drift"])
def test_two_operators_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    entries = [EntryPoint(name, f"plug_in_{number}:Operator", registry.ENTRY_POINT) for number in (1, 2)]
    monkeypatch.setattr(registry, "_plug_ins", lambda: tuple(entries))
    with pytest.raises(OperatorError, match=f"'{name}'"):
        names()


def test_the_public_names_are_what_they_say() -> None:
    for name in mutabot._HOME_OF:
        assert getattr(mutabot, name).__name__ in (name, "Callable")
    assert set(mutabot._HOME_OF) <= set(dir(mutabot))
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        mutabot.Nothing  # noqa: B018  # it is the access that fails
