"""Uses of callables turned into proposed operations."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from .commands import MESSAGES, patterns_of
from .guess import Guess, Setting, guess_argument, guess_reading
from .resolve import Instance, Resolver, is_property
from .sources import Definition
from .uses import Use, parameters

_COMMANDS = re.compile(
    r"(?:^|_)(?:home|park|move|go|pick|place|grasp|grip|release|open|close|wait|sleep|stop|lift|lower|rotate|turn"
    r"|translate|attach|detach|push|start|feed|insert|press|screw|weld)(?:_|$)"
)
_READERS = re.compile(r"(?:^|_)(?:read|get|query|ask|measure)(?:_|$)")
_REFUSAL = re.compile(r"refus|reach|limit|reject|range|unable|collision", re.IGNORECASE)
_TALK = re.compile(r"(?:^|_)(?:log|print|say|show|info|warn|warning|debug|error|display)(?:_|$)")
_POSE = re.compile(r"pose|position|locat|where|xyz|point")
_PAIRS = (("open", "close"), ("grip", "release"), ("grasp", "release"), ("attach", "detach"), ("on", "off"))
_AXES = ("x", "y", "z", "roll", "pitch", "yaw")


@dataclass
class Proposal:
    """One proposed operation.

    Attributes:
        definition: the callable.
        arguments, result: guesses by path; ``""`` is the result itself.
        message: argument with a text command, or None.
        patterns: notations of the text commands.
        current, opposite: targets of other operations, or None.
        refusals: exceptions it raises that look like a refusal.
        certain: whether the program really uses this callable, or only the names suggest it.
        reads_by_name: whether the text only says what to read.
    """

    definition: Definition
    arguments: dict[str, Guess] = field(default_factory=dict)
    result: dict[str, Guess] = field(default_factory=dict)
    message: str | None = None
    patterns: list[tuple[str, Guess]] = field(default_factory=list)
    current: str | None = None
    opposite: str | None = None
    refusals: list[str] = field(default_factory=list)
    certain: bool = True
    reads_by_name: bool = False

    @property
    def target(self) -> str:
        """As vocabularies name it."""
        return self.definition.target

    @property
    def is_reading(self) -> bool:
        """Whether it takes nothing and answers something."""
        return bool(self.result) and not self.arguments and self.message is None


def proposals(uses: Sequence[Use], resolver: Resolver) -> tuple[list[Proposal], list[Use]]:
    """Proposed operations, and the uses that look like none."""
    found: dict[str, Proposal] = {}
    others = []
    for use in uses:
        proposal = _proposal(use, resolver)
        if _says_something(proposal) or _is_command(use):
            found[use.definition.target] = proposal
        else:
            others.append(use)
    for proposal in list(found.values()):
        _find_current(proposal, found, resolver)
    for proposal in found.values():
        _find_opposite(proposal, found)
    return list(found.values()), others


def _proposal(use: Use, resolver: Resolver) -> Proposal:
    definition = use.definition
    proposal = Proposal(definition, certain=use.certain)
    proposal.refusals = list(dict.fromkeys(_refusals(definition, resolver)))
    proposal.message = _message(use)
    proposal.reads_by_name = proposal.message is not None and _reads(use)
    for argument in parameters(definition):
        if argument.arg != proposal.message:
            proposal.arguments.update(_argument(argument, use, resolver))
    if proposal.message is not None:
        proposal.patterns = patterns_of([str(one) for one in use.constants.get(proposal.message, [])])
    else:
        proposal.result = _result(use, resolver)
    return proposal


def _says_something(proposal: Proposal) -> bool:
    return bool(proposal.arguments or proposal.result or proposal.patterns)


def _is_command(use: Use) -> bool:
    node = use.definition.node
    assert not isinstance(node, ast.ClassDef)
    answers = node.returns is not None and ast.unparse(node.returns) not in ("None", "bool")
    return not answers and not is_property(use.definition) and bool(_COMMANDS.search(_snake(node.name)))


def _message(use: Use) -> str | None:
    """The argument that holds a text command."""
    if _TALK.search(_snake(use.definition.node.name)):
        return None
    reads = _reads(use)
    for argument in parameters(use.definition):
        texts = [one for one in use.constants.get(argument.arg, []) if isinstance(one, str)]
        if texts and (argument.arg in MESSAGES or (reads and argument.arg == "name")):
            return argument.arg
    return None


def _reads(use: Use) -> bool:
    return _READERS.search(_snake(use.definition.node.name)) is not None


def _argument(argument: ast.arg, use: Use, resolver: Resolver) -> Iterator[tuple[str, Guess]]:
    definition, name = use.definition, argument.arg
    setting = _setting(definition, argument.annotation, use.constants.get(name, []))
    guess = guess_argument(name, setting)
    if guess.table:
        yield name, guess
        return
    known = resolver.annotated(argument.annotation, definition.module)
    for path, field_name, doc in _fields(known, resolver):
        inner = Setting(f"{setting.words}_{_snake(name)}", f"{doc}\n{setting.doc}")
        guess = guess_argument(field_name, inner)
        if guess.table:
            yield f"{name}{path}", guess


def _result(use: Use, resolver: Resolver) -> dict[str, Guess]:
    definition = use.definition
    assert not isinstance(definition.node, ast.ClassDef)
    annotation = definition.node.returns
    setting = _setting(definition, annotation, use.compared)
    guesses = {}
    for path, name, doc in _fields(resolver.annotated(annotation, definition.module), resolver):
        guesses[path] = guess_reading(name, Setting("", f"{doc}\n{setting.doc}"))
    for path, name in _parts(definition, setting):
        guesses.setdefault(path, guess_reading(name, Setting("", setting.doc)))
    guesses = {path: guess for path, guess in guesses.items() if guess.table}
    if not guesses and setting.annotation != "None" and _answers(definition.node):
        guess = guess_reading(
            _snake(definition.node.name).removeprefix("get_").removeprefix("read_"), setting
        )
        guesses = {"": guess} if guess.table else {}
    return guesses


def _answers(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    return node.returns is not None or any(
        isinstance(one, ast.Return) and one.value is not None for one in ast.walk(node)
    )


def _fields(value: object, resolver: Resolver, depth: int = 2) -> Iterator[tuple[str, str, str]]:
    """Path, name and docstring of the fields of an object's class."""
    if not isinstance(value, Instance) or depth == 0:
        return
    node = value.type.node
    assert isinstance(node, ast.ClassDef)
    doc = ast.get_docstring(node) or ""
    for statement in node.body:
        if not isinstance(statement, ast.AnnAssign) or not isinstance(statement.target, ast.Name):
            continue
        name = statement.target.id
        yield f".{name}", name, doc
        inner = resolver.annotated(statement.annotation, value.type.module)
        for path, inner_name, inner_doc in _fields(inner, resolver, depth - 1):
            yield f".{name}{path}", inner_name, inner_doc


def _parts(definition: Definition, setting: Setting) -> Iterator[tuple[str, str]]:
    """Path and name of the parts of a tuple, list or dict that a function returns."""
    size = len(re.findall(r"float|int", setting.annotation)) if "uple" in setting.annotation else 0
    if _POSE.search(setting.words) and size in (2, 3, 6):
        yield from ((f"[{index}]", name) for index, name in enumerate(_AXES[:size]))
        return
    for node in ast.walk(definition.node):
        value = node.value if isinstance(node, ast.Return) else None
        if isinstance(value, ast.Tuple | ast.List):
            names = [getattr(one, "id", getattr(one, "attr", "")) for one in value.elts]
            yield from ((f"[{index}]", name) for index, name in enumerate(names) if name)
        elif isinstance(value, ast.Dict):
            keys = [key.value for key in value.keys if isinstance(key, ast.Constant)]
            yield from ((f'["{key}"]', key) for key in keys if isinstance(key, str))


def _refusals(definition: Definition, resolver: Resolver) -> Iterator[str]:
    scope = resolver.scope(definition.module, None, None)
    for node in ast.walk(definition.node):
        if not isinstance(node, ast.Raise) or node.exc is None:
            continue
        raised = scope.value(node.exc.func if isinstance(node.exc, ast.Call) else node.exc)
        if isinstance(raised, Definition) and _REFUSAL.search(raised.node.name):
            yield raised.target


def _find_current(proposal: Proposal, found: dict[str, Proposal], resolver: Resolver) -> None:
    """Look for the reading that tells where a moved thing is; it may be one the program never uses."""
    reading_of = {"translation": "position", "rotation": "orientation"}
    wanted = {
        (reading_of[guess.table["kind"]], guess.table.get("axis"))
        for guess in proposal.arguments.values()
        if guess.table.get("kind") in reading_of and guess.table.get("axis")
    }
    owner = proposal.definition.owner
    if not wanted or owner is None or not isinstance(owner.node, ast.ClassDef):
        return
    for statement in owner.node.body:
        if not isinstance(statement, ast.FunctionDef) or statement.name.startswith("_"):
            continue
        method = Definition(owner.module, f"{owner.qualname}.{statement.name}", statement, owner)
        reading = found.get(method.target) or _proposal(Use(method), resolver)
        read = {(guess.table.get("kind"), guess.table.get("axis")) for guess in reading.result.values()}
        if not parameters(method) and wanted & read:
            found.setdefault(method.target, reading)
            proposal.current = method.target
            return


def _find_opposite(proposal: Proposal, found: dict[str, Proposal]) -> None:
    head, dot, name = (
        proposal.target.rpartition(".") if "." in proposal.target else proposal.target.rpartition(":")
    )
    for pair in _PAIRS:
        for one, other in (pair, pair[::-1]):
            candidate = found.get(f"{head}{dot}{re.sub(rf'(?<![a-z]){one}(?![a-z])', other, name)}")
            if candidate is None or candidate is proposal:
                continue
            if set(candidate.arguments) == set(proposal.arguments):
                proposal.opposite = candidate.target
                return


def _setting(definition: Definition, annotation: ast.expr | None, constants: Sequence[object]) -> Setting:
    owner = definition.owner
    names = (
        definition.module.name.rpartition(".")[2],
        owner.node.name if owner else "",
        definition.node.name,
    )
    words = "_".join(_snake(name) for name in names if name)
    docs = [ast.get_docstring(definition.node) or "", ast.get_docstring(owner.node) or "" if owner else ""]
    written = ast.unparse(annotation) if annotation is not None else ""
    return Setting(
        words, "\n".join(docs), written.rpartition(".")[2] if "[" not in written else written, constants
    )


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
