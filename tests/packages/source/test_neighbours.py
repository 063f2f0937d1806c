"""What a call gets, another call of the same function could get as well."""

from __future__ import annotations

import ast

import pytest

from mutabot_source.neighbours import Neighbours


def neighbour(text: str, line: int = 1) -> str | None:
    """The neighbour of the first argument of the call in a line."""
    tree = ast.parse(text)
    call = next(node for node in ast.walk(tree) if isinstance(node, ast.Call) and node.lineno == line)
    (given,) = call.args or [keyword.value for keyword in call.keywords]
    found = Neighbours(tree).next_of(given.value if isinstance(given, ast.Starred) else given)
    return None if found is None else ast.unparse(found)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("move(HOME)\nmove(BIN)\n", "BIN"),
        ("move(HOME)\nmove(HOME)\nmove(BIN)\n", "BIN"),
        ("a.move(1)\nb.move(-2)\n", "-2"),
        ("move((1, 2))\nmove((3, 4))\n", "(3, 4)"),
        ("move(*HOME)\nmove(*BIN)\n", "BIN"),
        ("move(x=Pose.HOME)\nmove(x=Pose.BIN)\n", "Pose.BIN"),
    ],
)
def test_the_next_fixed_value_at_the_same_argument(text: str, found: str) -> None:
    assert neighbour(text) == found


def test_the_last_one_has_the_first() -> None:
    assert neighbour("move('a1')\nmove('b2')\nmove('c3')\n", line=3) == "'a1'"


@pytest.mark.parametrize(
    "text",
    [
        "move(HOME)\nturn(BIN)\n",
        "move(HOME)\nmove(bin)\n",
        "move(HOME)\nmove(*BIN)\n",
        "move(x=1)\nmove(y=2)\n",
        "move((1, 2))\nmove((3, 4, 5))\n",
        "move(POSES['a'])\nmove(POSES['b'])\n",  # its key has a neighbour of its own
        "move(True)\nmove(False)\n",
        "move(self.HOME.x)\nmove(self.BIN.x)\n",
        "fail('this is for people')\nfail('and this one too')\n",
        "ValueError('one')\nValueError('two')\n",
    ],
)
def test_none_where_it_could_not_stand(text: str) -> None:
    assert neighbour(text) is None
