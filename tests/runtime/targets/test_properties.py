"""Properties as operations: their reading is seen, and nothing else is claimed."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import pytest

from mutabot.config.vocabulary import load
from mutabot.runtime.targets.callables import look_at


class _Arm:
    speed = property(lambda self: 1.0, lambda self, value: None)
    reach = cached_property(lambda self: 1.0)


@pytest.mark.parametrize("name", ["speed", "reach"])
def test_arguments_of_a_property_are_refused(tmp_path: Path, name: str) -> None:
    text = f'[[operation]]\ncall = "robot:Arm.{name}"\n'
    quantity = '{ kind = "position", axis = "x", unit = "m" }'
    (tmp_path / "robot.toml").write_text(f"{text}result = {quantity}\n", encoding="utf-8")
    (reading,) = load(["robot.toml"], tmp_path).operations
    assert not list(look_at(reading, vars(_Arm)[name]))
    translation = '{ kind = "translation", axis = "x", unit = "m", mode = "by" }'
    (tmp_path / "robot.toml").write_text(f"{text}arguments.value = {translation}\n", encoding="utf-8")
    (operation,) = load(["robot.toml"], tmp_path).operations
    (finding,) = look_at(operation, vars(_Arm)[name])
    assert finding.key == "arguments.value"
    assert not finding.is_remark
    assert finding.text.startswith(f"robot:Arm.{name} is a property: only its reading is seen")
