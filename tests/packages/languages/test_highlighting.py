"""What reports mark in programs: texts, comments and words of the language."""

from __future__ import annotations

import re

import pytest

from mutabot.languages.registry import highlighting_of

KINDS = ("text", "comment", "word")
CASES = {
    "a.mod": (
        'IF a THEN TPWrite "say ""IF""; ! no"; ! the END "x"\nendif',
        ["word IF", "word THEN", 'text "say ""IF""; ! no"', 'comment ! the END "x"', "word endif"],
    ),
    "a.src": (
        '&ACCESS RVP\nDEF a( ) ; loop\nPTP xp\nWAIT FOR $IN[1] ; "x"\nx[]="a;b"',
        [
            "comment &ACCESS RVP",
            "word DEF",
            "comment ; loop",
            "word PTP",
            "word WAIT",
            "word FOR",
            'comment ; "x"',
            'text "a;b"',
        ],
    ),
    "a.dat": ("DEFDAT a", ["word DEFDAT"]),
    "a.script": (
        'def p(): # end\n  textmsg("# if")\n  ending = True\nend',
        ["word def", "comment # end", 'text "# if"', "word True", "word end"],
    ),
    "a.py": (
        'def p(): # end\n  x = r\'#\' + """if\n"""',
        ["word def", "comment # end", "text r'#'", 'text """if\n"""'],
    ),
}


@pytest.mark.parametrize("file", CASES)
def test_words_texts_and_comments_are_marked(file: str) -> None:
    text, marked = CASES[file]
    pattern, flags = highlighting_of(file)
    # [^] is any character in ECMAScript
    found = re.finditer(
        pattern.replace("[^]", r"[\s\S]"), text, (re.I if "i" in flags else 0) | (re.M if "m" in flags else 0)
    )
    assert [f"{KINDS[(token.lastindex or 1) - 1]} {token[0]}" for token in found] == marked


@pytest.mark.parametrize("file", CASES)
def test_a_pattern_has_three_groups_and_nothing_that_ecmascript_has_not(file: str) -> None:
    pattern, _ = highlighting_of(file)
    assert re.compile(pattern.replace("[^]", ".")).groups == len(KINDS)
    assert "(?P" not in pattern
    assert "(?m" not in pattern


def test_files_of_no_language_have_nothing_marked() -> None:
    assert highlighting_of("a.txt") == ("", "")
