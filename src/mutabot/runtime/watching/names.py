"""What one process sees of the names of a middleware: what is done under which, with which messages.

The hooks are those of a campaign (``runtime.targets.messages``). Nothing is changed.
"""

from __future__ import annotations

import inspect
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from mutabot.model import Role, Span
from mutabot.model.operation import MAIN, SETTING_UP, WRITTEN, Form
from mutabot.model.watched import Use, Values
from mutabot.runtime.interception.dispatcher import Aside, is_under_way
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import NOWHERE, Handler, Where

from .values import look

#: uses of one name whose messages are looked at; more are only counted
_MOST = 300
_LOOKED_AT = MAIN | {Form.FEEDBACK, Form.RESULT}


class NamesSeen(Messages):
    """All that the program and the tests do under names.

    Args:
        locator: tells whose file is whose.
        passed: told of each use: calls that are under way lead to it.
        pulse: called now and then, while nothing is held.
    """

    def __init__(
        self,
        locator: Locator,
        passed: Callable[[], None],
        pulse: Callable[[], None],
    ) -> None:
        self._locator, self._passed, self._pulse = locator, passed, pulse
        self.uses: dict[tuple[Form, str, bool, bool], Use] = {}
        self._lock = threading.RLock()
        super().__init__(lambda target, finding: None)

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """What looks at a use; None where something is set up, which is noted at once."""
        self._passed()
        if form in SETTING_UP and not is_under_way():
            self._use(form, name, self._locator.locate(sys._getframe(1)), False)
        if form not in _LOOKED_AT:
            return None

        def handle(
            wrapped: Callable[..., Any],
            instance: Any,
            args: tuple[Any, ...],
            kwargs: dict[str, Any],
            where: Where = NOWHERE,
        ) -> Any:
            if is_under_way():
                return wrapped(*args, **kwargs)
            code, locator = where.code, self._locator
            place = locator.locate(sys._getframe(1)) if code is None else locator.locate_definition(code)
            use = self._use(form, name, place, code is not None)
            if use is not None and args:
                self._look(use.written, args[0])
            if inspect.iscoroutinefunction(wrapped):
                return self._awaited(use, wrapped(*args, **kwargs))
            with Aside(None):  # only the outermost counts, as in a campaign
                result = wrapped(*args, **kwargs)
            self._answer(use, result)
            return result

        return handle

    def _use(
        self, form: Form, name: str, place: tuple[Span, Role] | None, is_called_back: bool
    ) -> Use | None:
        """The use that a place is one of, if its message is to be looked at."""
        if place is None:
            return None
        self._pulse()
        span, role = place
        with self._lock:
            key = (form, name, role is Role.ORACLE, is_called_back)
            use = self.uses.setdefault(key, Use(*key))
            where = f"{span.file}:{span.line}"
            use.sites[where] = use.sites.get(where, 0) + 1
            return use if sum(use.sites.values()) <= _MOST else None

    async def _awaited(self, use: Use | None, waiting: Any) -> Any:
        result = await waiting
        self._answer(use, result)
        return result

    def _answer(self, use: Use | None, result: Any) -> None:
        if use is not None and (use.form not in WRITTEN or use.form is Form.CALL):
            self._look(use.read, result)

    def _look(self, values: Values, value: Any) -> None:
        with self._lock, suppress(Exception):  # looking at values must not disturb the program
            look(values, value, message=True)
