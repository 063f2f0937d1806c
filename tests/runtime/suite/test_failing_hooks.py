"""Whose failure it is when a hook raises: one of ours must never look like a mutant that was noticed."""

from __future__ import annotations

import json
from types import ModuleType

import pluggy
import pytest

from mutabot.model.activation import FatalFault
from mutabot.runtime.session_hooks import _is_own_failure

SPEC = pluggy.HookspecMarker("trial")
PLAIN = """
import json, pluggy
mark = pluggy.HookimplMarker("trial")

@mark
def run():
    json.loads("[")
"""
AROUND = """
import pluggy
mark = pluggy.HookimplMarker("trial")

@mark(wrapper=True)
def run():
    return (yield)
"""


def plugin(name: str, source: str) -> ModuleType:
    module = ModuleType(name)
    exec(source, vars(module))
    return module


@pytest.mark.parametrize(
    ("failing", "around", "is_own"),
    [
        ("mutabot.runtime.trial", "conftest", True),
        ("conftest", "mutabot.runtime.trial", False),
        ("conftest", "other", False),
    ],
)
def test_a_hook_fails_with_what_it_calls(failing: str, around: str, is_own: bool) -> None:
    manager = pluggy.PluginManager("trial")
    specification = ModuleType("specification")
    specification.run = SPEC(lambda: None)  # type: ignore[attr-defined]
    manager.add_hookspecs(specification)
    manager.register(plugin(failing, PLAIN), "plain")
    manager.register(plugin(around, AROUND), "around")
    with pytest.raises(json.JSONDecodeError) as failure:
        manager.hook.run()
    assert _is_own_failure(failure) is is_own


def test_what_a_control_raises_is_no_failure_of_ours() -> None:
    ours = ModuleType("mutabot.runtime.trial")
    exec("def act(error):\n    raise error", vars(ours))
    for error, is_own in ((FatalFault("control"), False), (ValueError("defect"), True)):
        with pytest.raises(type(error)) as failure:
            ours.act(error)
        assert _is_own_failure(failure) is is_own
