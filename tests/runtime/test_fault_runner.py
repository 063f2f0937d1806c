"""A fork parent imports the modules of faults for its forks, as far as each fork could do so itself."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from mutabot.model.activation import Activation
from mutabot.runtime.fault_runner import preload

#: what each fault awaits
AWAITED = {
    "at_once": Activation.AT_ONCE,
    "is_there": "json",
    "is_not_there": "no_such_module",
    "of_a_test": Activation.FIRST_TEST,
    "fails": "json",
}


def test_faults_are_imported_whose_awaited_modules_are_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    for name in AWAITED:
        (tmp_path / f"fault_{name}.py").write_text("raise ImportError" if name == "fails" else "")
    try:
        preload(Activation(f"fault_{name}:Fault", awaits=awaited) for name, awaited in AWAITED.items())
        assert {name for name in AWAITED if f"fault_{name}" in sys.modules} == {"at_once", "is_there"}
    finally:
        for name in AWAITED:
            sys.modules.pop(f"fault_{name}", None)
