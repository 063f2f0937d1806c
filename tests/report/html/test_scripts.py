"""Scripts with data say what was put in, and nothing in them ends the script or its text."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mutabot.report.html.folder import script
from report.html.reports import EVIL
from report.material import HOSTILE

_TEXTS = st.text(st.characters(exclude_categories=["Cs"]))
_DATA = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**6), 10**6) | _TEXTS,
    lambda inside: st.lists(inside) | st.dictionaries(_TEXTS, inside),
    max_leaves=10,
)
_ESCAPE = re.compile(r"\\(?:x([0-9a-f]{2})|u([0-9a-f]{4})|(.))")


def said(name: str, data: Any) -> str:
    """The script as text."""
    return script(name, data).decode("utf-8")


def read(found: str) -> Any:
    """The data, as the language reads it."""
    (text,) = re.fullmatch(r"mutabot\.take\('n','(.*)'\);\n", found).groups()  # type: ignore[union-attr]
    assert not re.search(r"(?<!\\)(?:\\\\)*'", text)
    return json.loads(_ESCAPE.sub(lambda match: _character(*match.groups()), text))


def _character(byte: str | None, unit: str | None, sign: str | None) -> str:
    if byte or unit:
        return chr(int(byte or unit or "", 16))
    return {"n": "\n", "r": "\r"}.get(sign or "", sign or "")


@given(_DATA)
def test_data_come_out_as_they_went_in(data: Any) -> None:
    assert read(said("n", data)) == data


@pytest.mark.parametrize("text", [*HOSTILE, EVIL, "<!--", "]]>", "__proto__"])
def test_nothing_ends_the_script_or_its_line(text: str) -> None:
    found = said("n", {text: [text]})
    assert not re.search("[<>&\u2028\u2029\r]|\n.", found)
    kept = text.encode(errors="replace").decode()  # a half of a pair is no text
    assert read(found) == {kept: [kept]}


def test_numbers_that_are_none_are_null_and_others_are_short() -> None:
    assert read(said("n", [float("nan"), float("inf"), 0.1 + 0.2, 3.0, 1e-9])) == [
        None,
        None,
        0.3,
        3,
        1e-9,
    ]


@pytest.mark.parametrize(
    "number",
    [
        1_795_411_112.374_511_5, 1_795_411_112.0, -1_795_411_112.5, 1_795_411_112_374.5,
        1_795_411_112_374_511,
        12_345.678_912, 2.0**52 + 0.5, 2.0**53 - 1, 1.5e300, -(2**40),
    ],
)  # fmt: skip
def test_a_moment_a_number_of_a_device_and_whatever_else_is_large_keeps_all_its_digits(number: float) -> None:
    assert read(said("n", number)) == number
