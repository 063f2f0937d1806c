"""What ended a test: leaves of groups decide, checks and time-outs of every kind are told apart."""

from __future__ import annotations

import asyncio
import doctest
import importlib.util
import unittest
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any
from unittest.mock import Mock

import hypothesis
import numpy as np
import pytest
import pytest_timeout
from hypothesis import strategies

from mutabot.model import By, Vocabulary
from mutabot.model.events import TestEnd
from mutabot.runtime.activity import Activity
from mutabot.runtime.exceptions import KnownError, Refusal, is_due_to, leaves
from mutabot.runtime.interception.active_mutant import with_refusal
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.meter import TimeExceeded
from mutabot.runtime.test_end import classify


class Refused(Exception):  # noqa: N818  # as users name it
    pass


class Diverged(Exception):  # noqa: N818  # as users name it
    pass


VOCABULARY = Vocabulary(operations=(), failures=(f"{__name__}:Diverged",))


def ending(error: BaseException, *refusals: BaseException, root: Path = Path("/nowhere")) -> TestEnd:
    locator = Locator(str(root), ("mission.py",), ())
    noted: tuple[Refusal, ...] = ()
    for refusal in refusals:
        noted = with_refusal(noted, refusal)
    activity = Activity(refusals=noted)
    return classify(
        error, "tests/test_it.py::test_it", str(root / "tests" / "test_it.py"), locator, VOCABULARY, activity
    )


def raised(act: Callable[[], Any]) -> BaseException:
    with pytest.raises(BaseException) as caught:  # noqa: PT011  # whatever it is
        act()
    return caught.value


def group(*errors: BaseException) -> BaseExceptionGroup[BaseException]:
    return BaseExceptionGroup("several", errors)


def caused(error: BaseException, cause: BaseException) -> BaseException:
    error.__cause__ = cause
    return error


# --- groups ---------------------------------------------------------------------------------------------


def test_a_refusal_in_a_task_group_is_a_refusal() -> None:
    refusal = Refused("too far")

    async def move() -> None:
        raise refusal

    async def mission() -> None:
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(move())
            await asyncio.sleep(60)

    found = ending(raised(lambda: asyncio.run(mission())), refusal)
    assert found.refused == "too far"
    assert found.message == "too far"
    assert found.exception == f"{__name__}:Refused"


REFUSAL, OTHER = Refused("too far"), Refused("the other one")
REFUSED = {
    "deep in groups": group(group(group(REFUSAL))),
    "every leaf is one": group(REFUSAL, group(OTHER)),
    "a leaf is caused by it": group(REFUSAL, caused(ValueError("stopped"), REFUSAL)),
    "two leaves have one cause": group(*[caused(ValueError(), caused(KeyError(), REFUSAL))] * 2),
    "a group of it is the cause": caused(RuntimeError("mission failed"), group(REFUSAL, OTHER)),
    "a group is made of it": caused(group(ValueError("stopped"), KeyError("x")), REFUSAL),
}
NOT_REFUSED = {
    "a sibling failed by itself": group(REFUSAL, ValueError("no grip")),
    "a sibling's check failed": group(REFUSAL, AssertionError("no grip")),
    "one of a group of causes is another": caused(RuntimeError(), group(REFUSAL, ValueError())),
}


@pytest.mark.parametrize("error", REFUSED.values(), ids=REFUSED.keys())
def test_a_group_is_refused_if_all_of_it_is(error: BaseException) -> None:
    assert ending(error, REFUSAL, OTHER).refused == "the other one"


@pytest.mark.parametrize("error", NOT_REFUSED.values(), ids=NOT_REFUSED.keys())
def test_a_group_is_not_refused_if_something_else_is_in_it(error: BaseException) -> None:
    found = ending(error, REFUSAL, OTHER)
    assert found.refused is None
    assert found.exception != f"{__name__}:Refused"


def test_what_except_star_makes_of_a_refusal_is_one() -> None:
    def mission() -> None:
        try:
            raise group(REFUSAL, OTHER)
        except* Refused as found:
            raise RuntimeError("stopped") from found

    def split() -> None:
        try:
            raise group(REFUSAL, KeyError("handled"))
        except* KeyError:
            pass

    assert ending(raised(mission), REFUSAL, OTHER).refused is not None
    assert ending(raised(split), REFUSAL).refused == "too far"


def test_a_command_that_raises_a_group_of_refusals_is_refused() -> None:
    robot_s = group(REFUSAL, OTHER)
    assert ending(group(REFUSAL), robot_s).refused == "too far"  # the group itself was taken apart on its way


def test_a_refusal_handled_in_the_body_says_nothing_of_what_its_tasks_raise() -> None:
    refusal = Refused("too far")

    async def check() -> None:
        raise ValueError("no grip")

    async def mission() -> None:
        async with asyncio.TaskGroup() as tasks:
            try:
                raise refusal
            except Refused:
                tasks.create_task(check())
                await asyncio.sleep(60)

    found = ending(raised(lambda: asyncio.run(mission())), refusal)
    assert found.refused is None
    assert found.message == "no grip"


def test_a_group_made_while_a_refusal_is_handled_is_due_to_it() -> None:
    def mission() -> None:
        try:
            raise REFUSAL
        except Refused:
            raise ExceptionGroup("mission failed", [ValueError("stopped")])  # noqa: B904  # as users write it

    assert ending(raised(mission), REFUSAL).refused == "too far"


class MuteError(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no text")


def test_an_exception_that_fails_to_give_its_text_ends_a_test_by_its_name() -> None:
    assert ending(MuteError()).message == "MuteError"
    assert KnownError(error := MuteError()).matches(error)


def test_a_circle_of_causes_is_gone_round_once() -> None:
    error, other = ValueError(), ValueError()
    error.__cause__, other.__cause__ = other, error
    assert not is_due_to(error, [KnownError(REFUSAL)])
    assert ending(group(error, other), REFUSAL).refused is None


def test_a_failure_anywhere_in_a_group_wins() -> None:
    deep = group(AssertionError(), group(caused(ValueError(), group(Diverged("NaN")))))
    assert ending(deep).failure == "Diverged: NaN"
    assert ending(group(REFUSAL, MemoryError()), REFUSAL).failure == "the memory limit was reached"


def test_a_group_is_a_check_if_all_of_it_but_refusals_are() -> None:
    assert ending(group(AssertionError("x"), group(AssertionError("y")))).by is By.CHECK
    assert ending(group(REFUSAL, AssertionError("x")), REFUSAL).by is By.CHECK
    found = ending(group(AssertionError("x"), KeyError("y")))
    assert found.by is By.EXCEPTION
    assert found.exception == "builtins:KeyError"
    assert found.message == "'y'\n(one of 2 exceptions in a group)"


def test_a_limit_in_a_group_is_a_time_out() -> None:
    assert ending(group(KeyError(), TimeExceeded("more than 3 s of simulated time"))).timeout is not None


def test_leaves_are_in_order() -> None:
    errors = [ValueError(number) for number in range(4)]
    assert leaves(group(errors[0], group(errors[1], group(errors[2])), errors[3])) == errors


# --- checks ---------------------------------------------------------------------------------------------


def module(folder: Path, name: str, text: str) -> ModuleType:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(dedent(text), encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def raises_nothing() -> None:
    with pytest.raises(ValueError, match="x"):
        pass


CHECKS: dict[str, Callable[[], Any]] = {
    "assert": lambda: unittest.TestCase().fail("no"),
    "assertEqual": lambda: unittest.TestCase().assertEqual(1, 2),  # noqa: PT009  # that is the point
    "pytest.fail": lambda: pytest.fail("no"),
    "pytest.raises": raises_nothing,
    "numpy.testing": lambda: np.testing.assert_allclose([1.0], [2.0]),
}


@pytest.mark.parametrize("check", CHECKS.values(), ids=CHECKS.keys())
def test_every_kind_of_assertion_is_a_check(check: Callable[[], Any]) -> None:
    assert ending(raised(check)).by is By.CHECK


def test_hypothesis_reports_what_its_tests_report(tmp_path: Path) -> None:
    made = module(
        tmp_path,
        "tests/test_it.py",
        """
        from hypothesis import given, settings, strategies

        @settings(database=None, derandomize=True)
        @given(strategies.integers(0, 100))
        def asserts(n):
            assert n < 5

        @settings(database=None, derandomize=True)
        @given(strategies.integers(0, 100))
        def raises(n):
            [0][n]

        @settings(database=None, derandomize=True)
        @given(strategies.integers(0, 100))
        def both(n):
            assert n != 7
            assert n < 50
        """,
    )
    assert ending(raised(made.asserts), root=tmp_path).by is By.CHECK
    assert ending(raised(made.raises), root=tmp_path).by is By.EXCEPTION
    several = ending(raised(made.both), root=tmp_path)
    assert several.by is By.CHECK
    assert several.place in ("tests/test_it.py:17", "tests/test_it.py:18")


def test_an_assertion_of_the_program_is_no_check_even_below_those_of_libraries(tmp_path: Path) -> None:
    made = module(
        tmp_path,
        "mission.py",
        """
        import numpy

        def run():
            numpy.testing.assert_allclose([1.0], [2.0])
        """,
    )
    assert ending(raised(made.run), root=tmp_path).by is By.EXCEPTION


def doctested(text: str, **options: Any) -> BaseException:
    found = doctest.DocTestParser().get_doctest(dedent(text), {}, "it", "/nowhere/mission.py", 10)
    return raised(lambda: doctest.DebugRunner(**options).run(found))


def test_a_mismatch_of_a_doctest_is_a_check_and_says_what_differs() -> None:
    found = ending(doctested(">>> x = 1\n>>> x + 1\n3\n"))
    assert found.by is By.CHECK
    assert found.message == "x + 1: expected 3, got 2"
    assert found.place == "mission.py:12"


def test_what_an_example_raises_counts_as_if_it_stood_alone() -> None:
    assert ending(doctested(">>> assert 1 == 2\n")).by is By.CHECK
    found = ending(doctested(">>> [0][1]\n"))
    assert found.by is By.EXCEPTION
    assert found.exception == "builtins:IndexError"


def test_several_mismatches_of_one_doctest_are_a_check() -> None:
    from _pytest.doctest import MultipleDoctestFailures  # noqa: PLC0415  # pytest has no public name for it

    failures: Any = [doctested(">>> 1\n2\n"), doctested(">>> 3\n4\n")]
    assert ending(MultipleDoctestFailures(failures)).by is By.CHECK


# --- time-outs ------------------------------------------------------------------------------------------


def test_the_time_out_of_a_plugin_is_no_check() -> None:
    settings = pytest_timeout.Settings(0.5, "signal", False, True)

    found = ending(raised(lambda: pytest_timeout.timeout_sigalrm(Mock(), settings)))
    assert found.timeout == "Timeout (>0.5s) from pytest-timeout."


def test_an_example_that_takes_too_long_is_a_time_out() -> None:
    import time  # noqa: PLC0415  # nothing else here may depend on it

    @hypothesis.settings(database=None, deadline=1, max_examples=1)
    @hypothesis.given(strategies.just(0))
    def dawdles(_: int) -> None:
        time.sleep(0.01)

    assert ending(raised(dawdles)).timeout is not None
