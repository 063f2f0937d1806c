"""The results document: all facts of a campaign as JSON, described by docs/results.schema.json.

Reports are functions of ``results.results.Results``, which holds the same facts.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from mutabot.errors import ExtensionError
from mutabot.extensions import ExtensionPart, brought
from mutabot.journal import records
from mutabot.model import Diverged, LeftOut, Mutant, Outcome, Quantity, Span
from mutabot.model.world_difference import Apart, Measurement
from mutabot.report.mutant_data import SPAN
from mutabot.report.texts import effect_text, excerpts, most_informative, next_step, state_of
from mutabot.results.encoder import Encoder
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import Group, RoundScores, Score
from mutabot.results.statistics import Confirmed, Estimate, false_kills, false_survivors
from mutabot.thresholds import ladders, thresholds
from mutabot.thresholds.thresholds import ladder_line

if TYPE_CHECKING:
    from mutabot.results.suggested import Suggestion

#: raised when a key changes its meaning or goes away; new keys do not raise it
FORMAT = 2


def dumps(data: Any) -> str:
    """Return valid JSON of a report's data: numbers that JSON cannot represent become null."""
    return json.dumps(finite(data), indent=2, ensure_ascii=False, default=str)


def finite(value: Any, number: Callable[[float], float] = float) -> Any:
    """Return data that JSON can represent: NaN and infinity become null, ``number`` maps other numbers."""
    if isinstance(value, dict):
        return {str(key): finite(item, number) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item, number) for item in value]
    if isinstance(value, float):
        return number(value) if math.isfinite(value) else None
    return value


def document(results: Results) -> dict[str, Any]:
    """Return the results document, with sections by packages."""
    return {
        "format": FORMAT,
        **data_of.facts(results, "state finished=is_complete attempt"),
        "meta": {key: value for key, value in results.meta.items() if key in records.PLAIN},
        **data_of.facts(
            results,
            "rounds=all.rounds# groups mutants graded left_out controls baseline sample=drawing since budget "
            "flaky=flaky.tests verification repeats confirmation shard set_aside altered "
            "operators draws reaching untested sources",
        ),
        "accepting": accepting_data(results),
        "sections": {
            name: made
            for name, part in brought("sections").items()
            if (made := _section(part, results)) is not None
        },
    }


def _section(part: ExtensionPart, results: Results) -> Any:
    make = part.load()
    try:
        return data_of(make(results))
    except Exception as error:  # a package of others may fail in any way
        raise ExtensionError(f"{part.text} makes no section of these results: {error!r}") from error


def accepting_data(results: Results) -> dict[str, Any]:
    """Return the accepted survivors, and decisions that no longer have an effect."""
    return {
        "survivors": [
            data_of.facts(result, "number=mutant.number id=mutant.id *acceptance")
            for result in results.accepted
        ],
        "without_effect": [*results.needlessly_accepted, *results.accepting.unmatched],
    }


def shown_data(
    result: MutantResult, source: Callable[[str], str | None], suggestion: Suggestion | None
) -> dict[str, Any]:
    """Return the data of one mutant: its source, its story, the checks that ran, and its suggestion.

    Args:
        source: the text of a file, or None if it is not known.
        suggestion: what was suggested for it; None if nothing was looked for.
    """
    round, diverged = most_informative(result) or (None, None)
    outcome = result.rounds[round] if round is not None else None
    return {
        **data_of(result),
        "source": excerpts(result.mutant.site, source),
        "effect": effect_text(result),
        "story": {"round": round + 1, **data_of(diverged)} if round is not None and diverged else None,
        "checks": data_of(outcome.looked) if outcome is not None else [],
        "suggestion": data_of(suggestion),
        "next": next_step(result, suggestion) or None,
    }


def replayed(mutant: Mutant, rounds: Iterable[records.Replayed]) -> dict[str, Any]:
    """Return the re-runs of a mutant beside its outcomes in the journal."""
    return {**data_of.facts(mutant, "id number"), "rounds": data_of(list(rounds))}


def _mutant(result: MutantResult) -> dict[str, Any]:
    data = data_of.facts(
        result,
        "*mutant meaning=quantity rounds# kill_rate survivor=is_survivor indistinguishable deviation "
        "why earlier outdated accepted=acceptance?",
    )
    if not result.is_accepted:
        data["accepted"] = None
    data["status"] = None if result.status is None else state_of(result)
    data["kill_rate"] = data_of.facts(result.kill_rate, "killed valid rate=score interval")
    return data if result.lets_through else data | {"deviation": None}


def _replayed(replayed: records.Replayed) -> dict[str, Any]:
    none = {"journal": {"round": replayed.round + 1, "verdict": None}} if replayed.first is None else {}
    return data_of.facts(replayed, "round=round+1 agrees journal=first replay=second") | none


def _repeats(repeats: records.Repeats) -> dict[str, Any]:
    found = {"false_kills": false_kills(repeats), "false_survivors": false_survivors(repeats)}
    return {**data_of.facts(repeats, "doubted others certain survivors"), **data_of(found)}


def _ladder(ladder: ladders.Ladder) -> dict[str, Any]:
    known = "none_up_to? half_from all_from refused_from median share_shown"
    is_judged = not ladder.why_unjudged
    found = data_of.facts(ladder, known) if is_judged else dict.fromkeys(known.replace("?", "").split())
    return {
        **data_of.facts(
            ladder,
            "id place name file=mutant.site.span.file line=mutant.site.span.line "
            "function=mutant.site.span.function call=mutant.site.text role=mutant.site.role "
            "quantity=mutant.quantity operator=mutant.operator direction=mutant.direction unit "
            "magnitudes=sizes why=why_unjudged?",
        ),
        "judged": is_judged,
        "text": ladder_line(ladder) if is_judged else None,
        **found,
        "rounds_counted": len(ladder.counted),
        **data_of.facts(ladder, "rounds violations"),
    }


def _ladder_round(ladder_round: ladders.LadderRound) -> dict[str, Any]:
    return {
        **data_of.facts(
            ladder_round,
            "round=number+1 counts why=why_out? missed=bracket.low noticed=bracket.high "
            "refused=bracket.refused by=noticed_by above",
        ),
        "verdicts": [
            {"magnitude": size, "verdict": outcome.verdict.value}
            for size, outcome in ladder_round.outcomes.items()
        ],
    }


def _thresholds(found: thresholds.Thresholds) -> dict[str, Any]:
    return {"format": FORMAT, **data_of.facts(found, "state rounds ladders=all")}


#: JSON-like data of anything of ours
data_of = Encoder(
    {
        Mutant: "id number operator variant family role=site.role file=site.span.file span=site.span "
        "other_spans=site.other_spans function=site.span.function site=site.id call=site.text operation "
        "pattern quantity description magnitude unit direction? ladder? moment=moment.text",
        Span: SPAN,
        Quantity: "kind axis unit frame mode",
        MutantResult: _mutant,
        Outcome: "round=round+1 verdict by test exception message place hits acted away example tests wall "
        "cpu simulated indistinguishable deviation distance divergence way gaps compared commands engine "
        "repeats beside confirmed kills complete looked diverged",
        Diverged: "* deviation",
        Apart: "* deviation",
        Measurement: "* deviation",
        Score: "score check_score killed valid by_check timeouts counts=of_each",
        RoundScores: "*total score=mean check_score=mean_check interval check_interval sample_interval "
        "sample_check_interval accepted rounds#",
        Group: "family role mutants population *scores",
        LeftOut: "id description reason",
        records.ControlEnd: "test_file control ok detail",
        records.BaselineTest: "test=test.test round=round+1 repetition=repetition+1 outcome=test.outcome "
        "wall=test.wall simulated=test.simulated",
        records.Drawing: "size=sample selected",
        records.Verification: "wanted checked agreed disagreements",
        records.Disagreement: "id=mutant number round=round+1 first second",
        records.Repeats: _repeats,
        Estimate: "expected low high level known unknown",
        Confirmed: "outcomes refused confirmed wrong left most level text",
        records.ShardOf: "number of mutants",
        records.Untested: "text calls functions files unreached_calls unreached_functions unreached_files "
        "doubtful_calls",
        records.UntestedCall: "place text operation doubt?",
        records.Replayed: _replayed,
        thresholds.Thresholds: _thresholds,
        ladders.Ladder: _ladder,
        ladders.LadderRound: _ladder_round,
        ladders.Between: "above=low? at_most=high level",
        ladders.Violation: "round=round+1 noticed missed",
    }
)
