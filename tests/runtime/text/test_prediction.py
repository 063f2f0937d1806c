"""What can be known of an expression without letting anything happen."""

from __future__ import annotations

import ast
import math
import sys
import weakref
from dataclasses import dataclass
from datetime import timedelta
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.runtime.program_text.prediction import Forms, PredictedForm, UnpredictableError, is_identical


def predict(text: str, **variables: Any) -> Any:
    """The value of a text in a frame where these are the globals."""
    return form(text).value(frame_of(**variables))


def form(text: str) -> PredictedForm:
    return PredictedForm(ast.parse(text, mode="eval").body)


def frame_of(**variables: Any) -> Any:
    space = {**variables, "sys": sys}
    exec("frame = sys._getframe(0)", space)
    return space["frame"]


numbers = st.one_of(st.integers(-9, 9), st.floats(-9, 9), st.booleans())
of_numpy = st.one_of(
    st.floats(-9, 9).map(numpy.float64), st.floats(-9, 9, width=32).map(numpy.float32),
    st.integers(-9, 9).map(numpy.int64), st.booleans().map(numpy.bool_),
)  # fmt: skip
values = numbers | of_numpy
names = st.sampled_from(["x", "y", "z"])
leaves = st.one_of(names, numbers.map(repr))


def nested(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    two = st.tuples(inner, inner)
    signs = ["+", "-", "*", "/", "//", "%", "**", "<", "<=", "==", "!=", ">", ">=", "and", "or", "is", "in"]
    return st.one_of(
        st.tuples(two, st.sampled_from(signs)).map(lambda it: f"({it[0][0]} {it[1]} {it[0][1]})"),
        inner.map(lambda it: f"(-{it})"),
        inner.map(lambda it: f"(not {it})"),
        inner.map(lambda it: f"abs({it})"),
        two.map(lambda it: f"max({it[0]}, {it[1]})"),
        st.tuples(inner, inner, inner).map(lambda it: f"({it[0]} if {it[1]} else {it[2]})"),
    )


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of numpy, when it really calculates
@given(st.recursive(leaves, nested, max_leaves=8), st.tuples(values, values, values))
def test_what_is_predicted_is_what_an_evaluation_gives(text: str, values: tuple[Any, ...]) -> None:
    variables = dict(zip("xyz", values, strict=True))
    try:
        found = predict(text, **variables)
    except UnpredictableError:
        return
    except Exception as error:
        with pytest.raises(type(error)):
            eval(text, variables)
        return
    expected = eval(text, variables)
    assert is_identical(found, expected) or (math.isnan(found) and math.isnan(expected))


@pytest.mark.filterwarnings("error")
def test_looking_ahead_lets_numpy_warn_nobody() -> None:
    assert math.isinf(predict("x / y", x=numpy.float64(1), y=numpy.float64(0)))
    assert math.isnan(predict("x - y", x=numpy.float64(math.inf), y=math.inf))


class Stored(NamedTuple):
    x: float


@dataclass(frozen=True, slots=True)
class Slots:
    x: float


@dataclass
class Plain:
    x: float
    common = 7


@pytest.mark.parametrize("owner", [Stored(2.0), Slots(2.0), Plain(2.0)])
def test_stored_attributes_are_known(owner: Any) -> None:
    assert predict("owner.x + 1", owner=owner) == 3.0


def test_names_of_modules_and_classes_are_known() -> None:
    assert predict("math.pi", math=math) is math.pi
    assert predict("math.hypot(3, 4)", math=math) == 5.0
    assert predict("math.dist((0, x), (4, 0)) <= 5", math=math, x=3) is True
    assert predict("owner.common", owner=Plain(1.0)) == 7
    assert predict("table['a'][1]", table={"a": [1, 2]}) == 2


class Robot:
    """Every way to ask it anything is noted."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    @property
    def angle(self) -> float:
        self.asked.append("angle")
        return 1.0

    @property  # type: ignore[misc]
    def __class__(self) -> type:
        self.asked.append("__class__")
        return Robot

    def __getattr__(self, name: str) -> float:
        self.asked.append(name)
        return 1.0

    def __getitem__(self, key: object) -> float:
        self.asked.append(str(key))
        return 1.0

    def __add__(self, other: object) -> float:
        self.asked.append("+")
        return 1.0

    def __eq__(self, other: object) -> bool:
        self.asked.append("==")
        return True

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        self.asked.append("bool")
        return True

    def __abs__(self) -> float:
        self.asked.append("abs")
        return 1.0

    def __call__(self) -> float:
        self.asked.append("()")
        return 1.0

    def __iter__(self) -> Any:
        self.asked.append("iter")
        return iter(())


@pytest.mark.parametrize(
    "text",
    [
        "robot.angle",
        "robot.missing",
        "robot[0]",
        "robot + 1",
        "robot == 1",
        "1 == robot",
        "1 in robot",
        "1 in [robot]",
        "1 in table",
        "robot",
        "robot is None",
        "not robot",
        "robot and 1",
        "1 if robot else 2",
        "abs(robot)",
        "max(robot, robot)",
        "robot.angle()",
        "robot()",
        "print('x')",
        "[x for x in robot]",
        "(y := 1)",
        "f'{robot}'",
        "lambda: robot",
        "max(1, 2, key=robot)",
    ],
)
def test_whatever_may_ask_the_robot_is_left_to_a_real_evaluation(text: str) -> None:
    robot = Robot()
    with pytest.raises(UnpredictableError):
        predict(text, robot=robot, table=[robot])
    assert robot.asked == []


def test_what_templates_call_is_known() -> None:
    assert predict("-__mutabot__[0].absolute(x)", x=-2) == -2
    assert predict("__mutabot__[0].fail_if(x, 0, 'Name', 'text')", x=1) == 1
    with pytest.raises(ZeroDivisionError):
        predict("__mutabot__[0].fail_if(x, 0, 'Name', 'text')", x=0)
    with pytest.raises(UnpredictableError):
        predict("__mutabot__[0].fail('Name', 'text')")


def test_a_function_of_the_program_is_not_called_whatever_its_name() -> None:
    with pytest.raises(UnpredictableError):
        predict("abs(1)", abs=lambda value: pytest.fail("it was called"))


@pytest.mark.parametrize(
    "text",
    ["9 ** 9 ** 9", "1 << 10 ** 9", "'x' * 9999999", "'%9999999d' % 1", "big * big", "~True", "word[9]"],
)
def test_what_would_take_long_or_warn_or_raise_is_not_predicted(text: str) -> None:
    with pytest.raises((UnpredictableError, IndexError)):
        predict(text, big=1 << 300, word="text")


@pytest.mark.parametrize("text", ["(1, 2)", "max((0, 1), (0, 2))", "(1, 2) == (1, 2)", "abs([1, 2])"])
def test_tuples_are_arguments_alone(text: str) -> None:
    with pytest.raises(UnpredictableError):
        predict(text)


def test_a_variable_without_a_value_yet_is_no_global_of_that_name() -> None:
    """An evaluation would raise UnboundLocalError there."""
    program = """
def before():
    frame = sys._getframe(0)
    return frame
    x = 1

def after():
    x = "local"
    return sys._getframe(0)

def elsewhere():
    return sys._getframe(0)
"""
    space: dict[str, Any] = {"sys": sys, "x": "global"}
    exec(program, space)
    x = form("x")
    assert x.value(space["elsewhere"]()) == "global"
    assert x.value(space["after"]()) == "local"
    with pytest.raises(UnpredictableError):
        x.value(space["before"]())


def test_what_a_function_keeps_of_its_local_names_is_not_brought_up_to_date() -> None:
    x = 1
    kept = locals()
    x = 2
    with pytest.raises(UnpredictableError):
        form("x").value(sys._getframe(0))
    assert kept["x"] == 1
    assert x == 2


def test_an_object_ends_with_its_name_after_the_local_names_were_looked_at() -> None:
    program = """
def run(thing):
    x, end = 1, weakref.ref(thing := Plain(1.0))
    value = look(sys._getframe(0))
    del thing
    return value, end() is None, x
"""
    space = {"sys": sys, "weakref": weakref, "Plain": Plain, "look": form("x").value}
    exec(program, space)
    run: Any = space["run"]
    assert run(None) == (1, True, 1)


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        (1, 1, True),
        (1, 1.0, False),
        (1, True, False),
        (0.0, -0.0, False),
        (math.nan, math.nan, True),
        (math.nan, -math.nan, False),
        (float("nan"), float("nan"), True),
        (0j, -0j, False),
        (2j, 1j + 1j, True),
        (numpy.float64(1.5), numpy.float64(1.5), True),
        (numpy.float64(0.0), numpy.float64(-0.0), False),
        (numpy.float64(1.0), 1.0, False),
        (numpy.float64(1.0), numpy.float32(1.0), False),
        (timedelta(days=1), timedelta(hours=24), True),
        (Decimal("1.0"), Decimal("1.00"), False),
        (Fraction(1, 2), Fraction(2, 4), True),
        ([], [], False),
        ((1, 2), (1.0, 2.0), False),
        (numpy.zeros(2), numpy.zeros(2), False),
        (None, None, True),
        ("a", "a", True),
    ],
)
def test_values_are_identical_only_if_no_program_can_distinguish_them(
    first: Any, second: Any, same: bool
) -> None:
    assert is_identical(first, second) is same


def test_only_alternatives_with_another_value_differ() -> None:
    texts = ("abs(x)", "-x", "x / 0", "robot.angle", "x", "robot[0:1]")
    trees = [ast.parse(text, mode="eval").body for text in texts]
    forms, everything = Forms(form("x"), tuple(map(PredictedForm, trees))), frozenset(range(6))
    assert forms.differing(everything, frame_of(x=2, robot=Robot())) == {1, 2, 3, 5}
    assert forms.differing(frozenset({0, 1}), frame_of(robot=Robot())) == {0, 1}
    assert Forms(form("robot.f()"), forms.alternatives).differing(everything, frame_of(x=2)) == everything
