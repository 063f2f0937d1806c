"""The providers of faults: those of the core, which act on calls and messages, and those of packages.

Operators at places make mutants; what cannot matter is left out, with the reason.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain
from random import Random
from typing import TYPE_CHECKING, Any, ClassVar

from mutabot.errors import ExtensionError, MutabotError, OperatorError, unknown_name_text
from mutabot.families import CALLS, CATALOGUE, GRADED, MESSAGES, MIDDLEWARE, OF_CALLS, ROBOT
from mutabot.faults import FaultProvider, Planned, PlannedMutant, Project, brought_providers
from mutabot.model import Call, Kind, Middleware, Mutant, Operation, ProgramText, Reply, Role, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.quantity import holds_number, is_number, is_reading_of
from mutabot.operators import Need, Operator, Subject, load_all
from mutabot.operators.middleware import CallRecord, rehearse
from mutabot.operators.operator import Rule, with_operation
from mutabot.operators.registry import names as operators_on_calls
from mutabot.operators.registry import operator as operator_named
from mutabot.original import Hit, NoAnswerError, Original, RecordedAnswers, idle_of

if TYPE_CHECKING:
    from mutabot.model.mutant import Place
    from mutabot.model.path import PathSteps, Step

#: why a speed or ratio is not reversed
NO_SIGN = (
    "no negative value of this speed or ratio was recorded, so it may have no direction; if it has one, "
    "give it an axis, or a range or clip that goes below 0"
)


def _has_negative(original: Original, place: Place, subject: Subject) -> bool:
    """Return whether any call of the same command has a negative value of the subject's quantity."""
    command = place.operation, place.pattern
    same = (hits for other, hits in original.hits.items() if (other.operation, other.pattern) == command)
    values = (_value(subject, hit) for hits in same for hit in hits)
    items = (item for value in values for item in (value if isinstance(value, list | tuple) else [value]))
    return any(is_number(item) and item < 0 for item in items)


_LOST_WRITE = (
    "the program writes to what the call returns, which is the robot's own memory: "
    "a mutant hands out a copy, and what is written to that is lost"
)
#: recorded calls per place that are tried out; calls of one place are much alike
TRIED = 200


class CallFaults(FaultProvider):
    """Operators on calls, which act where a call is intercepted (``mutabot/runtime/interception``)."""

    name = CALLS
    families: ClassVar[tuple[str, ...]] = (ROBOT, GRADED, CATALOGUE)
    location = "operation"
    needs_vocabulary = True
    in_program = True
    numbered_with = CALLS

    def rules(self) -> Sequence[Operator]:
        """Return all operators on calls but those of messages, also those that packages bring."""
        return [rule for rule in load_all() if rule.family != MIDDLEWARE]

    def plan(self, project: Project, original: Original) -> Planned:
        """Return the mutants of its operators at places that tests reach, and at calls that none reaches."""
        operators = [rule for rule in self.rules() if project.asks_for(rule)]
        found = list(_at_places(original, project.vocabulary, operators, self.name))
        found += _not_covered(original, project.vocabulary, operators, self.name)
        return Planned(found)

    def draws(self, operator: str) -> bool:
        """Return whether one of its operators draws new random numbers in each round."""
        return operator_named(operator).draws

    def is_raced(self, operator: str) -> bool:
        """Return whether equal runs with a fault of this operator may end differently."""
        return operator_named(operator).is_raced


class MessageFaults(CallFaults):
    """Operators on messages, requests and settings that go over a middleware."""

    name = MESSAGES
    families = (MIDDLEWARE,)

    def rules(self) -> Sequence[Operator]:
        """Return the operators on messages."""
        return [rule for rule in load_all() if rule.family == MIDDLEWARE]


def _at_places(
    original: Original, vocabulary: Vocabulary, operators: Sequence[Operator], provider: str
) -> Iterator[PlannedMutant]:
    """Yield the mutants of these operators at all places that the tests reach, left-out ones included."""
    taken: set[str] = set()
    operations_at = Counter(site for site, _ in {(place.site, place.operation) for place in original.hits})
    ranks = {rule.name: rank for rank, rule in enumerate(load_all())}
    for index, (place, hits) in enumerate(original.hits.items()):
        operation = vocabulary.operation(place.operation)
        if operation is None:
            continue
        operation = operation.by_numbers() if place in original.stand_ins else operation
        is_shared, active = operations_at[place.site] > 1, Activation.of_call(place)
        for subject, rule in _subjects(operators, operation, place):
            with _named(rule, operation):
                found, predicted = _predict(rule, subject, hits)
                seen = None if predicted is not None and found == (None, None) else found
                needs, only_reads = rule.needs_of(subject), rule.only_reads(subject)
                text = _description(rule, subject, place, seen, is_shared=is_shared)
            mutant = replace(_distinct(_mutant(rule, subject, place, provider), taken), description=text)
            unmet = {need: _why_unmet(need, subject, place, original, vocabulary) for need in needs}
            later = (unmet.get(need) for need in (Need.CLOCK, Need.WAIT, Need.SIGN))
            reasons = (unmet.get(Need.ERROR), unmet.get(Need.PLACE), predicted, *later)
            reason = next(filter(None, reasons), None)
            if reason is None and only_reads:
                reason = _why_unread(rule, subject, hits, original.read_parts.get(place))
            is_read_alone = subject.quantity in subject.read and subject.quantity not in subject.written
            if place in original.written_through and is_read_alone:
                reason = _LOST_WRITE
            if Need.IDLE in rule.needs and reason is None:
                try:
                    answers = _answers(original, place, of_any=Need.ERROR in rule.needs)
                    mutant = replace(mutant, idle=idle_of(operation, subject.pattern, answers))
                except NoAnswerError as error:  # a call of whose result nothing is read needs none
                    reason = None if original.read_parts.get(place) == frozenset() else str(error)
            yield PlannedMutant(mutant, reason, (0, index, ranks[rule.name]), active=active)


def _not_covered(
    original: Original, vocabulary: Vocabulary, operators: Sequence[Operator], provider: str
) -> list[PlannedMutant]:
    """Return the mutants of these operators at calls that no test reaches: all that the vocabulary allows.

    What only values could rule out stays: a test that reaches the call must not lower a score.
    """
    taken: set[str] = set()
    ranks = {rule.name: rank for rank, rule in enumerate(load_all())}
    found = []
    for index, place in enumerate(original.unreached, start=len(original.hits)):
        operation, active = vocabulary.operation(place.operation), Activation.of_call(place)
        for subject, rule in _subjects(operators, operation, place) if operation is not None else ():
            with _named(rule, subject.operation):
                needs = rule.needs_of(subject)
                text = _description(rule, subject, place, None, is_shared=False)
            unmet = (_why_unmet(need, subject, place, original, vocabulary) for need in needs)
            mutant = _distinct(_mutant(rule, subject, place, provider), taken)
            mutant, reason = replace(mutant, description=text), next(filter(None, unmet), None)
            found.append(PlannedMutant(mutant, reason, (0, index, ranks[rule.name]), active=active))
    return found


def _answers(original: Original, place: Place, *, of_any: bool) -> RecordedAnswers:
    """Return what calls of a place returned; if all of them raised, what the same command returned elsewhere.

    That is taken for what it answers here if it returned nothing wherever it returned; or, with ``of_any``,
    whatever it was.
    """
    own = original.answers[place]
    if own.first:
        return own
    others = [
        answers
        for other, answers in original.answers.items()
        if (other.operation, other.pattern) == (place.operation, place.pattern) and answers.first
    ]
    is_known = others and (of_any or all(other.is_nothing for other in others))
    return others[0] if is_known else own


def _subjects(
    operators: Iterable[Operator], operation: Operation, place: Place
) -> Iterator[tuple[Subject, Operator]]:
    pattern = operation.pattern(place.pattern)
    for rule in operators:
        if place.site.role is Role.ORACLE and Need.PROGRAM in rule.needs:
            continue
        with _named(rule, operation):
            subjects = list(rule.subjects(Subject(operation, pattern)))
        for subject in subjects:
            yield subject, rule


@contextmanager
def _named(rule: Operator, operation: Operation) -> Iterator[None]:
    """Name the operator in an error that its code raises."""
    try:
        yield
    except MutabotError:
        raise
    except Exception as error:
        raise OperatorError(f"operator {rule.name!r} fails on {operation.target}: {error!r}") from error


def _mutant(rule: Operator, subject: Subject, place: Place, provider: str) -> Mutant:
    return Mutant(
        number=0,
        family=rule.family,
        operator=rule.name,
        site=place.site,
        operation=place.operation,
        pattern=place.pattern,
        quantity=subject.quantity.name if subject.quantity is not None else None,
        variant=subject.variant,
        description="",
        magnitude=subject.magnitude,
        unit=subject.unit,
        direction=subject.direction,
        has_sizes=rule.has_sizes,
        provider=provider,
        by_number=subject.quantity is not None and subject.quantity.by_number,
    )


def _distinct(mutant: Mutant, taken: set[str]) -> Mutant:
    """Return the mutant with an unused id: operations at one site may have quantities of the same name.

    So may one operation whose site nodes of the program share with those of the oracle.
    """
    if mutant.id in taken:
        mutant = replace(mutant, variant=with_operation(mutant.variant, mutant.operation))
    taken.add(mutant.id)
    return mutant


#: a recorded value of the subject, and what it would become; None where that is unknown beforehand
_Predicted = tuple[Any, Any]


def _predict(rule: Operator, subject: Subject, hits: list[Hit]) -> tuple[_Predicted, str | None]:
    """Return what the mutant would do to the recorded calls, and why it is left out, if it is."""
    least, most = rule.least_calls(subject), max(Counter(hit.where for hit in hits).values(), default=0)
    if most < least:
        return (None, None), f"takes {least} calls in a test, and no test makes more than {most}"
    if rule.is_chance(subject):
        return (_value(subject, hits[0]), None), None
    last: _Predicted = (None, None)
    away = ""
    for hit, passage in _rehearsals(rule, subject, hits):
        before = _value(subject, hit)
        if passage is None:
            return (before, None), None
        if passage.acted:
            return (before, _changed(subject, passage)), None
        away = away or passage.away
        last = (before, before) if last[0] is None else last
    if away and (subject.quantity is None or subject.quantity.kind is Kind.SETTING):
        return last, f"would change nothing in {_calls(len(hits))}: {away}"
    return last, _reason(subject, last[0], len(hits))


def _why_unmet(
    need: Need, subject: Subject, place: Place, original: Original, vocabulary: Vocabulary
) -> str | None:
    """Return why a need of an operator is not met; None if it is."""
    match need:
        case Need.ERROR if not _has_raised(original, place):
            return "no call raises in the baseline"
        case Need.PLACE if not _has_reading(subject, vocabulary):
            return f"{subject.current or 'no reading'} does not give its position"
        case Need.CLOCK if vocabulary.clock is None:
            return "the vocabulary names no clock"
        case Need.WAIT if vocabulary.wait is None and subject.operation.named is None:
            return "the vocabulary does not say what lets the program's time pass (wait = …)"
        case Need.SIGN if not _has_negative(original, place, subject):
            return NO_SIGN
    return None


def _has_raised(original: Original, place: Place) -> bool:
    """Return whether a call at a place raised; at an unreached one, whether any call of the command did."""
    if place in original.answers:
        return original.answers[place].has_raised
    command = place.operation, place.pattern
    of_command = (
        answers for call, answers in original.answers.items() if (call.operation, call.pattern) == command
    )
    return any(answers.has_raised for answers in of_command)


def _has_reading(subject: Subject, vocabulary: Vocabulary) -> bool:
    """Return whether the vocabulary names a reading of the current value of the subject's quantity."""
    reading = vocabulary.operation(subject.current or "")
    if reading is None or subject.quantity is None:
        return False
    return any(is_reading_of(part, subject.quantity) for part in reading.readings)


def _why_unread(
    rule: Operator, subject: Subject, hits: list[Hit], parts: frozenset[PathSteps] | None
) -> str | None:
    """Return why a mutant changes nothing that is read of results, of which these parts are; None if it may.

    What is read must be described itself: anything else, such as a property, may depend on what is changed.
    """
    if not parts:
        return None if parts is None else "the result of the call is not used"
    names = {name for hit in hits for name in hit.read}
    described = [quantity.path.steps for quantity in subject.read if quantity.name in names]
    is_clear = not any(map(_is_relative, chain(*described)))
    if not is_clear or not all(any(_are_nested(part, other) for other in described) for part in parts):
        return None
    are_read = [part for part in subject.read if any(_are_nested(part.path.steps, own) for own in parts)]
    if subject.quantity in are_read:
        return None
    for hit, passage in _rehearsals(rule, subject, hits):  # one operator may change several parts
        if passage is None or passage.received is None:
            return None
        before, after = hit.read, passage.received.values
        if not all(part.is_same(after.get(part.name), before.get(part.name)) for part in are_read):
            return None
    shown = sorted("".join(map(str, part)) for part in parts)
    return f"only these parts of the result are read: {', '.join(shown)}"


def _are_nested(first: PathSteps, second: PathSteps) -> bool:
    """Return whether one of two parts of a result lies in the other, or is it."""
    return all(one == other for one, other in zip(first, second, strict=False))


def _is_relative(step: Step) -> bool:
    """Return whether a step may lead to the same part as another one: a slice, or an index from the end."""
    return step.bounds is not None or (isinstance(step.item, int) and step.item < 0)


def _rehearsals(rule: Operator, subject: Subject, hits: list[Hit]) -> Iterator[tuple[Hit, CallRecord | None]]:
    """Yield recorded calls with what the mutant makes of them; at last None where only a run shows it."""
    middleware, where = rule.middleware(subject, Random(1)), None
    for hit in hits[:TRIED]:
        if Need.MEMORY not in rule.needs or hit.where != where:
            where, middleware = hit.where, rule.middleware(subject, Random(1))
        try:
            yield hit, _rehearsal(rule, subject, hit, middleware)
        except LookupError:  # it asks where the robot is
            yield hit, None
            return


def _rehearsal(rule: Operator, subject: Subject, hit: Hit, middleware: Middleware) -> CallRecord:
    payload = object() if Need.MEMORY in rule.needs else None  # no two messages need be the same
    call = Call(subject.operation, subject.pattern, hit.written, idle=Reply(), payload=payload)
    passage = rehearse(middleware, call, hit.read, payload=payload, operator=rule.name)
    _check_promises(rule, subject, passage)
    return passage


def _check_promises(rule: Operator, subject: Subject, passage: CallRecord) -> None:
    broken = None
    if rule.does_nothing and passage.performed:
        broken = "declares does_nothing, but makes the call"
    elif Need.IDLE not in rule.needs and not passage.performed and passage.received is passage.call.idle:
        broken = "answers with call.idle, but Need.IDLE is none of its needs"
    if broken is not None:
        raise OperatorError(f"operator {rule.name!r} {broken} (on {subject.operation.target})")


def _value(subject: Subject, hit: Hit) -> Any:
    if subject.quantity is None:
        return None
    return {**hit.read, **hit.written}.get(subject.quantity.name)


def _changed(subject: Subject, passage: CallRecord) -> Any:
    name = subject.quantity.name if subject.quantity is not None else ""
    if passage.changed_reading and passage.received is not None:
        return passage.received.values.get(name)
    return passage.performed[0].values.get(name) if passage.performed else None


def _reason(subject: Subject, value: Any, hits: int) -> str:
    calls, quantity = _calls(hits), subject.quantity
    if quantity is None:
        return f"would change nothing in {calls}"
    if value is None and hits == 1:
        return subject.why_missing
    if value is None:
        return f"none of the {hits} calls {'passes' if subject.is_written else 'returns'} such a plain value"
    if quantity.is_numeric and not holds_number(value):
        return f"{quantity.name} of {subject.operation.name} is not a number: name a number in it by its path"
    within = " within the values that the vocabulary allows" if quantity.range or quantity.values else ""
    return f"would change nothing in {calls}{within} (value {quantity.text(value)})"


def _calls(hits: int) -> str:
    return "the call" if hits == 1 else f"any of {hits} calls"


def _description(
    rule: Operator, subject: Subject, place: Place, seen: _Predicted | None, *, is_shared: bool
) -> str:
    """Return what the mutant does, in one line.

    Args:
        seen: None where no value was seen, such as for a call that no test reaches.
        is_shared: whether the site reaches several operations.
    """
    operation, text = subject.operation, place.site.text
    if operation.named is not None:  # what is done on a middleware, and who hears it
        is_callback = text == "lambda" or text.startswith("def ")
        what = f"{text}, {operation.target}" if is_callback else operation.target
    else:
        what = text if _names(text, operation.name, is_shared=is_shared) else f"{text} ({operation.name})"
    if subject.pattern is not None:
        name = subject.pattern.name
        what = f"{what}({name if subject.pattern.notation is None else repr(name)})"
    if seen is None and subject.quantity is not None and not rule.has_sizes:
        return f"{what}: {rule.name} of {subject.quantity.label}"
    return f"{what}: {rule.describe(subject, *(seen or (None, None)))}"


def _names(text: str, name: str, *, is_shared: bool) -> bool:
    """Return whether the text of a call shows the operation, as a call by variable or wrapper may not."""
    name = name if is_shared else name.rpartition(".")[2]
    before = r"(?<![\w.])" if is_shared else r"\b"
    return re.search(f"{before}{re.escape(name)}$", text) is not None


_OWN: tuple[FaultProvider, ...] = (CallFaults(), MessageFaults())


def all_providers() -> tuple[FaultProvider, ...]:
    """Return every provider, in the order of their mutants' numbers."""
    return (*_OWN, *brought_providers())


def selected_providers(project: Project) -> list[FaultProvider]:
    """Return the providers whose mutants are selected; packages are searched only if they may have some."""
    of_calls = {demand.operator for demand in project.demands} <= set(operators_on_calls())
    known = _OWN if of_calls and set(project.families) <= set(OF_CALLS) else all_providers()
    return [provider for provider in known if provider.is_asked_for(project)]


def texts_of(project: Project, notify: Callable[[str], None]) -> dict[str, tuple[ProgramText, ...]]:
    """Return the program text that the baseline has to instrument, by the names of its providers."""
    found: dict[str, tuple[ProgramText, ...]] = {}
    first = 1
    for provider in selected_providers(project):
        texts = tuple(provider.texts(project, first, notify))
        if texts:
            found[provider.name] = texts
        first += sum(len(text.places) for text in texts)
    return found


def provider(name: str) -> FaultProvider:
    """Return the provider of this name. Raises ExtensionError if there is none."""
    own = next((found for found in _OWN if found.name == name), None)
    if own is not None:
        return own
    known = {found.name: found for found in all_providers()}
    if name in known:
        return known[name]
    raise ExtensionError(unknown_name_text("provider of faults", name, known))


def family_of(mutant: str) -> str:
    """Return the family of the mutant with this id; that of calls if its operator no longer exists."""
    operator = mutant.rpartition(":")[2].partition("=")[0].partition("@")[0]
    if operator in operators_on_calls():
        return operator_named(operator).family
    return operators_of_packages().get(operator, ROBOT)


def rules_of(families: Collection[str]) -> list[Rule]:
    """Return the operators of the providers of these families; of other packages nothing is loaded."""
    known = _OWN if set(families) <= set(OF_CALLS) else all_providers()
    wanted = (found for found in known if found in _OWN or not set(found.families).isdisjoint(families))
    return [rule for found in wanted for rule in found.rules()]


def operators_of_packages() -> dict[str, str]:
    """Return the operators of the packages' providers, with their families. Slow: it loads the packages."""
    return {rule.name: rule.family for package in brought_providers() for rule in package.rules()}
