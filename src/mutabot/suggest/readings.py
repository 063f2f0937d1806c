"""What could be read at the end of a test or along its way, as the project itself can read it.

Three ways: the functions by which the tests read already, what the vocabulary's probes and readings name, and
what the test has at hand. Along the way, it is looked after which commands.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from mutabot.frozen import frozen
from mutabot.model import Operation

from .project import Name, Project, name_in
from .style import Place, Watch

#: from the one a reader of the tests knows best
ORACLE, PROBE, HAND, WAY = 0, 1, 2, 3


@frozen
class Reading:
    """An expression that reads something.

    Attributes:
        text: the expression.
        way: ``ORACLE``, ``PROBE``, ``HAND``, or ``WAY`` for one along the way of a test.
        tolerance: greatest difference of equal worlds in it.
        needs: imports that it needs.
        uses: names of the place that it uses.
        watch: what looks on the way, for a reading along it.
        shown: the expression where ``text`` is only what it was noted under.
    """

    text: str
    way: int
    tolerance: float
    needs: tuple[str, ...] = ()
    uses: tuple[str, ...] = ()
    watch: Watch | None = None
    shown: str = ""

    @property
    def expression(self) -> str:
        """As it stands in a test."""
        return self.shown or self.text


def readings_at(project: Project, place: Place) -> list[Reading]:
    """The readings of a place, those first by which the tests read already."""
    module = project.module(place.file)
    assert module is not None
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = [*_by_oracle(project, place, module, coarse)]
    for probe in vocabulary.probes:
        name = _module_level(module, probe.target, place) if not probe.owner else None
        if name is not None:
            texts = (f"{name.text}()", name.text)
            found += [Reading(text, PROBE, probe.tolerance, _needs(name)) for text in texts]
    for operation in vocabulary.operations:
        for text, name in _reading_calls(operation, module, place):
            found.append(Reading(text, PROBE, coarse, _needs(name)))
    found += [Reading(text, HAND, coarse, (), uses) for text, uses in _lookups(project, place)]
    return list({one.text: one for one in reversed(found)}.values())[::-1]


def of_objects(project: Project) -> list[tuple[str, float]]:
    """Readings of objects, ``module:Class.name``, each with its tolerance."""
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = {probe.target: probe.tolerance for probe in vocabulary.probes if probe.owner}
    for one in vocabulary.operations:
        if _only_reads(one) and not one.patterns and "." in one.qualname:
            found.setdefault(one.target, coarse)
    return list(found.items())


def _by_oracle(project: Project, place: Place, module: ast.Module, tolerance: float) -> Iterator[Reading]:
    """The oracle's functions, where all that they need is at hand under the same name."""
    for file in project.python_files(project.request.configuration.oracle):
        oracle = project.module(file)
        for node in oracle.body if oracle is not None and file != place.file else ():
            if not isinstance(node, ast.FunctionDef) or node.name.startswith(("_", "test")):
                continue
            given = node.args
            needed = [one.arg for one in (*given.posonlyargs, *given.args)]
            needed = needed[: len(needed) - len(given.defaults)]
            strict = any(default is None for default in given.kw_defaults)
            if strict or not set(needed) <= set(place.names) or node.decorator_list:
                continue
            name = name_in(module, project.import_name(file), node.name, place.names)
            yield Reading(f"{name.text}({', '.join(needed)})", ORACLE, tolerance, _needs(name), tuple(needed))


def _module_level(module: ast.Module, target: str, place: Place) -> Name | None:
    where, _, attribute = target.partition(":")
    return name_in(module, where, attribute, place.names) if attribute else None


def _only_reads(operation: Operation) -> bool:
    is_callable = operation.named is None and operation.kind is None
    return is_callable and not operation.command and not operation.arguments


def _reading_calls(operation: Operation, module: ast.Module, place: Place) -> Iterator[tuple[str, Name]]:
    """Calls that only read: an operation without arguments, or one that is told by a text what to read."""
    if not _only_reads(operation) or "." in operation.qualname:
        return
    name = _module_level(module, operation.target, place)
    if name is None:
        return
    if not operation.patterns:
        yield f"{name.text}()", name
    if operation.message and operation.message.isidentifier():
        for pattern in operation.patterns:
            if pattern.command is not True and pattern.notation and not pattern.fields and not pattern.when:
                yield f'{name.text}({operation.message}="{pattern.notation}")', name


def _lookups(project: Project, place: Place) -> Iterator[tuple[str, tuple[str, ...]]]:
    """What the tests look their expectations up by: keys of subscripts that need fixtures alone."""
    for file in (place.file, *project.beside(place.file)):
        module = project.module(file)
        for node in ast.walk(module) if module is not None else ():
            if not (isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load)):
                continue
            key = node.slice
            names = {one.id for one in ast.walk(key) if isinstance(one, ast.Name)}
            given = any(isinstance(one, ast.Call) and one.args for one in ast.walk(key))
            if isinstance(key, ast.Call | ast.Attribute) and not given and names <= set(place.names):
                yield ast.unparse(key), tuple(sorted(names))


def _needs(name: Name) -> tuple[str, ...]:
    return (name.needs,) if name.needs else ()


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
