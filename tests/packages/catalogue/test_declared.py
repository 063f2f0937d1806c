"""The package declares each of its operators."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import mutabot_catalogue
from mutabot.extensions import brought
from mutabot.families import CATALOGUE, MIDDLEWARE
from mutabot.operators import Operator, operator
from mutabot.operators.registry import classes_in, modules_in
from mutabot_catalogue.extension import EXTENSION

#: modules that hold no operator of their own
SHARED = {"extension", "values"}


def test_each_operator_is_declared_under_its_name() -> None:
    modules = [
        module for module in modules_in(Path(mutabot_catalogue.__file__).parent) if module not in SHARED
    ]
    found = {
        kind.name: f"mutabot_catalogue.{module}:{kind.__name__}"
        for module in modules
        for kind in classes_in(import_module(f"mutabot_catalogue.{module}"), Operator)
    }
    assert found == EXTENSION.operators


def test_they_are_of_two_families_and_found_where_the_package_is_installed() -> None:
    assert EXTENSION.operators.keys() <= brought("operators").keys()
    families = [operator(name).family for name in EXTENSION.operators]
    assert families == [*[CATALOGUE] * families.count(CATALOGUE), *[MIDDLEWARE] * families.count(MIDDLEWARE)]
