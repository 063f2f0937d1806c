"""Campaigns for the tests of formats: with every kind of verdict, and with texts that mean harm."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mutabot
from mutabot.journal.records import Reaching
from mutabot.model import LeftOut
from mutabot.model.codec import to_data
from mutabot.report.format import Material, format_of
from mutabot.report.texts import portable
from mutabot.results.results import MutantResult
from results import samples

#: where the campaign of the samples says that it ran
ROOT = "/nowhere"
REACHING = Reaching(
    (samples.TEST, "tests/test_b.py::test_b"), {samples.MOVE.id: (0, 1), samples.OPEN.id: (1,)}
)
OPERATORS = {"skip": "A command is not carried out.", "noise": "Noise is added."}
#: what programs, tests and messages may hold, however unlikely
HOSTILE = (
    "\"double\" 'single' `back`",
    "a ]]> b <![CDATA[ c",
    "\x00\x01\x0b\x1f\x7f\x85 control \x1b[31mred\x1b[0m",
    "| a | b |",
    "</td></testcase><script>alert(1)</script><!-- ",
    "100% %0A %25 %2C",
    "line 1\nline 2\r\nline 3\rline 4",
    "::error file=x,line=1,title=y::gone :: wrong ::",
    "lone \ud800 and \udfff",
    "\ufffe\uffff\ufdd0",
    "*bold* _emphasis_ ~~gone~~ [link](http://x.example) ![image](y) $x^2$ #1 @me &amp; &lt;",
    "{0} {{1}} {name}",
    "# heading",
    "- item",
    "1. first",
    '=SUM(A1:A9), "quoted"; next\t',
    "größe → 箱 😀",
    "",
)


def stored(folder: Path, **changes: Any) -> mutabot.StoredCampaign:
    """The campaign of the samples, as it is read."""
    facts = {"operators": OPERATORS, "reaching": to_data(REACHING), **changes}
    return mutabot.open(samples.write_journal(folder / "journal.sqlite", **facts))


def made(name: str, campaign: mutabot.StoredCampaign, **options: Any) -> str:
    """A campaign in a format that is text."""
    text = format_of(name)(Material(portable(campaign), **options))
    assert isinstance(text, str)
    text.encode()  # a lone half of a pair could not be written
    return text


def with_text(campaign: mutabot.StoredCampaign, text: str) -> mutabot.StoredCampaign:
    """The same campaign with this text wherever a program, a test or a message can bring one."""
    return replace(
        campaign,
        mutants=tuple(_mutant(mutant, text) for mutant in campaign.mutants),
        left_out=tuple(LeftOut(omission.id, text, text) for omission in campaign.left_out),
        flaky=replace(campaign.flaky, tests=(text,)),
        sources={file: "\n".join([text] * 3 + ["    " + text] * 3) for file in campaign.sources},
        operators=dict.fromkeys(campaign.operators, text),
    )


def _mutant(result: MutantResult, text: str) -> MutantResult:
    site = replace(result.mutant.site, text=text)
    mutant = replace(result.mutant, description=text, site=site, variant=text)
    return replace(
        result,
        mutant=mutant,
        why=text,
        rounds=tuple(
            replace(
                end,
                mutant=mutant.id,
                test=f"tests/test_a.py::test[{text}]" if end.test is not None else None,
                message=text,
                exception=text,
                place=text,
                divergence=(text,),
                gaps=(text,),
                example=(text, [text]),
            )
            if end is not None
            else None
            for end in result.rounds
        ),
    )


def shown(texts: Iterable[str]) -> set[str]:
    """Texts as they are compared with what a reader sees: without differences of blanks."""
    return {" ".join(text.split()) for text in texts}
