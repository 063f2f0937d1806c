"""The names that packages load late are those that type checkers see."""

from __future__ import annotations

import ast
import inspect
from types import ModuleType

import pytest

import mutabot
import mutabot.model


@pytest.mark.parametrize("package", [mutabot, mutabot.model])
def test_each_name_that_type_checkers_see_is_there_and_no_other(package: ModuleType) -> None:
    tree = ast.parse(inspect.getsource(package))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    seen = {alias.asname or alias.name for node in block.body for alias in getattr(node, "names", ())}
    late = {name for names in package._HOMES.values() for name in names}
    assert late == seen
    assert all(getattr(package, name) is not None for name in late)
    assert late <= set(dir(package))


def test_a_name_that_is_not_there_is_said_as_for_any_module() -> None:
    with pytest.raises(AttributeError, match=r"module 'mutabot\.model' has no attribute 'Mutnat'"):
        mutabot.model.Mutnat  # noqa: B018
