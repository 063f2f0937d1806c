"""A kind of target is one file: the session finds it by the operation's word and needs nothing else."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import ModuleType
from typing import Any

import pytest

from mutabot.model import Operation
from mutabot.model.events import Problem
from mutabot.runtime.session import Session
from mutabot.runtime.targets.target import Finding, Handler, Targets, Tell
from tests.runtime.stage import Make, Stage

ROBOT = "def move(x):\n    raise AssertionError('this kind asks no Python callable')\n"
PROGRAM = "import bus\n\ndef run():\n    return bus.publish('robot:move', 0.25)\n"
VOCABULARY = """
[[operation]]
call = "robot:move"
arguments."args[0]" = { kind = "translation", axis = "x", unit = "m", mode = "by" }
"""


class Topics(Targets):
    """What a program publishes on a bus, by the topic's name."""

    def __init__(self, tell: Tell) -> None:
        self.handlers: dict[str, Handler] = {}
        self.received: list[Any] = []
        self.is_removed = False

    def wrap(self, target: str, handler: Handler) -> None:
        self.handlers[target] = handler

    def publish(self, topic: str, *message: Any) -> Any:
        return self.handlers[topic](self._deliver, None, message, {})

    def _deliver(self, *args: Any) -> str:
        self.received.append(args)
        return "delivered"

    def remove(self) -> None:
        self.is_removed = True

    def seek(self) -> Iterator[tuple[str, Finding]]:
        for target in self.handlers:
            yield target, Finding("call", f"nobody listens to {target}")

    def check(self, operation: Operation) -> Iterator[Finding]:
        return iter(())


@pytest.fixture
def stage(make_stage: Make, monkeypatch: pytest.MonkeyPatch) -> Stage:
    """A stage whose one operation is of a kind that only this file knows."""
    file = ModuleType("topics")
    file.__dict__["KIND"] = Topics
    monkeypatch.setitem(sys.modules, "mutabot.runtime.targets.topics", file)
    made = make_stage(ROBOT, PROGRAM, VOCABULARY)
    vocabulary = made.vocabulary
    operations = tuple(replace(one, kind="topics") for one in vocabulary.operations)
    known = replace(vocabulary, operations=operations)
    monkeypatch.setattr(Stage, "vocabulary", property(lambda self: known))
    return made


def topics_of(stage: Stage, session: Session, monkeypatch: pytest.MonkeyPatch) -> Topics:
    topics = session.interception.of("topics")
    assert isinstance(topics, Topics)
    bus = ModuleType("bus")
    bus.__dict__["publish"] = lambda name, *message: topics.publish(session_target(stage), *message)
    monkeypatch.setitem(sys.modules, "bus", bus)
    return topics


def session_target(stage: Stage) -> str:
    return stage.vocabulary.operations[0].target


def test_a_message_goes_the_way_of_all_calls(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    session = stage.session()
    topics = topics_of(stage, session, monkeypatch)
    assert stage.run(session) == "delivered"
    assert topics.received == [(0.25,)]
    assert [seen.operation for seen in stage.sites()] == [session_target(stage)]
    assert [hit[1] for hit in session.recorder.trace] == [{"args[0]": 0.25}]


def test_a_mutant_changes_what_is_sent(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "run", run_on_the_bus(stage, monkeypatch))
    result, activation = stage.mutated("reverse", "args[0]")
    assert result == "delivered"
    assert activation.evidence.example == (0.25, -0.25)


def run_on_the_bus(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    plain = Stage.run

    def run(self: Stage, session: Session) -> Any:
        topics = topics_of(stage, session, monkeypatch)
        sys.modules.pop(stage.program_name, None)
        result = plain(self, session)
        expected = -0.25 if session.activations else 0.25
        assert topics.received == [(expected,)]
        return result

    return run


def test_it_is_looked_for_and_taken_away_as_it_says(stage: Stage) -> None:
    session = stage.session()
    session.inspect_targets()
    problems = [line for line in stage.pipe.lines if isinstance(line, Problem)]
    assert [problem.text for problem in problems] == [f"nobody listens to {session_target(stage)}"]
    topics = session.interception.of("topics")
    session.remove()
    assert isinstance(topics, Topics)
    assert topics.is_removed
