"""Looking along the way of a test: after which commands, and the text that does so in a test file."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence

from mutabot.suggestion.project import Insertion, Project, name_in
from mutabot.suggestion.style import Function, Place, Watch, arguments_of

#: module, class (empty for what the module has itself) and name
Command = tuple[str, str, str]


def commands_of(project: Project) -> list[Command]:
    """The vocabulary's commands; functions also under the names that the program imports them by."""
    found: dict[Command, None] = {}
    for operation in project.request.vocabulary.operations:
        if operation.command and operation.named is None and operation.kind is None:
            owner, _, name = operation.qualname.rpartition(".")
            found[operation.module, owner, name] = None
            if not owner:
                found.update(dict.fromkeys(_imported(project, operation.module, name)))
    return list(found)


def _imported(project: Project, module: str, name: str) -> list[Command]:
    found = []
    for file in project.python_files(project.request.configuration.program):
        tree = project.module(file)
        for node in tree.body if tree is not None else ():
            if isinstance(node, ast.ImportFrom) and node.module == module and not node.level:
                names = [alias.asname or alias.name for alias in node.names if alias.name == name]
                found += [(project.import_name(file), "", one) for one in names]
    return found


_OF_COMMANDED = "args[0]"


def watch_of(
    project: Project, commands: Sequence[Command], place: Place, look: str
) -> tuple[Watch, tuple[str, ...]]:
    """What looks at this expression after every command, and the imports that it needs.

    An expression of the object that was commanded is looked at after the commands of objects alone.
    """
    module = project.module(place.file)
    assert module is not None
    found: dict[tuple[str, str], None] = {}
    needs: list[str] = []
    for where, owner, name in commands:
        if not owner and _OF_COMMANDED in look:
            continue
        if owner:
            first, dot, rest = owner.partition(".")
            holder = name_in(module, where, first, place.names)
            text = holder.text + dot + rest
            needs += [holder.needs] if holder.needs else []
        else:
            text = where
            needs.append(f"import {where}")
        found[text, name] = None
    parts = re.findall(r"[^\W\d]\w*", look.replace(_OF_COMMANDED, ""))
    slug = "_".join(dict.fromkeys(parts[-2:])).lower()
    return Watch(f"seen_{slug}", look, tuple(found)), tuple(dict.fromkeys(needs))


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
