"""lost-handler: a handler is registered never, or twice."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from typing import ClassVar

from mutabot_source.extension import BUGS
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

from ._calls import call, last_name

_REGISTERING = re.compile(
    r"(^|_)(subscribe|register|connect|attach|bind|listen|hook|add_\w*(callback|listener|handler|observer|hook)|"
    r"on_\w+|create_(timer|subscription|service))(_\w+)?$",
    re.IGNORECASE,
)
_TAKING_OFF = re.compile(
    r"(^|_)(unsubscribe|unregister|disconnect|detach|unbind|(remove|destroy|cancel)_\w*"
    r"(callback|listener|handler|observer|hook|timer|subscription))(_\w+)?$",
    re.IGNORECASE,
)
#: these are also said of devices, sockets and tools: they register only what is named like a handler
_AMBIGUOUS = re.compile(
    r"(^|_)(dis)?(connect|attach|detach|(un)?bind|listen|hook|(un)?register)(_\w+)?$", re.IGNORECASE
)
_HANDLER = re.compile(
    r"^_?(on|handle|when)_|(^|_)(cb|callback|handler|listener|observer|slot|hook)s?$", re.IGNORECASE
)


class LostHandler(ConventionalOperator):
    """A handler is never registered, or twice; or one that is to go stays.

    Where: statements that are a call named like a registration or its end and give something; if devices and
    sockets have calls of that name, too, something that is named like a handler.

    Stands for: A callback that comes once more after its reader is done: 1 of 253 silent bugs of public robot
    programs exactly, 0 nearly.
    """

    name = "lost-handler"
    family = BUGS
    rank = 300
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample(
            "arm.subscribe(self.seen)\n", ("pass\n", "(arm.subscribe(self.seen), arm.subscribe(self.seen))\n")
        ),
        TextExample("arm.unsubscribe(self.seen)\n", ("pass\n",), note="twice would raise"),
        TextExample("arm.move(x)\n", note="no registration"),
        TextExample("arm.connect()\n", note="nothing is registered"),
        TextExample("arm.connect('10.0.0.2')\n", note="no handler is registered"),
        TextExample("bus.bind(self.address)\n", note="not named like a handler"),
        TextExample(
            "button.connect(lambda: go())\n",
            ("pass\n", "(button.connect(lambda: go()), button.connect(lambda: go()))\n"),
        ),
        TextExample("done = arm.subscribe(seen)\n", note="the program goes on with the answer"),
    )

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
            return
        found, name = node.value, last_name(node.value.func)
        given = [*found.args, *(keyword.value for keyword in found.keywords)]
        if not given or (_AMBIGUOUS.search(name) and not any(map(_is_handler, given))):
            return
        if _TAKING_OFF.search(name):
            yield Draft("never", ("pass",))
        elif _REGISTERING.search(name):
            again = call(found, found.keywords)
            yield Draft("never", ("pass",))
            yield Draft("twice", ("(", *again, ", ", *again, ")"))


def _is_handler(node: ast.expr) -> bool:
    return isinstance(node, ast.Lambda) or _HANDLER.search(last_name(node)) is not None
