"""Faults in what goes under a name over ROS, as plain functions that edited copies call; without Mutabot.

The judge puts this file beside the copy as ``_planted_messages.py``. Each wrapper takes a callable of the
client library (``publisher.publish``, a service's proxy, ``wait_for_message``) and gives one that is called
in its place.
"""

from __future__ import annotations

import copy
import functools
import itertools
import os
import queue
import random
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from _planted import changed  # type: ignore[import-not-found]

Change = Callable[[Any], Any]
Wrapper = Callable[[Any], Any]
#: a node's clock, in s; none is that of the wall
Clock = Callable[[], float] | None

_RANDOM = random.Random(int(os.environ.get("JUDGE_NOISE", "1")))
#: where ``latch`` stands among the arguments of ``rospy.Publisher``
_LATCH = 4
#: which sites are being called now
_armed: list[str] = []
#: calls of the mutated site until now, what they were given or brought, and what is held back
_count = itertools.count(1)
_earlier: list[Any] = []
_held: list[Any] = []


@dataclass
class _Watch:
    """Whose answers come now: the mutated command's, until the program gives the next one of its kind.

    A mutated command may be sent several times. If only some of these were answered when the program gives
    the next command, the others are answered first.
    """

    is_on: bool = False
    is_past: bool = False
    sent: int = 0
    heard: int = 0

    def begin(self) -> None:
        """The mutated command is given."""
        if not self.is_on:
            self.sent = self.heard = 0
        self.is_on, self.is_past = True, False

    def pass_by(self) -> None:
        """Another command of its kind is given."""
        self.is_past = True
        self.is_on = self.is_on and 0 < self.heard < self.sent

    def hear(self) -> None:
        """An answer has come."""
        self.heard += 1
        self.is_on = self.is_on and not (self.is_past and self.heard >= self.sent)

    def counting(self, function: Any) -> Any:
        """``function`` that counts how often it is called; it belongs to what it belonged to."""

        @functools.wraps(function)
        def called(*given: Any, **named: Any) -> Any:
            self.sent += 1
            return function(*given, **named)

        if hasattr(function, "__self__"):
            called.__self__ = function.__self__  # type: ignore[attr-defined]
        return called


_watch = _Watch()


def armed(site: str, function: Any) -> Any:
    """``function``, below which the client library's call is the mutated one."""

    def called(*given: Any, **named: Any) -> Any:
        _armed.append(site)
        try:
            return function(*given, **named)
        finally:
            _armed.remove(site)

    return called


def only_below(site: str, function: Any, wrapper: Wrapper) -> Any:
    """``function`` as ``wrapper`` makes it if a call of the site is under way, else as it is.

    What is refused from now on is the mutated command, until the next one of the kind.
    """
    if site not in _armed:
        _watch.pass_by()
        return function
    _watch.begin()
    return wrapper(_watch.counting(function))


def hearing(callback: Any, is_refused: Callable[[Any], bool]) -> Any:
    """A callback that notes when a message says that the robot refuses the mutated command."""

    def called(message: Any) -> Any:
        if _watch.is_on and _watch.sent and is_refused(message):  # what was not sent is not refused
            with Path(os.environ["JUDGE_NOTES"]).open("a") as notes:
                notes.write("refused\n")
        _watch.hear()
        return callback(message)

    return called


# what is said


def with_message(change: Change) -> Wrapper:
    """The message or request that is given, changed."""
    return lambda function: lambda *given, **named: function(change(_message(function, given, named)))


def with_reply(change: Change) -> Wrapper:
    """The message or response that comes, changed; ``wait_for_message`` of ROS 2 gives a pair."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            reply = function(*given, **named)
            return (reply[0], change(reply[1])) if isinstance(reply, tuple) else change(reply)

        return called

    return wrapped


def field(path: str, change: Change) -> Change:
    """A message with one field changed; the other stays as it is."""
    return lambda message: changed(path, change, copy.deepcopy(message))


def stale(which: str) -> Change:
    """The first, or the previous message in the place of the new one."""

    def old(message: Any) -> Any:
        _earlier.append(copy.deepcopy(message))
        return message if len(_earlier) == 1 else copy.deepcopy(_earlier[0 if which == "first" else -2])

    return old


# whether it is said


def nothing(answer: Callable[[], Any]) -> Wrapper:
    """Not called; ``answer`` tells what the program hears."""
    return lambda function: lambda *given, **named: answer()


def lost(which: str, without: Wrapper) -> Wrapper:
    """Each, every third, or some of the calls as ``without`` makes them."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            return (without(function) if _is_meant(which) else function)(*given, **named)

        return called

    return wrapped


def unanswered(performed: bool) -> Wrapper:
    """A service whose answer is lost, with or without having been asked."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            if performed:
                function(*given, **named)
            if "rospy" in sys.modules:
                raise sys.modules["rospy"].ServiceException("planted: the answer is lost")
            return sys.modules["rclpy.task"].Future()

        return called

    return wrapped


def sent_late(seconds: float, clock: Clock) -> Wrapper:
    """Called so much later by a clock; the program goes on at once."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> None:
            kept = copy.deepcopy(given)

            def later() -> None:
                if _sleep(seconds, clock):
                    function(*kept, **named)

            threading.Thread(target=later, daemon=True).start()

        return called

    return wrapped


def asked_late(seconds: float, clock: Clock) -> Wrapper:
    """A service that is asked so much later; who waits for the answer waits longer."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            _sleep(seconds, clock)
            return function(*given, **named)

        def called_async(*given: Any, **named: Any) -> Any:
            answer = sys.modules["rclpy.task"].Future()

            def later() -> None:
                if _sleep(seconds, clock):
                    asked = function(*given, **named)
                    asked.add_done_callback(lambda done: answer.set_result(done.result()))

            threading.Thread(target=later, daemon=True).start()
            return answer

        return called_async if getattr(function, "__name__", "") == "call_async" else called

    return wrapped


def come_late(seconds: float, clock: Clock) -> Wrapper:
    """``wait_for_message`` that gets its message so much later, if it still waits then."""

    def wrapped(function: Any) -> Any:
        word = "timeout" if "rospy" in sys.modules else "time_to_wait"

        def called(*given: Any, **named: Any) -> Any:
            patience = named.pop(word) if word in named else given[2]
            given = given if word == "time_to_wait" else given[:2]
            began = time.monotonic()
            _sleep(seconds, clock, patience)
            return function(*given, **named, **{word: max(0.0, patience - (time.monotonic() - began))})

        return called

    return wrapped


def held_back() -> Wrapper:
    """Two by two, the second before the first."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> None:
            message = copy.deepcopy(_message(function, given, named))
            if not _held:
                _held.append(message)
                return
            function(message)
            function(_held.pop())

        return called

    return wrapped


# what comes


def coming(what: Callable[[Any], list[Any]]) -> Wrapper:
    """``wait_for_message`` that returns the first of what ``what`` makes of each message that comes."""

    def wrapped(function: Any) -> Any:
        wait = _wait_ros1 if "rospy" in sys.modules else _wait_ros2
        return lambda *given, **named: wait(what, *given, **named)

    return wrapped


def but_lost(which: str) -> Callable[[Any], list[Any]]:
    """Each, every third or some of the messages that come are lost."""
    return lambda message: [] if _is_meant(which) else [message]


def swapped(message: Any) -> list[Any]:
    """Messages that come change places, two by two."""
    if not _held:
        _held.append(message)
        return []
    return [message, _held.pop()]


def _wait_ros1(what: Any, topic: str, kind: type, timeout: float | None = None) -> Any:
    rospy: Any = sys.modules["rospy"]
    came: queue.Queue[Any] = queue.Queue()
    subscriber = rospy.Subscriber(topic, kind, came.put)
    try:
        for remaining in _countdown(timeout):
            try:
                comes = what(came.get(timeout=remaining))
            except queue.Empty:
                break
            if comes:
                return comes[0]
    finally:
        subscriber.unregister()
    raise rospy.ROSException("timeout exceeded while waiting for message on topic " + topic)


def _wait_ros2(
    what: Any, kind: type, node: Any, topic: str, *, qos_profile: Any = 1, time_to_wait: float = -1
) -> Any:
    rclpy: Any = sys.modules["rclpy"]
    came: list[Any] = []
    subscription = node.create_subscription(kind, topic, came.append, qos_profile)
    try:
        for _ in _countdown(None if time_to_wait < 0 else time_to_wait):
            rclpy.spin_once(node, timeout_sec=0.01)
            while came:
                comes = what(came.pop(0))
                if comes:
                    return True, comes[0]
    finally:
        node.destroy_subscription(subscription)
    return False, None


def _countdown(timeout: float | None) -> Iterator[float]:
    """What remains, until nothing does."""
    end = time.monotonic() + (1e6 if timeout is None else timeout)
    while (remaining := end - time.monotonic()) > 0:
        yield remaining


# callbacks


def callback(what: Callable[[Any], list[Any]]) -> Wrapper:
    """A decorator of a callback: called with each of what ``what`` makes of its last argument, a message."""

    def decorated(function: Any) -> Any:
        def called(*given: Any) -> Any:
            result = None
            for message in what(given[-1]):
                result = function(*given[:-1], message)
            return result

        return called

    return decorated


def given(wrapper: Wrapper) -> Wrapper:
    """A decorator of a callback: its last argument, a message, comes as ``wrapper`` changes a reply."""

    def decorated(function: Any) -> Any:
        @functools.wraps(function)
        def called(*given: Any) -> Any:
            return function(*given[:-1], wrapper(lambda: given[-1])())

        return called

    return decorated


# set up


def set_up(change: Callable[[list[Any], dict[str, Any]], None]) -> Wrapper:
    """With other settings; ``change`` is given the arguments to change them in place."""

    def wrapped(function: Any) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            arguments = list(given)
            change(arguments, named)
            return function(*arguments, **named)

        return called

    return wrapped


def misspelt(place: int, word: str) -> Wrapper:
    """With a name that nobody else has; it is the argument at this place, or of this word."""

    def change(given: list[Any], named: dict[str, Any]) -> None:
        where: Any = named if word in named else given
        key: Any = word if word in named else place
        where[key] += "_misspelt"

    return set_up(change)


def with_settings(**settings: Any) -> Wrapper:
    """With these by keyword."""
    return set_up(lambda given, named: named.update(settings))


def other_latch(function: Any) -> Any:
    """A publisher of ROS 1 that latches if it did not, and the other way round."""

    def change(given: list[Any], named: dict[str, Any]) -> None:
        if len(given) > _LATCH:
            given[_LATCH] = not given[_LATCH]
        else:
            named["latch"] = not named.get("latch", False)

    return set_up(change)(function)


def quality(**qualities: Any) -> Wrapper:
    """With these qualities of ROS 2."""
    return _with_qualities(lambda profile: qualities)


def other_quality(name: str, usual: str, otherwise: str) -> Wrapper:
    """With the other of two qualities of ROS 2."""

    def change(profile: Any) -> dict[str, Any]:
        now = getattr(profile, name)
        return {name: type(now)[otherwise if now.name == usual else usual]}

    return _with_qualities(change)


def with_deadline(seconds: float | None) -> Wrapper:
    """With a deadline of so many seconds, or without one."""
    duration: Any = sys.modules["rclpy.duration"]
    deadline = duration.Infinite if seconds is None else duration.Duration(seconds=seconds)
    return _with_qualities(lambda profile: {"deadline": deadline})


def done(answer: Any) -> Any:
    """What a service of ROS 2 gives that has answered already."""
    future = sys.modules["rclpy.task"].Future()
    future.set_result(answer)
    return future


def _with_qualities(change: Callable[[Any], dict[str, Any]]) -> Wrapper:
    kind = sys.modules["rclpy.qos"].QoSProfile

    def changed_in(given: list[Any], named: dict[str, Any]) -> None:
        where: Any = named if "qos_profile" in named else given
        key: Any = "qos_profile" if "qos_profile" in named else 3 if callable(given[2]) else 2
        profile = where[key] if isinstance(where[key], kind) else kind(depth=where[key])
        where[key] = copy.copy(profile)
        for name, value in change(profile).items():
            setattr(where[key], name, value)

    return set_up(changed_in)


# the process


def dies(anew: bool) -> Wrapper:
    """The process is killed in the place of the call, and begins anew if it shall, once."""

    def wrapped(function: Any) -> Any:
        if os.environ.get("JUDGE_BEGUN_ANEW") == str(os.getpid()):
            return function

        def called(*given: Any, **named: Any) -> Any:
            if anew:
                os.environ["JUDGE_BEGUN_ANEW"] = str(os.getpid())
                os.execv(sys.executable, sys.orig_argv)
            os.kill(os.getpid(), signal.SIGKILL)

        return called

    return wrapped


def _is_meant(which: str) -> bool:
    if which == "30%":
        return _RANDOM.random() < 0.3
    return not which or next(_count) % 3 == 0


def _message(function: Any, given: tuple[Any, ...], named: dict[str, Any]) -> Any:
    """The message or request: rospy makes it of its fields where it is not given as such."""
    owner = getattr(function, "__self__", function)
    kind = getattr(owner, "data_class", None) or getattr(owner, "request_class", None)
    if kind is None or (len(given) == 1 and not named and isinstance(given[0], kind)):
        return given[0] if given else next(iter(named.values()))
    return kind(*given, **named)


def _sleep(seconds: float, clock: Clock, patience: float = 1e6) -> bool:
    """Wait by a clock, or by the wall's where it stands still; whether patience lasts as long."""
    until, wall = time.monotonic() + patience, time.monotonic() + seconds
    told = clock or time.monotonic
    end = told() + seconds
    while told() < end and time.monotonic() < wall:
        if time.monotonic() > until:
            return False
        time.sleep(0.001)
    return True
