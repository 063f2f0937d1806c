"""Reports for the tests: with every kind of verdict and recordings, and with texts that mean harm."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import mutabot
from mutabot.evidence.recording import (
    Block,
    RecordedCall,
    RecordedMoment,
    Recording,
    Track,
    TrackKind,
    to_bytes,
)
from mutabot.journal.recordings import ORIGINAL, Rank, Recordings
from mutabot.model.world_difference import Apart, Diverged
from mutabot.report.html.folder import Contents, Written, write_folder
from mutabot.report.texts import Cleaner, portable
from mutabot.results.stored import StoredEvidence
from report.material import with_text
from results import samples

#: what a source file, a message or a name may hold to harm whoever opens the report
EVIL = (
    "</script><script>window.pwned = 1</script><img src=x onerror='window.pwned = 2'>"
    '"><svg onload=window.pwned=3> \u2028\u2029 \u202egnp.exe\u202c \u2066x\u2069 \x1b[31mred\x1b[0m '
    "');window.pwned=4;(' \\';window.pwned=5;// {{7*7}} __proto__ &lt;b&gt; \x00"
)
#: seconds, and moments
_TIMES = [0.1 * number for number in range(100)]


def recording(*, off: float = 0.0, name: str = "box", has_arm: bool = False) -> Recording:
    """A tool that goes along a curve and a box; from 5 s on both are ``off`` m beside it."""
    tool, box, arm = array("f"), array("f"), array("f")
    for time in _TIMES:
        y = 0.02 * time * time * 0.1 + (off if time >= 5 else 0.0)
        tool.extend((0.1 * time, y, 0.5, 1.0, 0.0, 0.0, 0.0))
        box.extend((0.1 * time, y, 0.4))
        arm.extend((0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.1 * time, y, 0.5))
    calls = [
        RecordedCall(0.0, 2.0, "robot:Arm.move_by", "mission.py:3", "by {dx:g}", {"dx": 0.2}, {}),
        RecordedCall(
            2.0, 9.0, "robot:Arm.move_by", "mission.py:4", None, {"dx": -0.3, "how": "slowly " * 9}, {}
        ),
        RecordedCall(
            9.5, 9.5, "tracker:box_position", "tests/sensors.py:2", None, {}, {".x": 0.5 + off}, "oracle"
        ),
    ]
    moments = [RecordedMoment(1.0, "touch", f"{name}, table")]
    if not off:  # the mutant has nothing beside it
        moments.append(RecordedMoment(8.0, "part", f"{name}, table"))
    return Recording(
        array("d", _TIMES),
        {
            "tool": Track("tool", TrackKind.POSE, tool),
            name: Track(name, TrackKind.POINT, box, size=(0.1, 0.1, 0.1)),
            **({"arm": Track("arm", TrackKind.LINE, arm, radii=(0.05, 0.05, 0.05))} if has_arm else {}),
        },
        (Block(name, (0.5, 0.0, 0.0), (1.0, 1.0, 0.1)),),
        moments,
        calls,
        fault=5.0 if off else None,
        faulty_call=1 if off else None,
    )


def campaign(
    folder: Path, *, name: str = "box", has_arm: bool = False, **options: Any
) -> tuple[Path, mutabot.StoredCampaign]:
    """A journal with recordings of one survivor, and what is read of it."""
    apart = (
        Apart("box", "m", 5.0, 0.2, 5.0, 0.2, 0.2, 0.001),
        Apart("tool turned", "deg", 5.0, 2.0, 5.0, 0.0, None, 0.5),
    )
    diverged = Diverged(
        samples.TEST, 5.0, f"{name} is not where it is", f"{name} slipped at 5.0 s", apart, fault=5.0
    )
    outcomes = options.pop("outcomes", samples.OUTCOMES)
    outcomes = tuple(
        replace(outcome, diverged=(diverged,), looked=samples.LOOKED)
        if (outcome.mutant, outcome.round) == (samples.SKIP.id, 1)
        else outcome
        for outcome in outcomes
    )
    journal = samples.write_journal(folder / "journal.sqlite", outcomes=outcomes, **options)
    with Recordings.to_write(journal, 10_000_000) as kept:
        kept.add(ORIGINAL, 1, samples.TEST, Rank.ORIGINAL, to_bytes(recording(name=name, has_arm=has_arm)))
        mutant = to_bytes(recording(off=0.2, name=name, has_arm=has_arm))
        kept.add(samples.SKIP.id, 1, samples.TEST, Rank.SURVIVOR, mutant)
    return journal, mutabot.open(journal)


def write(
    folder: Path,
    journal: Path,
    stored: mutabot.StoredCampaign,
    change: Callable[[Contents], Contents] = lambda contents: contents,
    **options: Any,
) -> Written:
    """Its report."""
    root = stored.meta.get("root")
    with closing(StoredEvidence(journal)) as evidence:
        contents = Contents(portable(stored), "cell", evidence, Cleaner(root))
        return write_folder(folder, change(contents), **options)


def plain(folder: Path, **options: Any) -> Path:
    """The page of a report of the samples."""
    return write(folder / "report", *campaign(folder, **options)).page


def evil(folder: Path) -> Path:
    """The page of a report in which every text means harm."""
    journal, stored = campaign(folder, name=EVIL)
    stored = with_text(stored, EVIL)
    # what was recorded still belongs to its mutant
    mutants = tuple(
        replace(
            stored_result,
            mutant=replace(stored_result.mutant, site=known.mutant.site, variant=known.mutant.variant),
        )
        if known.mutant == samples.SKIP
        else stored_result
        for stored_result, known in zip(stored.mutants, mutabot.open(journal).mutants, strict=True)
    )
    return write(folder / "report", journal, replace(stored, mutants=mutants)).page
