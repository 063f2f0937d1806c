"""What a command works on, and where its output goes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from mutabot.cli.streams import output_failed
from mutabot.errors import UsageError, unknown_name_text
from mutabot.journal.files import find_journal
from mutabot.report.document import data_of, document, dumps
from mutabot.report.sections import Section
from mutabot.report.terminal.campaign import print_results, print_summary
from mutabot.report.terminal.console import leave_pipe, make_console, print_section
from mutabot.report.terminal.progress import Bar, Lines, make_progress
from mutabot.report.texts import portable
from mutabot.results.films import KeptFilm, keep_film
from mutabot.results.gate import Decision, decide
from mutabot.results.results import Results
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import Suggestion, keep_suggestions

if TYPE_CHECKING:
    from rich.console import Console

    from mutabot.campaign.request import Progress, Request
    from mutabot.config.configuration import Configuration
    from mutabot.model.mutant_end import MutantEnd
    from mutabot.report.stream import MutantStream


class CommandContext:
    """The project that a command works on, and the command's output.

    Results and JSON go to standard output, progress and remarks to standard error.

    Args:
        project: the folder that ``-C`` names.
    """

    def __init__(self, project: Path) -> None:
        self.project = project

    @cached_property
    def journal(self) -> Path:
        """The journal of the project, also from a folder inside it; its folder has all files of mutabot."""
        return find_journal(self.project)

    def results(self, *, earlier: bool = False) -> Results:
        """Return the results of the last campaign, and earlier ones if ``earlier``. Raises JournalError."""
        return Results.read(self.journal, earlier=earlier)

    def recordings(self) -> StoredEvidence:
        """Open the recordings of the last campaign; the caller closes them. Raises JournalError."""
        return StoredEvidence(self.journal)

    def keep_film(self, results: Results, mutant: str, file: Path, round: int, test: str) -> None:
        """Keep a copy of a film of a mutant, for the pages of the campaign's report.

        Args:
            results: of the campaign.
            mutant: its id.
            file: the film: H.264 in MP4.
            round: which, from 0.
            test: node id.

        Raises UsageError if it cannot be kept.
        """
        keep_film(self.journal, results.meta, mutant, KeptFilm(file, round, test))

    def keep_suggestions(
        self,
        results: Results,
        checks: Mapping[str, tuple[str, str, tuple[str, ...]]],
        reasons: Mapping[str, str],
    ) -> None:
        """Keep suggestions for survivors, by their ids, for reports of this campaign.

        Args:
            checks: a check that kills it: the test that it is added to, its code, and what there is to say of
                it, a line each.
            reasons: why there is none.

        Raises UsageError if it cannot be written.
        """
        found = {survivor: Suggestion(reason=why) for survivor, why in reasons.items()}
        found |= {survivor: Suggestion(*check) for survivor, check in checks.items()}
        keep_suggestions(self.journal, results.meta, found)

    def request_again(self, results: Results, jobs: int | None) -> Request:
        """Return the request of the campaign that had these results, with ``jobs`` processes if not None.

        Raises UsageError and ConfigurationError.
        """
        from mutabot.cli.request import request_again  # noqa: PLC0415  # it loads what runs campaigns

        return request_again(self.journal.parent.parent, results, jobs)

    def print(self, text: str) -> None:
        """Print a text. A reader that leaves early does not change the exit code."""
        self.print_bytes(f"{text}\n".encode(sys.stdout.encoding or "utf-8", errors="replace"))

    def print_bytes(self, data: bytes) -> None:
        """Print bytes unchanged, in UTF-8 for any encoding of the terminal."""
        try:
            sys.stdout.flush()
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
        except BrokenPipeError:
            leave_pipe()
        except OSError as error:
            output_failed(error)

    def print_json(self, data: Any) -> None:
        """Print data as JSON, as docs/json.md describes it."""
        self.print(dumps(data_of(data)))

    def print_section(self, title: str, lines: Sequence[str] = (), at_most: int | None = None) -> None:
        """Print a heading with lines below it, of many the first ``at_most``."""
        print_section(make_console(), Section(title, lines=lines), at_most)

    def notify(self, lines: Iterable[str]) -> None:
        """Print lines on standard error, so that they do not mix with results."""
        for line in lines:
            typer.echo(line, err=True)

    def progress(self) -> Bar | Lines:
        """Return a display of a campaign's progress, to be used as a context manager."""
        return make_progress(make_console(stderr=True))

    def show_results(
        self, path: Path, *, json: bool, earlier: bool = False, summary: bool = False
    ) -> Results:
        """Print the results in the journal at ``path``, and return them.

        Args:
            earlier: also show what earlier campaigns found.
            summary: leave out the table of mutants.
        """
        found = Results.read(path, earlier=earlier)
        if json:
            self.print_json(document(found))
        elif summary:
            print_summary(make_console(), found)
        else:
            print_results(make_console(), found)
        return found

    def run_to_end(
        self,
        request: Request,
        run: Callable[[Progress], Path],
        min_score: float | None,
        *,
        json: bool = False,
        stream: str = "",
        fail_on: Sequence[str] = (),
    ) -> NoReturn:
        """Run a campaign, print its summary or a line per mutant, and exit as the limits decide.

        Args:
            run: runs the campaign, and returns the path of its journal.
            min_score: in percent; None for the configured one.
            json: print the results as JSON.
            stream: name of a format of lines, of which each is printed as soon as its mutant is settled;
                empty for the summary.
            fail_on: what there must be none of, by names of ``config.options.FAIL_ON``.

        Raises UsageError for an unknown format, typer.Exit, and what the campaign raises.
        """
        if stream:
            results = self._stream(stream, request, run)
        else:
            with self.progress() as progress:
                path = run(progress)
            results = self.show_results(path, json=json, summary=True)
        self.exit_as(decided(request.configuration, results, min_score, fail_on))

    def _stream(self, format: str, request: Request, run: Callable[[Progress], Path]) -> Results:
        """Run a campaign and print a line per mutant as soon as it is settled."""
        from mutabot.report.stream import STREAMED, MutantStream  # noqa: PLC0415  # few commands need it

        if format not in STREAMED:
            raise UsageError(unknown_name_text("format of lines", format, STREAMED))
        stream = MutantStream(format, request.rounds, request.vocabulary, str(request.root), self.print)
        with _Streaming(make_console(stderr=True), stream) as progress:
            path = run(progress)
        results = Results.read(path)
        stream.finish(portable(results))
        return results

    def exit_as(self, decision: Decision) -> NoReturn:
        """Print the reason of a decision, and exit with its code. Raises typer.Exit."""
        self.notify(decision.lines)
        raise typer.Exit(decision.exit_code)


class _Streaming(Lines):
    """Plain lines of progress, whose outcomes of mutants go to a stream instead."""

    def __init__(self, console: Console, stream: MutantStream) -> None:
        super().__init__(console)
        self._stream = stream

    def mutant_ended(self, end: MutantEnd) -> None:
        """Pass the outcome to the stream."""
        self._stream.add(end)


def decided(
    configuration: Configuration, results: Results, min_score: float | None, fail_on: Sequence[str] = ()
) -> Decision:
    """Compare results with the limits; ``min_score``, in percent, replaces the configured one."""
    limit = min_score if min_score is not None else configuration.min_score
    return decide(
        results,
        min_score=None if limit is None else limit / 100,
        max_timeouts=configuration.timeout_limit,
        max_unstable=configuration.unstable_limit,
        max_errors=configuration.error_limit,
        demands=configuration.demands,
        fail_on=fail_on,
    )
