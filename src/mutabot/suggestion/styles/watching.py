"""Text that looks after every command on the way of a test, as a fixture or as a helper of a ``TestCase``."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.suggestion.sources.texts import Insertion

from .style import Function, Watch, arguments_of


def fixture(watch: Watch, *, for_all: bool = False) -> list[str]:
    """A fixture of pytest that is the list of what was seen; ``for_all`` tests of its file."""
    return [
        f"@pytest.fixture{'(autouse=True)' if for_all else ''}",
        f"def {watch.name}(monkeypatch: pytest.MonkeyPatch) -> list:",
        *_seeing(watch),
        f"    for owner, name in {_pairs(watch)}:",
        "        monkeypatch.setattr(owner, name, watched(getattr(owner, name)))",
        "    return seen",
    ]


def helper(watch: Watch) -> list[str]:
    """The same as a function that a ``TestCase`` calls."""
    return [
        f"def {watcher(watch.name)}(test):",
        *_seeing(watch),
        f"    for owner, name in {_pairs(watch)}:",
        "        patch = mock.patch.object(owner, name, watched(getattr(owner, name)))",
        "        patch.start()",
        "        test.addCleanup(patch.stop)",
        "    return seen",
    ]


def watcher(name: str) -> str:
    """The name of the function that watches what a list of this name keeps."""
    return f"watch_{name.removeprefix('seen_')}"


def _seeing(watch: Watch) -> list[str]:
    of = " of what was commanded" if "args[0]." in watch.look else ""
    return [
        f'    """What {watch.look.replace("args[0].", "")}{of} was after each command."""',
        "    seen = []",
        "",
        "    def watched(command):",
        "        def and_seen(*args, **kwargs):",
        "            result = command(*args, **kwargs)",
        f"            seen.append({watch.look})",
        "            return result",
        "",
        "        return and_seen",
        "",
    ]


def _pairs(watch: Watch) -> str:
    pairs = ", ".join(f'({owner}, "{name}")' for owner, name in watch.commands)
    return f"({pairs},)" if len(watch.commands) == 1 else f"({pairs})"


def asked_for(file: str, function: Function, lines: Sequence[str], names: Sequence[str]) -> list[Insertion]:
    """What lets a test function ask for fixtures that it did not ask for."""
    new = [name for name in names if name not in arguments_of(function)]
    given = function.args
    if not new or given.vararg or given.kwarg or given.kwonlyargs or given.defaults:
        return []
    known = [*given.posonlyargs, *given.args]
    added = ", ".join(new)
    if known:
        last = known[-1]
        number = last.end_lineno or last.lineno
        at = len(lines[number - 1].encode()[: last.end_col_offset or 0].decode())
        added = f", {added}"
    else:
        number = function.lineno
        at = lines[number - 1].index("(", lines[number - 1].index(function.name)) + 1
    line = lines[number - 1]
    return [Insertion(file, number - 1, (line[:at] + added + line[at:],), instead=1)]


def at_start(file: str, function: Function, lines: Sequence[str], added: Sequence[str]) -> list[Insertion]:
    """What puts statements at the beginning of a method, before all that it does."""
    first = function.body[0]
    indent = lines[first.lineno - 1][: first.col_offset]
    return [Insertion(file, first.lineno - 1, tuple(indent + line for line in added))] if added else []
