"""Parts of what outcomes depend on: what all of them share, by name, with a digest or a plain value each."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot.execution.versions import versions
from mutabot.model.codec import data_digest, to_data

from .packages import code_of_packages
from .snapshot import HASH, digest_of, read, role_of

if TYPE_CHECKING:
    from mutabot.campaign.request import Request
    from mutabot.model import Vocabulary


#: what something is made of: names, and a digest or a plain value for each
Parts = Mapping[str, str]

_CONFIGURATIONS = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")


def everything_of(request: Request, files: Parts, installed: Parts) -> Parts:
    """Return everything that runs of the tests depend on, for any mutant.

    Args:
        files: the files that count, with their digests.
        installed: what is installed.
    """
    vocabulary = request.vocabulary
    entries = (operation_parts(vocabulary, operation.target) for operation in vocabulary.operations)
    operations = {name: digest for entry in entries for name, digest in entry.items()}
    return {**environment_parts(request, files, installed, read), **operations, **files}


def environment_parts(
    request: Request, files: Parts, installed: Parts, read: Callable[[Path], bytes | None]
) -> dict[str, str]:
    """Return what all outcomes depend on besides the content of the project's files."""
    return {
        **_pytest_parts(request, read),
        **_settings(request),
        **{f"role of {name}": role for name in files if (role := role_of(name, request))},
        **_vocabulary_parts(request.vocabulary),
        **installed,
    }


def _settings(request: Request) -> dict[str, str]:
    configuration = request.configuration
    return {
        "seed": str(request.seed),
        "oracle_nodes": ", ".join(configuration.oracle_nodes) or "none",
        "timeout_factor": str(configuration.timeout_factor),
        "timeout_seconds": str(configuration.timeout_seconds),
        "memory": str(configuration.memory),
        **({"every test": "run"} if request.every_test else {}),
        **({"guards": HASH + data_digest(request.guards)} if request.guards else {}),
    }


def _pytest_parts(request: Request, read: Callable[[Path], bytes | None]) -> dict[str, str]:
    """Return pytest's arguments, and its configuration files in folders above the project."""
    parts = {"pytest's arguments": " ".join(request.arguments)}
    for depth, folder in enumerate((request.root, *request.root.parents)):
        for name in _CONFIGURATIONS:
            text = read(folder / name)
            if text is None:
                continue
            shown = "../" * depth + name
            if name == "pyproject.toml":
                parts[f"tool.pytest in {shown}"] = HASH + data_digest(tool_table(text, "pytest"))
            elif depth:
                parts[shown] = digest_of(text)
    return parts


def tool_table(text: bytes | None, tool: str) -> Any:
    """Return the table of a tool in a ``pyproject.toml``; None if there is none."""
    try:
        data = tomllib.loads((text or b"").decode("utf-8"))
    except ValueError:
        return None
    tools = data.get("tool")
    return tools.get(tool) if isinstance(tools, dict) else None


def _vocabulary_parts(vocabulary: Vocabulary) -> dict[str, str]:
    names = ("refusals", "checks", "failures", "clock", "probes")
    return {
        f"{name} of the vocabulary": HASH + data_digest(_meaning(getattr(vocabulary, name))) for name in names
    }


def operation_parts(vocabulary: Vocabulary, target: str) -> dict[str, str]:
    """Return the entry of an operation, and those of the operations that its mutants need."""
    found: dict[str, str] = {}
    waiting = [target]
    while waiting:
        operation = vocabulary.operation(waiting.pop())
        name = f"{operation.target} in the vocabulary" if operation is not None else ""
        if operation is not None and name not in found:
            found[name] = HASH + data_digest(_meaning(operation))
            waiting += [*operation.currents, *operation.opposites]
    return found


def _meaning(value: Any) -> Any:
    """Return the content of an entry, without its line number."""
    data = to_data(value)
    if isinstance(data, dict):
        return {key: _meaning(item) for key, item in data.items() if key != "source"}
    return [_meaning(item) for item in data] if isinstance(data, list) else data


def installed(root: Path) -> dict[str, str]:
    """Return versions of installed distributions, and digests where a version does not fix the content."""
    code = code_of_packages(root).items()
    return {**versions(), **{f"code of {name}": HASH + data_digest(files) for name, files in code}}
