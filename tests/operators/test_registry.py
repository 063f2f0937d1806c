"""Operators by name."""

from __future__ import annotations

import pytest

import mutabot
from mutabot import extensions
from mutabot.errors import ExtensionError, OperatorError
from mutabot.extensions import Extension
from mutabot.operators import names, operator, registry


def test_an_unknown_operator_is_named_with_the_nearest() -> None:
    with pytest.raises(OperatorError, match="did you mean 'reverse'"):
        operator("revers")


@pytest.mark.parametrize("name", ["skip", "identity", "drift"])
def test_two_operators_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    found = [(f"package-{number}", Extension(1, {name: f"package_{number}:Rule"})) for number in (1, 2)]
    monkeypatch.setattr(extensions, "_declared", lambda: tuple(found))
    with pytest.raises(ExtensionError, match=f"'{name}' of package 'package-2' .* 'package-1'"):
        names()
    del found[1]
    with pytest.raises(OperatorError, match=f"'{name}' of package 'package-1' .* 'mutabot'"):
        names()


def test_an_operator_of_ours_has_a_name_of_its_own_written_in_its_file() -> None:
    assert len(set(registry.built_in())) == len(registry.built_in())
    for module, text in registry._modules().items():
        assert [rule.name for rule in registry._of_module(module) if f'"{rule.name}"' not in text] == []


def test_the_public_names_are_what_they_say() -> None:
    public = {name for names in mutabot._HOMES.values() for name in names}
    for name in public:
        assert getattr(mutabot, name).__name__ in (name, "Callable")
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        mutabot.Nothing  # noqa: B018  # it is the access that fails
