"""Signatures that a vocabulary gives."""

from __future__ import annotations

import pytest

from mutabot.model.signature import parse_signature, takes_anything


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("()", "()"),
        ("(x)", "(x)"),
        ("(self, x)", "(x)"),
        ("( x , y = 0.5 )", "(x, y=0.5)"),
        ("(x: float, *, y: Point = None) -> bool", "(x, *, y=None)"),
        ("(x, /, y, *z, **more)", "(x, /, y, *z, **more)"),
        ("(body, joints, …)", "(body, joints, *args, **kwargs)"),
        ("(body, joints, ...)", "(body, joints, *args, **kwargs)"),
        ("(body, …, )", "(body, *args, **kwargs)"),
        ("(…)", "(*args, **kwargs)"),
        ("(x, *, y, …)", "(x, *, y, **kwargs)"),
        ("(x, *rest, …)", "(x, *rest, **kwargs)"),
        ("(x, y=…)", "(x, y=Ellipsis)"),
        ("(x, y=[1, -2])", "(x, y=[1, -2])"),
    ],
)
def test_a_signature_is_read(text: str, expected: str) -> None:
    assert str(parse_signature(text)) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "bracket"),
        ("x, y", "bracket"),
        ("move(x)", "bracket"),
        ("(x", "is not a signature"),
        ("(x y)", "is not a signature"),
        ("(x=0, y)", "is not a signature"),
        ("(x, x)", "duplicate parameter name: 'x'"),
        ("(x, *, x)", "duplicate parameter name: 'x'"),
        ("(x=speed())", "default of 'x', speed()"),
        ("(x): import os", "is not a signature"),
        ("(x): pass\nimport os\ndef f()", "is not a signature"),
        ("(…, x)", "is not a signature"),
        ("(x\0)", "is not a signature"),
    ],
)
def test_what_is_no_signature_is_refused_with_the_reason(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        parse_signature(text)
    assert words in str(caught.value)


def test_a_signature_of_nothing_but_the_rest_takes_anything() -> None:
    assert takes_anything(parse_signature("(…)"))
    assert not takes_anything(parse_signature("(x, *rest)"))
