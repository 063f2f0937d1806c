"""Names of the vocabulary under which nothing was done."""

from __future__ import annotations

import pytest

from mutabot import extensions
from mutabot.extensions import Extension
from mutabot.model.operation import Form, Named, Refused
from mutabot.runtime.targets.messages import Messages, unheard, unused


def said(wanted: str, *used: str) -> list[str]:
    found = unused([Named.of(wanted)], [Named.of(usage) for usage in used])
    assert all(target == wanted for target, _ in found)
    return [finding.text for _, finding in unused([Named.of(wanted)], [Named.of(usage) for usage in used])]


@pytest.mark.parametrize(
    ("wanted", "used", "text"),
    [
        (
            "publish /arm/goal",
            ["publish /cell/lamp", "publish /arm/gaol", "receive /arm/pose"],
            "no test published /arm/goal; seen: publish /arm/gaol, publish /cell/lamp",
        ),
        (
            "call /home",
            ["publish /lamp"],
            "no test called the service /home; nothing of that kind was seen under any name",
        ),
        (
            "call /home",
            ["call /hme", "client /hme"],
            "no test called the service /home; seen: call /hme",
        ),
        (
            "call /home",
            ["client /hme", "call /hme"],
            "no test called the service /home; seen: call /hme",
        ),
        (
            "call /home",
            [],
            "no test called the service /home; nothing of that kind was seen under any name; "
            "middlewares that are known here: bus",
        ),
        (
            "receive /arm/pose",
            ["subscribe /arm/pose of /mission"],
            "no test received anything on /arm/pose; seen: subscribe /arm/pose of /mission",
        ),
        (
            "publish /arm/goal of /miss*",
            ["publish /arm/goal of /pick"],
            "no test published /arm/goal in a node /miss*; seen: publish /arm/goal of /pick",
        ),
        (
            "goal /arm/follow",
            [f"goal /arm/f{number}" for number in range(6)],
            "no test sent a goal to /arm/follow; "
            "seen: goal /arm/f0, goal /arm/f1, goal /arm/f2, goal /arm/f3 and 2 more",
        ),
    ],
)
def test_what_was_not_done_is_reported_with_what_was_done_instead(
    wanted: str, used: list[str], text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extensions, "_declared", lambda: (("a", Extension(1, middlewares={"bus": "a.bus"})),))
    assert said(wanted, *used) == [text]


@pytest.mark.parametrize(
    ("wanted", "used"),
    [
        ("publish /arm/*", "publish /arm/goal of /pick"),
        ("advertise /arm/goal", "publish /other"),  # goes with what is published
        ("feedback /follow", "goal /follow"),
    ],
)
def test_what_was_done_or_goes_with_something_else_is_not_reported(wanted: str, used: str) -> None:
    assert said(wanted, used) == []


def test_what_a_process_below_the_tests_does_counts() -> None:
    here, there = (Messages(lambda target, finding: None) for _ in range(2))
    for messages in (here, there):
        messages.wrap("publish /arm/*", lambda *args: None)
        messages.wrap("call /home", lambda *args: None)
    there.find(Form.PUBLISH, "/arm/goal", "/pick")
    there.find(Form.CALL, "/hme", "/pick")
    assert set(there.here()) == {"publish /arm/goal of /pick", "publish /arm/*", "call /hme of /pick"}
    here.found_elsewhere([*there.here(), "robot:Arm.move"])
    assert [finding.text for _, finding in here.seek()] == [
        "no test called the service /home; seen: call /hme of /pick"
    ]


@pytest.mark.parametrize(
    ("used", "is_told"),
    [
        (["publish /arm/ended"], True),
        (["subscribe /arm/ending"], True),
        (["subscribe /arm/ended of /mission"], False),
        (["client /arm/ended"], False),
        (["receive /arm/ended"], False),
    ],
)
def test_a_refusal_that_nobody_can_hear_is_reported(used: list[str], is_told: bool) -> None:
    refused = [Refused("status", (5,), "/arm/ended"), Refused("ok", (False,))]
    found = [finding.text for finding in unheard(refused, [Named.of(usage) for usage in used])]
    assert [text.startswith("no node listens to /arm/ended") for text in found] == [True] * is_told
