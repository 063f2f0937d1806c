"""Mutants of what is done on a middleware: how they are described, and their ids."""

from __future__ import annotations

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.plan import make_plan
from mutabot.families import ROBOT
from mutabot.faults import Project
from mutabot.model import Kind, Mode, Mutant, Operation, Path, Quantity, Role, Site, Span, Vocabulary
from mutabot.model.mutant import Place
from mutabot.model.operation import Form, Named
from mutabot.original import Hit, RecordedAnswers

Y = Quantity(
    *("pose.position.y", Path.parse("message.pose.position.y", rooted=True), Kind.TRANSLATION, "y", "m"),
    mode=Mode.TO,
)
READ_Y = Quantity("pose.position.y", Path.parse(".pose.position.y", rooted=False), Kind.POSITION, "y", "m")
SPAN = Span("pick.py", 31, 4, 31, 30, "Pick.run")


def operation(form: Form, name: str, node: str | None = None) -> Operation:
    named = Named(form, name, node)
    arguments, result = ((Y,), ()) if form is Form.PUBLISH else ((), (READ_Y,))
    is_command = form is Form.PUBLISH
    return Operation(named.target, arguments, result, is_command, kind="messages", named=named)


def project(vocabulary: Vocabulary) -> Project:
    return Project(vocabulary=vocabulary, families=(ROBOT,))


def mutants(text: str, *operations: Operation, role: Role = Role.PROGRAM) -> dict[str, str]:
    """The descriptions of mutants of calls at one site, by id."""
    site = Site(SPAN, text, 1, role)
    values = {"pose.position.y": 0.2}
    hits = {Place(site, operation_named.target): [Hit(values, values)] for operation_named in operations}
    answers = {place: RecordedAnswers() for place in hits}
    plan = make_plan(Baseline(hits=hits, answers=answers), project(Vocabulary(operations)))
    wanted: list[Mutant] = [mutant for mutant in plan.mutants if mutant.operator in ("reverse", "negate")]
    return {mutant.id: mutant.description for mutant in wanted}


def test_what_is_published_is_identified_by_its_name_and_its_id_by_the_text() -> None:
    assert mutants("self.goals.publish", operation(Form.PUBLISH, "/arm/goal")) == {
        "pick.py:Pick.run:self.goals.publish#1:pose.position.y:reverse": (
            "publish /arm/goal: pose.position.y 0.2 m → -0.2 m"
        )
    }


def test_a_callback_is_named_with_what_it_hears() -> None:
    assert mutants("def on_goal", operation(Form.RECEIVE, "/arm/goal", "/pick")) == {
        "pick.py:Pick.run:def on_goal#1:pose.position.y:negate": (
            "def on_goal, receive /arm/goal of /pick: reads pose.position.y -0.2 m instead of 0.2 m"
        )
    }


def test_one_site_that_publishes_on_two_topics_has_mutants_of_both() -> None:
    left, right = (operation(Form.PUBLISH, name) for name in ("/left", "/right"))
    assert mutants("publisher.publish", left, right) == {
        "pick.py:Pick.run:publisher.publish#1:pose.position.y:reverse": (
            "publish /left: pose.position.y 0.2 m → -0.2 m"
        ),
        "pick.py:Pick.run:publisher.publish#1:pose.position.y:reverse=publish /right": (
            "publish /right: pose.position.y 0.2 m → -0.2 m"
        ),
    }


def test_one_site_of_both_roles_has_mutants_of_both() -> None:
    publish = operation(Form.PUBLISH, "/arm/goal")
    places = [Place(Site(SPAN, "publish", 1, role), publish.target) for role in Role]
    hits = {place: [Hit({"pose.position.y": 0.2}, {})] for place in places}
    answers = {place: RecordedAnswers() for place in places}
    plan = make_plan(Baseline(hits=hits, answers=answers), project(Vocabulary((publish,))))
    assert {mutant.site.role for mutant in plan.mutants} == set(Role)
    assert len({mutant.id for mutant in plan.mutants}) == len(plan.mutants)
