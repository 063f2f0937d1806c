"""Records one behaviour in this process."""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import traceback
from pathlib import Path
from typing import Any

PACKAGE = "tests.packages.ros.differential.behaviours"


def behaviours() -> dict[str, Any]:
    """All behaviours by name. Imports their modules, and so rclpy."""
    package = importlib.import_module(PACKAGE)
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{PACKAGE}.{module.name}")
    found: dict[str, Any] = importlib.import_module(f"{PACKAGE}.declared").DECLARED
    return found


def record(name: str, over: str, to: Path) -> int:
    """Let a behaviour happen and write its record; ends the process at once, whatever its threads do."""
    if over == "simulation":
        simulation = importlib.import_module("ros_in_process")
        simulation.start([str(Path(__file__).with_name("behaviours"))])
    try:
        said = {"record": behaviours()[name].act()}
    except Exception:
        said = {"error": traceback.format_exc()}
    to.write_text(json.dumps(said), encoding="utf-8")
    os._exit(0)
