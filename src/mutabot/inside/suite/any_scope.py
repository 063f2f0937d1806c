"""The fixture ``mutabot_seed`` at every scope.

To pytest a fixture has one scope, and one that is made anew for each test cannot be had by a fixture that
several tests share. A shared simulator needs a seed as well. So what a shared fixture gets by this name is
another fixture, of its own scope: the seed of the class, module, package or session that it lives as long as.
"""

from __future__ import annotations

from typing import Any

import pytest

NAME = "mutabot_seed"
#: the fixtures that stand for it, by scope of who asks
SHARED = {
    "class": "_mutabot_class_seed",
    "module": "_mutabot_module_seed",
    "package": "_mutabot_package_seed",
    "session": "mutabot_round_seed",
}
#: pytest has no public way to say this; where it is not there, ``mutabot_round_seed`` still works
_ASK = "_get_active_fixturedef"


def offer_at_every_scope(owner: str) -> None:
    """Let shared fixtures ask for the seed. ``owner``: the module that defines it; others may override it."""
    ask: Any = getattr(pytest.FixtureRequest, _ASK, None)
    if ask is None or hasattr(ask, "offers_seed"):
        return

    def asked(self: Any, argname: str) -> Any:
        if argname == NAME and self.scope in SHARED and _is_defined_by(owner, self):
            argname = SHARED[self.scope]
        return ask(self, argname)

    asked.offers_seed = True  # type: ignore[attr-defined]  # a mark on it: several sessions may share a process
    setattr(pytest.FixtureRequest, _ASK, asked)


def _is_defined_by(owner: str, request: Any) -> bool:
    definitions = request._fixturemanager.getfixturedefs(NAME, request._pyfuncitem)
    return bool(definitions) and getattr(definitions[-1].func, "__module__", None) == owner
