"""What a call was given, and what it gave, lives as long as the program keeps it, and no longer."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from random import Random
from typing import Any

import pytest

from mutabot.model import Mutant, Role, Site, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.events import SiteSeen
from mutabot.model.mutant import Place
from mutabot.operators import Subject, names, operator
from mutabot.operators.command import CONTROLS
from mutabot.runtime.fault_runner import FaultRunner
from mutabot.runtime.session import Session
from tests.runtime.stage import Make, Stage

ROBOT = """
class Refused(Exception): pass
class Answer:
    def __init__(self, x): self.x, self.colour, self.angle, self.near = x, "red", 0.3 + x, True
class Arm:
    def __init__(self, refuses=False): self.x, self.refuses = 0.5, refuses
    {a}def move_by(self, dx, tag):
        x = self.x = self.x + dx
        refuses = self.refuses
        del self, tag
        if refuses: raise Refused(f"no way to {{x}}")
        return Answer(x)
    {a}def turn_to(self, angle, speed, seconds, tag): return Answer(angle)
    {a}def orient(self, rotation, tag): return None
    {a}def grip(self, closed, tag): return None
    {a}def go(self, frame, tag): return None
    {a}def home(self, tag): return None
    {a}def locate(self, tag):
        self.x += 0.01
        return Answer(self.x)
    {a}def wait(self, seconds): return None
def tick(): return 0.0
"""
PROGRAM = """
import weakref
import robot
class Tag:
    pass
def noted(value, refs):
    refs.append(weakref.ref(value))
    return value
{a}def work(arm, refs, kept):
    noted(arm, refs)
    for number in (1, 2, 3):
        try:
            answer = {w}arm.move_by(0.1 * number, noted(Tag(), refs))
            noted(answer, refs)
            del answer
        except (robot.Refused, RuntimeError) as error:
            kept.append(error)
            noted(error, refs)
    {w}arm.turn_to(0.4, 0.2, 1.0, noted(Tag(), refs))
    {w}arm.orient([0.0, 0.3, 0.1], noted(Tag(), refs))
    {w}arm.grip(True, noted(Tag(), refs))
    {w}arm.go("base", noted(Tag(), refs))
    {w}arm.home(noted(Tag(), refs))
    for number in (1, 2, 3):
        answer = {w}arm.locate(noted(Tag(), refs))
        noted(answer, refs)
        del answer
{a}def later(arm):
    for _ in range(3):
        try:
            {w}arm.home(None)
        except Exception:  # of a call that a mutant makes after it
            pass
"""
VOCABULARY = """
refusals = ["robot:Refused"]
wait = {{ call = "robot:Arm.wait", unit = "s" }}
[[operation]]
call = "robot:Arm.move_by"
current = "robot:Arm.locate"
arguments.dx = {{ kind = "translation", axis = "x", unit = "m", mode = "by", frame = "base" }}
result.".x" = {{ kind = "position", axis = "x", unit = "m" }}
[[operation]]
call = "robot:Arm.turn_to"
arguments.angle = {{ kind = "rotation", axis = "z", unit = "rad", mode = "to", range = [-3, 3] }}
arguments.speed = {{ kind = "speed", axis = "x", unit = "m/s" }}
arguments.seconds = {{ kind = "duration", unit = "s" }}
[[operation]]
call = "robot:Arm.orient"
arguments.rotation = {{ kind = "rotation_vector", unit = "rad" }}
[[operation]]
call = "robot:Arm.grip"
arguments.closed = {{ kind = "output", values = [false, true] }}
[[operation]]
call = "robot:Arm.go"
arguments.frame = {{ kind = "frame_id", values = ["base", "tool"] }}
[[operation]]
call = "robot:Arm.home"
[[operation]]
call = "robot:Arm.locate"
command = false
result.".x" = {{ kind = "position", axis = "x", unit = "m" }}
result.".angle" = {{ kind = "orientation", axis = "z", unit = "rad" }}
result.".colour" = {{ kind = "label", values = ["red", "blue"], missing = "none" }}
result.".near" = {{ kind = "flag", values = [false, true] }}
"""
#: what a skipped command answers: other answers at each call, so that the last one is asked for
IDLE = {"answers": [None, 1.0], "of_test": {}, "varying": ["0 test"]}


def stage_of(make_stage: Make, *, is_async: bool) -> Stage:
    words = {"a": "async " if is_async else "", "w": "await " if is_async else ""}
    return make_stage(ROBOT.format(**words), PROGRAM.format(**words), VOCABULARY.format())


def driven(found: Any) -> Any:
    """What a call gives; of a coroutine that suspends nowhere, what it returns."""
    if not hasattr(found, "send"):
        return found
    try:
        found.send(None)
    except StopIteration as end:
        return end.value
    raise AssertionError("it waits for something")


def mutants(vocabulary: Vocabulary, sites: list[SiteSeen]) -> Iterator[Mutant]:
    """One mutant of each operator at each operation that it has something to say about."""
    for name in [*names(), *CONTROLS]:
        rule = operator(name)
        for operation in vocabulary.operations:
            subjects: dict[Any, Subject] = {}
            for subject in rule.subjects(Subject(operation)):
                subjects.setdefault((subject.quantity and subject.quantity.name, subject.variant), subject)
            seen = next((seen_site for seen_site in sites if seen_site.operation == operation.target), None)
            for (quantity, variant), subject in subjects.items() if seen is not None else ():
                site = Site(seen.span, "text", 1, Role.PROGRAM)
                yield Mutant(
                    1, rule.family, name, site, operation.target, None, quantity, variant, "", IDLE,
                    magnitude=subject.magnitude, unit=subject.unit, direction=subject.direction,
                )  # fmt: skip


NOTHING = ["0 objects in cycles"]
#: the packages that bring operators are asked for once in a process, which leaves something to collect
names()


@contextmanager
def no_collection() -> Iterator[None]:
    gc.collect()
    gc.freeze()  # what is there before is of no interest, and takes its time
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def survivors_of(stage: Stage, session: Session | None, *, refuses: bool = False) -> list[str]:
    """The kinds of what has survived a run of the program, and how much the collector finds."""
    robot, program = stage.load_robot(), stage.load_program()
    refs: list[weakref.ref[Any]] = []
    kept: list[BaseException] = []
    with suppress(BaseException):  # a mutant may end it
        driven(program.work(robot.Arm(refuses), refs, kept))
    if session is not None:  # a mutant may make a call after the program's next one
        driven(program.later(robot.Arm()))
    alive = [found for found in (ref() for ref in refs) if found is not None]
    kinds = sorted(type(thing).__name__ for thing in alive if not isinstance(thing, BaseException))
    del alive
    kept.clear()
    kinds += sorted(f"{type(ref()).__name__} without exceptions" for ref in refs if ref() is not None)
    return [*kinds, f"{gc.collect()} objects in cycles"]


def survivors_in_plain(make_stage: Make, *, is_async: bool, refuses: bool) -> list[str]:
    """The same without us."""
    stage = stage_of(make_stage, is_async=is_async)
    stage.load_program()
    with no_collection():
        return survivors_of(stage, None, refuses=refuses)


@pytest.mark.parametrize("is_async", [False, True])
@pytest.mark.parametrize("refuses", [False, True])
def test_a_recorded_call_keeps_nothing(make_stage: Make, is_async: bool, refuses: bool) -> None:
    plain = survivors_in_plain(make_stage, is_async=is_async, refuses=refuses)
    stage = stage_of(make_stage, is_async=is_async)
    session = stage.session(record=True)
    stage.load_program()
    with no_collection():
        assert survivors_of(stage, session, refuses=refuses) == plain


@pytest.mark.parametrize(
    ("is_async", "refuses", "is_fork"),
    [
        (False, False, False),
        (True, True, True),
        pytest.param(True, False, False, marks=pytest.mark.whole),
        pytest.param(False, True, True, marks=pytest.mark.whole),
    ],
)
def test_no_mutant_keeps_what_a_call_was_given(
    make_stage: Make, is_async: bool, refuses: bool, is_fork: bool
) -> None:
    plain = survivors_in_plain(make_stage, is_async=is_async, refuses=refuses)
    assert (plain != NOTHING) is refuses  # who keeps an exception keeps what the robot's frames do
    stage = stage_of(make_stage, is_async=is_async)
    session = stage.session(record=True)
    survivors_of(stage, session)
    acted, wrong = set(), []
    planned = list(mutants(stage.vocabulary, stage.sites()))
    with no_collection():
        for mutant in planned:
            become(session, mutant, is_fork=is_fork)
            gc.collect()
            found = survivors_of(stage, session, refuses=refuses)
            assert session.mutant is not None
            if session.mutant.activity.acted:
                acted.add(mutant.operator)
            if found not in (plain, NOTHING):  # a mutant may also keep the robot from refusing
                wrong.append((mutant.operator, mutant.operation, mutant.quantity, mutant.variant, found))
    assert wrong == []
    assert refuses or len(acted) > 20, acted


def become(session: Session, mutant: Mutant, *, is_fork: bool) -> None:
    """Begin a test as a mutant, or become one in it, as a fork does."""
    session.dispatcher.mutant, session.is_fork = None, False
    session.fault, session.test = FaultRunner(session, lambda mutant: Random(1)), ""
    if not is_fork:
        session.fault.take_on(mutant, Activation.of_call(Place.of(mutant)))
    session.start_test("test")
    if is_fork:
        session.become(mutant, Activation.of_call(Place.of(mutant)))
