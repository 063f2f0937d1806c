"""Small projects, and random edits of them: what `since_edits.py` edits, and how."""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent
from typing import Any

EXAMPLES = Path(__file__).parents[1] / "examples"
ERRANDS = {
    "mutabot.toml": """
        program = ["mission.py"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
    """,
    "robot.toml": """
        refusals = ["robot:Refused"]

        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

        [[operation]]
        call = "robot:Arm.grip"
        arguments.closed = { kind = "opening", values = [0, 1] }

        [[operation]]
        call = "robot:Arm.position"
        result = { kind = "position", axis = "x", unit = "m", noise = 0.5 }
    """,
    "robot.py": """
        class Refused(Exception):
            pass

        class Arm:
            reach = 1.0

            def __init__(self, x=0.0):
                self.x = x
                self.closed = 0

            def move_by(self, dx):
                if not -self.reach <= self.x + dx <= self.reach:
                    raise Refused(f"{self.x + dx} is out of reach")
                self.x += dx

            def grip(self, closed):
                self.closed = closed

            def position(self):
                return self.x
    """,
    "routes.py": """
        FAR = 0.5
        NEAR = 0.1

        def half(length):
            return length / 2

        def there_and_back(length):
            return [length, -length]
    """,
    "recovery.py": """
        def recover(arm, missing):
            arm.move_by(part(missing))
            if arm.x < 0.0:
                arm.move_by(home())

        def part(missing):
            return missing * 0.97

        def home():
            return 0.32
    """,
    "plans.py": """
        from functools import lru_cache
        from distances import far, near

        _stops = None

        def stops():
            global _stops
            if _stops is None:
                _stops = plan()
            return _stops

        def plan():
            return [near(), -near()]

        @lru_cache
        def reach():
            return far()

        class Route:
            known = {}

            def __init__(self, name):
                self.name = name

            def length(self):
                if self.name not in self.known:
                    self.known[self.name] = near() / 2
                return self.known[self.name]
    """,
    "distances.py": """
        def near():
            return 0.1

        def far():
            return 0.31
    """,
    "mission.py": """
        from plans import Route, reach, stops
        from recovery import recover
        from robot import Refused
        from routes import FAR, NEAR, half, there_and_back

        def deliver(arm):
            start = arm.x
            try:
                arm.move_by(0.3)
            except Refused:
                recover(arm, 0.3)
            if arm.x < start + 0.25:
                recover(arm, start + 0.3 - arm.x)

        def tour(arm):
            for stop in stops():
                arm.move_by(stop)
            arm.move_by(reach())

        def detour(arm):
            arm.move_by(Route("detour").length())
            arm.move_by(reach())

        def approach(arm, length):
            arm.move_by(half(length))
            arm.move_by(half(length))

        def fetch(arm):
            approach(arm, FAR)
            arm.grip(1)
            arm.move_by(-0.25)

        def bring(arm):
            arm.grip(1)
            arm.move_by(0.3)
            if arm.position() > 0.2:
                arm.grip(0)

        def patrol(arm):
            for step in there_and_back(NEAR):
                arm.move_by(step)
    """,
    "tests/conftest.py": """
        import pytest
        from robot import Arm

        @pytest.fixture
        def arm(mutabot_seed):
            return Arm(mutabot_seed % 7 / 100)
    """,
    "tests/helpers.py": """
        def is_near(one, other):
            return abs(one - other) < 0.05
    """,
    "tests/test_fetch.py": """
        import mission
        from helpers import is_near

        def test_fetches(arm):
            start = arm.x
            mission.fetch(arm)
            assert arm.closed == 1
            assert is_near(arm.x - start, 0.25)
    """,
    "tests/test_bring.py": """
        import mission

        def test_brings(arm):
            mission.bring(arm)
            assert arm.closed == 0
            assert arm.x > 0.2

        def test_brings_twice(arm):
            mission.bring(arm)
            mission.bring(arm)
            assert arm.x < 0.9
    """,
    "tests/test_deliver.py": """
        import mission
        import pytest
        from helpers import is_near

        @pytest.fixture(scope="module")
        def goal():
            return length()

        def length():
            return 0.3

        def test_delivers(arm, goal):
            start = arm.x
            mission.deliver(arm)
            assert is_near(arm.x - start, goal)

        def test_delivers_near(arm, goal):
            start = arm.x
            mission.deliver(arm)
            assert abs(arm.x - start - goal) < 0.2
    """,
    "tests/test_tour.py": """
        import mission
        from helpers import is_near

        def test_tours(arm):
            start = arm.x
            mission.tour(arm)
            assert is_near(arm.x - start, 0.31)

        def test_tours_with_a_detour(arm):
            start = arm.x
            mission.detour(arm)
            assert is_near(arm.x - start, 0.35)

        def test_tours_again(arm):
            start = arm.x
            mission.detour(arm)
            mission.tour(arm)
            assert abs(arm.x - start - 0.65) < 0.1
    """,
    "tests/test_patrol.py": """
        import mission
        from helpers import is_near

        def test_patrols(arm):
            start = arm.x
            mission.patrol(arm)
            assert is_near(arm.x, start)
    """,
}


#: a project most of whose code only mutants reach: recovery, and what the tests do where something is lost
RESCUE = {
    "mutabot.toml": ERRANDS["mutabot.toml"],
    "robot.toml": ERRANDS["robot.toml"],
    "robot.py": ERRANDS["robot.py"],
    "mission.py": """
        from robot import Refused
        from rescue import back_off, correct, drop, regrip

        def fetch(arm):
            goal = arm.x + 0.3
            try:
                arm.move_by(0.3)
            except Refused:
                back_off(arm)
            if abs(arm.x - goal) > 0.02:
                correct(arm, goal)
            arm.grip(1)
            if not arm.closed:
                regrip(arm)

        def carry(arm):
            start = arm.x
            arm.grip(1)
            arm.move_by(0.25)
            arm.move_by(-0.05)
            correct(arm, start + 0.2)
            arm.grip(0)
            if arm.closed:
                drop(arm)

        def look(arm):
            seen = arm.position()
            if abs(seen - arm.x) > 0.05:
                import last_resort

                last_resort.search(arm, seen)
            return arm.x
    """,
    "rescue.py": """
        from functools import lru_cache, wraps
        from parts import halves, limit

        ATTEMPTS = 3

        class Watch:
            lost = []

            def __init__(self, least):
                self.least = least

            def note(self, off):
                if off > self.least:
                    self.lost.append(off)
                return len(self.lost) * 0.01

        def counted(function):
            @wraps(function)
            def call(arm, *rest):
                call.calls += 1
                if call.calls > 40:
                    return None
                return function(arm, *rest)

            call.calls = 0
            return call

        @lru_cache
        def share():
            return 0.97

        def back_off(arm):
            arm.move_by(-0.15)
            for step in halves(0.2):
                if arm.x + step < limit():
                    arm.move_by(step)

        @counted
        def correct(arm, goal):
            if abs(goal - arm.x) > 0.001:
                nudge(arm, goal)

        def nudge(arm, goal):
            off = goal - arm.x
            slack = Watch(0.25).note(abs(off))
            arm.move_by(off * share() - slack)
            if abs(goal - arm.x) > 0.04:
                settle(arm, goal)

        def settle(arm, goal):
            def step():
                return (goal - arm.x) * 0.8

            for _ in range(ATTEMPTS):
                if abs(goal - arm.x) < 0.01:
                    break
                arm.move_by(step())

        def drop(arm):
            for _ in range(2):
                arm.move_by(0.02)
                arm.grip(0)

        def regrip(arm):
            arm.move_by(0.01)
            arm.grip(1)
            arm.move_by(-0.012)
    """,
    "parts.py": """
        def halves(length):
            for _ in range(4):
                length = length / 2
                yield length

        def limit():
            try:
                return float(open("limit.json").read())
            except OSError:
                return 0.7
    """,
    "limit.json": "0.6\n",
    "last_resort.py": """
        STEP = 0.02

        def search(arm, seen):
            side = 1 if seen > arm.x else -1
            arm.move_by(side * STEP)
            if abs(seen - arm.x) > 0.3:
                arm.move_by(side * far(seen - arm.x))

        def far(off):
            return min(abs(off) * 0.3, 0.25)
    """,
    "tests/conftest.py": """
        import pytest
        from robot import Arm
        from told import home

        @pytest.fixture
        def arm(mutabot_seed):
            arm = Arm(mutabot_seed % 7 / 100)
            yield arm
            if arm.x < -0.05 or arm.x > 0.75:
                home(arm)
                assert abs(arm.x) < 0.35
    """,
    "tests/told.py": """
        def home(arm):
            arm.move_by(-arm.x * 0.6)

        def wide(one, other):
            if abs(one - other) < 0.03:
                return True
            return nearly(one, other)

        def nearly(one, other):
            return abs(one - other) < 0.06
    """,
    "tests/test_fetch.py": """
        import mission
        from told import wide

        def test_fetches(arm):
            start = arm.x
            mission.fetch(arm)
            assert arm.closed == 1
            assert wide(arm.x - start, 0.3)

        def test_fetches_far(arm):
            arm.move_by(0.5)
            mission.fetch(arm)
            assert arm.x < 0.95
    """,
    "tests/test_look.py": """
        import mission
        from told import wide

        def test_looks(arm):
            assert wide(mission.look(arm), arm.x)
            assert arm.x < 0.2

        def test_fetches_and_looks(arm):
            start = arm.x
            mission.fetch(arm)
            mission.look(arm)
            assert wide(arm.x, start + 0.3)

        def test_carries(arm):
            start = arm.x
            mission.carry(arm)
            assert arm.closed == 0
            assert wide(arm.x, start + 0.2)
    """,
}


@dataclass(frozen=True)
class Subject:
    """A project to edit.

    Attributes:
        files: its files.
        program, tests, helpers: which files each kind of edit is for.
        hidden: files that only mutants reach.
        kept: files whose results outlive the test that asked for them first.
        vocabulary: its vocabulary.
        options: of ``mutabot run``.
        pinned: functions that a selection names, which must not go elsewhere.
    """

    files: dict[str, str]
    program: list[str]
    tests: list[str]
    helpers: list[str]
    hidden: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    vocabulary: str = "robot.toml"
    options: tuple[str, ...] = ()
    pinned: bool = False


def of_example(name: str, **details: Any) -> Subject:
    folder = EXAMPLES / name
    paths = [path for path in folder.rglob("*") if path.is_file()]
    names = {path.relative_to(folder).as_posix(): path for path in paths}
    wanted = {
        name: path
        for name, path in names.items()
        if not name.startswith((".", "script/")) and "/." not in name and "__pycache__" not in name
    }
    return Subject({name: path.read_text() for name, path in wanted.items()}, **details)


SUBJECTS: dict[str, Callable[[], Subject]] = {
    "errands": lambda: Subject(
        {name: dedent(text).lstrip() for name, text in ERRANDS.items()},
        program=["mission.py"],
        tests=[f"tests/test_{name}.py" for name in ("fetch", "bring", "patrol", "deliver", "tour")],
        helpers=["routes.py", "tests/helpers.py", "robot.py"],
        hidden=("recovery.py",),
        kept=("plans.py", "distances.py", "tests/test_deliver.py"),
    ),
    "rescue": lambda: Subject(
        {name: dedent(text).lstrip() for name, text in RESCUE.items()},
        program=["mission.py"],
        tests=["tests/test_fetch.py", "tests/test_look.py"],
        helpers=["robot.py", "tests/conftest.py"],
        hidden=("rescue.py", "parts.py", "last_resort.py", "tests/told.py"),
    ),
    "scales": lambda: of_example(
        "scales",
        program=["sorter.py"],
        tests=["tests/test_sorter.py", "tests/test_cell.py"],
        helpers=["cell.py", "link.py", "tests/scales.py", "tests/conftest.py"],
    ),
    "paper": lambda: of_example(
        "paper",
        program=["mission.py"],
        tests=["tests/test_mission.py"],
        helpers=["tests/expected.py", "tests/conftest.py", "tracker.py"],
        options=("--only", "@published.txt"),
        pinned=True,
    ),
}


class NotPossibleError(Exception):
    """This edit cannot be made here."""


def functions(text: str) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]


def replaced(text: str, node: Any, new: str) -> str:
    lines = text.encode().splitlines(keepends=True)
    first, last = node.lineno - 1, node.end_lineno - 1
    before = b"".join(lines[:first]) + lines[first][: node.col_offset]
    after = lines[last][node.end_col_offset :] + b"".join(lines[last + 1 :])
    whole: bytes = before + new.encode() + after
    return whole.decode()


def other_number(text: str, chance: random.Random, scale: float = 0.02) -> str:
    """A number in some function is a little different."""
    found = [
        (inner, inner.value)
        for function in functions(text)
        for statement in function.body
        for inner in ast.walk(statement)
        if isinstance(inner, ast.Constant)
        and isinstance(inner.value, int | float)
        and inner.value not in (0, 1, True)
    ]
    if not found:
        raise NotPossibleError
    node, value = chance.choice(found)
    other = value * (1 + scale * chance.choice((-1, 1)))
    new = repr(round(other, 6)) if isinstance(value, float) else str(value + chance.choice((-1, 1)))
    return replaced(text, node, new)


def more_lines(text: str, chance: random.Random) -> str:
    """A function has one more line that does nothing."""
    found = functions(text)
    if not found:
        raise NotPossibleError
    function = chance.choice(found)
    node = chance.choice(function.body)
    lines = text.splitlines(keepends=True)
    indent = " " * node.col_offset
    if lines[node.lineno - 1][: node.col_offset].strip():
        raise NotPossibleError
    lines.insert(node.end_lineno or node.lineno, f"{indent}_ = {chance.randint(1, 9)}\n")
    return "".join(lines)


def comment(text: str, chance: random.Random) -> str:
    """Lines go down."""
    lines = text.splitlines(keepends=True)
    place = next(
        index
        for index, line in enumerate(lines)
        if re.match(r"(def|class|import|from (?!__future__)|@)", line)
        and (not index or not lines[index - 1].startswith("@"))
    )
    lines.insert(place, f"# edit {chance.randint(1, 999)}\n" * chance.randint(1, 3))
    return "".join(lines)


def much_other_number(text: str, chance: random.Random) -> str:
    """A number in some function is quite different."""
    return other_number(text, chance, scale=round(chance.uniform(0.1, 0.9), 3))


def other_sign(text: str, chance: random.Random) -> str:
    """A comparison or a sum is the other way round."""
    opposites = {"<": ">", ">": "<", "+": "-", "-": "+"}
    lines = text.splitlines()
    found = [
        match
        for match in re.finditer(r" ([<>+-]) ", text)
        if lines[text.count("\n", 0, match.start())].startswith(" ")
    ]
    if not found:
        raise NotPossibleError
    match = chance.choice(found)
    return f"{text[: match.start(1)]}{opposites[match[1]]}{text[match.end(1) :]}"


def no_statement(text: str, chance: random.Random) -> str:
    """A statement of a function does nothing any more."""
    plain = ast.Expr | ast.AugAssign | ast.Break
    found = [node for function in functions(text) for node in ast.walk(function) if isinstance(node, plain)]
    if not found:
        raise NotPossibleError
    return replaced(text, chance.choice(found), "pass")


def of_meaning(kind: Callable[[Subject], Sequence[str]]) -> Callable[[Path, Subject, random.Random], str]:
    """What a function does is different."""

    def edit(folder: Path, subject: Subject, chance: random.Random) -> str:
        if not kind(subject):
            raise NotPossibleError
        path = folder / chance.choice(kind(subject))
        how = chance.choice((much_other_number, other_number, other_sign, no_statement, more_lines))
        path.write_text(how(path.read_text(), chance))
        return f"{how.__name__} in {path.relative_to(folder)}"

    return edit


def new_test(folder: Path, subject: Subject, chance: random.Random) -> str:
    """A test is there twice, the second time at the end of its file and with one more assert."""
    path = folder / chance.choice(subject.tests)
    text = path.read_text()
    able = [
        function
        for function in functions(text)
        if function.name.startswith("test_") and not function.decorator_list
    ]
    if not able:
        raise NotPossibleError
    node = chance.choice(able)
    if node.col_offset:
        raise NotPossibleError
    lines = text.splitlines()[node.lineno - 1 : node.end_lineno]
    lines[0] = lines[0].replace(node.name, f"{node.name}_once_more")
    first = chance.random() < 0.5
    new = "\n".join([*lines, f"    assert {chance.randint(1, 9)}"])
    if first:
        before, after = text.splitlines()[: node.lineno - 1], text.splitlines()[node.lineno - 1 :]
        path.write_text("\n".join([*before, new, "", *after]) + "\n")
    else:
        path.write_text(f"{text.rstrip()}\n\n{new}\n")
    return f"{node.name} once more, {'before it' if first else 'at the end'}, in {path.relative_to(folder)}"


def of_text(kind: Callable[[Subject], list[str]]) -> Callable[[Path, Subject, random.Random], str]:
    def edit(folder: Path, subject: Subject, chance: random.Random) -> str:
        path = folder / chance.choice(kind(subject))
        how = chance.choice((other_number, more_lines, comment))
        path.write_text(how(path.read_text(), chance))
        return f"{how.__name__} in {path.relative_to(folder)}"

    return edit


def changed_test(folder: Path, subject: Subject, chance: random.Random) -> str:
    path = folder / chance.choice(subject.tests)
    text = path.read_text()
    tests = [function for function in functions(text) if function.name.startswith("test_")]
    if tests and chance.random() < 0.5:
        last = chance.choice(tests).body[-1]
        lines = text.splitlines(keepends=True)
        lines.insert(last.end_lineno or 0, f"{' ' * last.col_offset}assert {chance.randint(1, 9)}\n")
        path.write_text("".join(lines))
        return f"one more assert in {path.relative_to(folder)}"
    return of_text(lambda _: [path.relative_to(folder).as_posix()])(folder, subject, chance)


def moved_function(folder: Path, subject: Subject, chance: random.Random) -> str:
    """A function goes to a file of its own, which the old one imports; it takes along the imports."""
    name = chance.choice([*subject.helpers, *([] if subject.pinned else subject.program)])
    path = folder / name
    text = path.read_text()
    tree = ast.parse(text)
    own = {statement.name for statement in tree.body if isinstance(statement, ast.FunctionDef | ast.ClassDef)}
    own |= {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    able = [
        statement
        for statement in tree.body
        if isinstance(statement, ast.FunctionDef)
        and not statement.decorator_list
        and not any(
            isinstance(node, ast.Name) and node.id in own - {statement.name} for node in ast.walk(statement)
        )
        and not any(isinstance(node, ast.Global) for node in ast.walk(statement))
    ]
    if not able:
        raise NotPossibleError
    node = chance.choice(able)
    lines = text.splitlines(keepends=True)
    body = "".join(lines[node.lineno - 1 : node.end_lineno])
    imports = "".join(
        "".join(lines[statement.lineno - 1 : statement.end_lineno])
        for statement in tree.body
        if isinstance(statement, ast.Import | ast.ImportFrom)
        and getattr(statement, "module", "") != "__future__"
        and any(re.search(rf"\b{alias.asname or alias.name}\b", body) for alias in statement.names)
    )
    future = "from __future__ import annotations\n"
    new = path.with_name(f"{node.name.strip('_')}_apart.py")
    new.write_text((future if future in text else "") + imports + "\n\n" + body)
    del lines[node.lineno - 1 : node.end_lineno]
    starts = ("import ", "from ", "def ", "class ")
    able_lines = (
        index
        for index, line in enumerate(lines)
        if line.startswith(starts) and not line.startswith("from __future__")
    )
    place = next(able_lines, len(lines))
    lines.insert(place, f"from {new.stem} import {node.name}\n")
    path.write_text("".join(lines))
    if name in subject.program:
        configure(folder, name, f'{name}", "{new.relative_to(folder).as_posix()}')
    return f"{node.name} goes from {name} to {new.relative_to(folder)}"


def configure(folder: Path, old: str, new: str) -> None:
    for path in (folder / "mutabot.toml", folder / "pyproject.toml"):
        if path.is_file():
            path.write_text(path.read_text().replace(f'"{old}"', f'"{new}"'))


def renamed_file(folder: Path, subject: Subject, chance: random.Random) -> str:
    named = (folder / subject.vocabulary).read_text()
    able = [
        name
        for name in ([] if subject.pinned else subject.program) + subject.helpers
        if f'"{Path(name).stem}:' not in named and Path(name).stem != "conftest"
    ]
    if not able:
        raise NotPossibleError
    name = chance.choice(able)
    old = Path(name).stem
    new = f"{old}_{chance.choice(('main', 'new', 'parts'))}"
    (folder / name).rename((folder / name).with_name(f"{new}.py"))
    for path in folder.rglob("*.py"):
        text = path.read_text()
        imports = rf"(?m)^(\s*(?:from|import)\s+){old}\b"
        if re.search(imports, text):
            text = re.sub(imports, rf"\g<1>{new}", text)
            text = re.sub(rf"\b{old}\.(?=\w)", f"{new}.", text)
            path.write_text(text)
    configure(folder, name, name.replace(f"{old}.py", f"{new}.py"))
    return f"{name} becomes {new}.py"


def changed_entry(folder: Path, subject: Subject, chance: random.Random) -> str:
    path = folder / subject.vocabulary
    text = path.read_text()
    found = list(re.finditer(r"(noise = |tolerance = |range = \[0, )(\d+(?:\.\d+)?)", text))
    if not found:
        path.write_text("# another comment\n" + text)
        return "a comment in the vocabulary"
    match = chance.choice(found)
    value = float(match[2]) * chance.choice((0.5, 0.9, 1.1))
    path.write_text(f"{text[: match.start(2)]}{value:g}{text[match.end(2) :]}")
    return f"{match[0]} in the vocabulary becomes {value:g}"


EDITS: dict[str, Callable[[Path, Subject, random.Random], str]] = {
    "program": of_text(lambda subject: subject.program),
    "moved": moved_function,
    "renamed": renamed_file,
    "test": changed_test,
    "vocabulary": changed_entry,
    "helper": of_text(lambda subject: subject.helpers),
    "hidden": of_meaning(lambda subject: subject.hidden),
    "kept": of_meaning(lambda subject: subject.kept),
    "new test": new_test,
}
