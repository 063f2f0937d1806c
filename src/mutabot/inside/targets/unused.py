"""Names of the vocabulary under which nothing was done, and what was done instead."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from difflib import SequenceMatcher

from mutabot.extensions import brought
from mutabot.model.named import Form, Named, Refused

from .target import Finding

#: what did not happen under a name, for the forms that vocabularies speak of
_NOTHING = {
    Form.PUBLISH: "no test published {}",
    Form.RECEIVE: "no test received anything on {}",
    Form.CALL: "no test called the service {}",
    Form.GOAL: "no test sent a goal to {}",
    Form.PARAMETER: "no test read the parameter {}",
    Form.TICK: "no test was called back by a timer as {}",
    Form.SLEEP: "no test slept by a rate in {}",
    Form.TRANSFORM: "no test looked up the transform {}",
}
#: what is set up for a form: it tells of a name as well
_SET_UP = {
    Form.PUBLISH: Form.ADVERTISE,
    Form.RECEIVE: Form.SUBSCRIBE,
    Form.CALL: Form.CLIENT,
    Form.GOAL: Form.CLIENT,
    Form.TICK: Form.TIMER,
    Form.SLEEP: Form.RATE,
}
#: forms by which a process hears what is said under a name
_LISTENING = (Form.RECEIVE, Form.SUBSCRIBE, Form.GOAL, Form.CLIENT, Form.RESULT)
#: names that are told
_MOST = 4


def unused(wanted: Collection[Named], used: Collection[Named]) -> Iterator[tuple[str, Finding]]:
    """Each operation of the vocabulary that was never used, with what was used instead, nearest first."""
    for named in wanted:
        text = _NOTHING.get(named.form)
        if text is None or any(named.fits(one.form, one.name, one.node) for one in used):
            continue
        sentence = f"{text.format(named.name)}{_where(named)}; {_instead(named, used)}"
        yield named.target, Finding(named.form.value, sentence, is_remark=True)


def unheard(refused: Collection[Refused], used: Collection[Named]) -> Iterator[Finding]:
    """Names under which the vocabulary expects refusals, and nothing listens."""
    for name in dict.fromkeys(one.topic for one in refused if one.topic is not None):
        wanted = [Named(form, name) for form in _LISTENING]
        if any(one.fits(other.form, other.name, other.node) for one in wanted for other in used):
            continue
        instead = _instead(Named(Form.RECEIVE, name), used)
        sentence = f"no node listens to {name}, so that no refusal told there is seen; {instead}"
        yield Finding("refused", sentence, is_remark=True)


def _where(named: Named) -> str:
    return f" in a node {named.node}" if named.node is not None else ""


def _instead(named: Named, used: Collection[Named]) -> str:
    forms = (named.form, _SET_UP.get(named.form))
    alike = [one for one in used if one.form in forms]
    nodes = {one.node for one in alike if Named(one.form, named.name).fits(one.form, one.name, None)}
    told = sorted(node for node in nodes if node is not None)
    if told:
        is_set_up = any(named.fits(one.form, one.name, one.node) for one in _as(named.form, alike))
        return f"it is set up in {', '.join(told)}" if is_set_up else f"seen in {', '.join(told)}"
    names = sorted({one.name for one in alike}, key=lambda name: (-_likeness(name, named.name), name))
    if not names:
        known = f"; middlewares that are known here: {', '.join(brought('middlewares')) or 'none'}"
        return f"nothing of that kind was seen under any name{'' if used else known}"
    more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
    return f"seen: {', '.join(names[:_MOST])}{more}"


def _as(form: Form, alike: Collection[Named]) -> Iterator[Named]:
    return (Named(form, one.name, one.node) for one in alike if one.form is _SET_UP.get(form))


def _likeness(one: str, other: str) -> float:
    return SequenceMatcher(None, one, other).ratio()
