"""The server gives the report to who knows its address, and to nobody else; nobody holds it up."""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

import pytest

import mutabot
from mutabot.errors import UsageError
from mutabot.results.suggested import Suggestion, keep_suggestions
from mutabot_live.pages import Pages
from mutabot_live.server import LiveFeed, Server
from packages.live.visits import ask, command, listening, origin
from report.html import reports


@dataclass
class Served:
    """A server of the samples, with a log of its commands."""

    server: Server
    feed: LiveFeed
    folder: Path
    commands: list[str] = field(default_factory=list)

    @property
    def address(self) -> str:
        return self.server.address


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    journal, _ = reports.campaign(tmp_path)
    feed, given = LiveFeed(), []
    pages = Pages(journal, "cell", lambda: 1)
    pages.look_at_once()
    names = ("stop", "other")
    commands = {name: (lambda name=name: given.append(name)) for name in names}
    server = Server(pages, feed, commands)
    yield Served(server, feed, tmp_path, given)
    feed.close()
    server.close()


def test_it_is_the_report_that_is_written_to_a_folder(served: Served) -> None:
    journal = served.folder / "journal.sqlite"
    folder = reports.write(served.folder / "report", journal, mutabot.open(journal)).page.parent
    names = {file.relative_to(folder).as_posix() for file in folder.rglob("*.*")}
    numbered = {name for name in names if name.startswith("data/originals/")}
    for name in names - numbered - {"index.html", "mutabot-report.txt"}:
        answer = ask(served.address, name)
        assert answer.status == 200, name
        served_alone = r",\"version\":1(?=}'\);\n$)"
        assert re.sub(served_alone, "", answer.text) == (folder / name).read_text("utf-8"), name


def test_a_check_that_was_suggested_is_on_the_page_of_its_survivor(served: Served) -> None:
    journal = served.folder / "journal.sqlite"
    found = mutabot.open(journal)
    keep_suggestions(journal, found.meta, {found.mutant("2").mutant.id: Suggestion("t", "assert box.open")})
    assert "assert box.open" in ask(served.address, "data/mutants/2.js").text
    assert "assert box.open" not in ask(served.address, "data/mutants/3.js").text


def test_originals_are_there_once_a_mutant_that_needs_them_was_asked_for(served: Served) -> None:
    assert ask(served.address, "data/originals/0.js").status == 404
    for _ in range(2):
        assert '"original":0' in ask(served.address, "data/mutants/2.js").text
    assert ask(served.address, "data/originals/0.js").text.startswith("mutabot.take('original 0'")
    assert ask(served.address, "data/originals/1.js").status == 404


def test_the_page_may_ask_its_server_and_no_other(served: Served) -> None:
    text = ask(served.address).text
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    rules = dict(rule.strip().split(" ", 1) for rule in policy[1].split(";"))
    assert rules["default-src"] == "'none'"
    assert set(rules.values()) == {"'none'", "'self'"}
    assert rules["connect-src"] == "'self'"
    for name in re.findall(r'(?:src|href)="(assets/[^"]*)"', text):
        assert ask(served.address, name).status == 200, name


def test_without_the_token_there_is_nothing(served: Served) -> None:
    token = urlsplit(served.address).path.strip("/")
    assert len(token) >= 32
    changed = f"%{ord(token[0]):x}{token[1:]}"
    for other in ("", "data", token[:-1], f"{token}x", token.swapcase(), changed, "%C3%A9"):
        answer = ask(served.address, f"/{other}/data/campaign.js")
        assert (answer.status, answer.text) == (404, "there is no such page\n"), other
        assert ask(served.address, f"/{other}/stop", "POST", origin(served.address)).status == 404
    assert served.commands == []
    assert ask(served.address, f"/{token}").headers["Location"] == f"/{token}/"


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example", "localhost.", "0.0.0.0", "127.0.0.1:x", ""]
)
def test_another_name_for_this_machine_is_refused(served: Served, host: str) -> None:
    answer = ask(served.address, headers={"Host": host})
    assert (answer.status, "<html" in answer.text) == (421, False)
    assert ask(served.address, "stop", "POST", {"Host": host, "Origin": f"http://{host}"}).status == 421
    assert served.commands == []


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:8000", "127.0.0.1:9", "[::1]:8000"])
def test_behind_a_tunnel_the_port_is_another(served: Served, host: str) -> None:
    assert ask(served.address, headers={"Host": host}).status == 200
    assert ask(served.address, "stop", "POST", {"Host": host, "Origin": f"http://{host}"}).status == 204


@pytest.mark.parametrize(
    "path",
    [
        "../journal.sqlite", "assets/../../pages.py", "..%2f..%2fetc/passwd", "%2e%2e/journal.sqlite",
        "assets/%2e%2e/live.js", "data/mutants/../campaign.js", "data/mutants/2.js/..", "data//campaign.js",
        "data/mutants/0000000002.js", "assets/", "assets/index.html", "data/mutants/99.js", "..\\pages.py",
        "data/mutants/%D9%A2.js", "/etc/passwd", "stop",
    ],
)  # fmt: skip
def test_what_is_not_in_the_tables_is_not_there(served: Served, path: str) -> None:
    assert ask(served.address, urlsplit(served.address).path + path).status == 404


def test_commands_come_from_the_page_alone(served: Served) -> None:
    for wrong in (
        {},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
    ):
        assert ask(served.address, "stop", "POST", wrong).status == 403
    assert served.commands == []
    assert ask(served.address, "stop").status == 404  # a link or a picture cannot give one
    assert ask(served.address, "fire", "POST", origin(served.address)).status == 404
    assert [command(served.address, name) for name in ("other", "stop")] == [204, 204]
    assert served.commands == ["other", "stop"]


def test_no_other_site_may_read_frame_or_keep_it(served: Served) -> None:
    for path in ("", "data/campaign.js"):
        headers = ask(served.address, path, headers={"Origin": "http://evil.example"}).headers
        assert "Access-Control-Allow-Origin" not in headers
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert headers["Content-Security-Policy"] == "frame-ancestors 'none'"
        assert headers["Cache-Control"] == "no-store"
        assert headers["Referrer-Policy"] == "no-referrer"


def test_it_listens_on_this_machine_alone(served: Served) -> None:
    parts = urlsplit(served.address)
    assert parts.hostname == "127.0.0.1"
    assert parts.port is not None
    with pytest.raises(ConnectionRefusedError), socket.create_connection(("127.0.0.2", parts.port), 5):
        pass


def test_several_browsers_hear_the_same_and_one_that_comes_back_only_what_is_new(served: Served) -> None:
    served.feed.put({"done": 1})
    served.feed.note("something")
    with listening(served.address) as first_browser, listening(served.address) as second_browser:
        first = [next(first_browser), next(first_browser)]
        assert (
            first
            == [next(second_browser), next(second_browser)]
            == [(1, "state", {"done": 1}), (2, "note", "something")]
        )
    served.feed.put({"done": 2})
    with listening(served.address, last=2) as again:
        assert next(again) == (3, "state", {"done": 2})
    with listening(served.address, last=77) as stranger:
        assert [next(stranger)[0], next(stranger)[0]] == [2, 3]


def test_a_browser_that_never_reads_holds_up_nobody(served: Served) -> None:
    parts = urlsplit(served.address)
    with socket.create_connection((parts.hostname, parts.port), 5) as idle:
        idle.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        idle.sendall(f"GET {parts.path}events HTTP/1.1\r\nHost: {parts.netloc}\r\n\r\n".encode())
        with listening(served.address) as reader:
            for number in range(2000):
                served.feed.put({"done": number, "filling": "x" * 5000})
            assert any(data["done"] == 1999 for _, kind, data in reader if kind == "state")


def test_a_browser_that_closes_is_known_to_have_gone(served: Served) -> None:
    assert not served.feed.is_listened_to(0.0)
    served.feed.put({})
    with listening(served.address) as reader:
        next(reader)
        assert served.feed.is_listened_to(0.0)
    while served.feed.is_listened_to(0.0):
        pass
    assert served.feed.is_listened_to(1e9)


def test_a_port_that_is_taken_is_the_users_concern(served: Served) -> None:
    port = urlsplit(served.address).port
    assert port is not None
    with pytest.raises(UsageError, match=rf"--port {port} of 127.0.0.1"):
        Server(Pages(served.folder / "none.sqlite", "cell", lambda: 0), LiveFeed(), {}, port)


def test_before_there_is_a_journal_the_page_has_no_data_and_no_error(tmp_path: Path) -> None:
    pages = Pages(tmp_path / "journal.sqlite", "cell", lambda: 1)
    for name in ("data/campaign.js", "data/sources.js"):
        page = pages.get(name)
        assert page is not None
        assert page.data == b""
    assert pages.get("data/mutants/1.js") is None


def test_data_say_up_to_which_step_they_go(tmp_path: Path) -> None:
    journal, _ = reports.campaign(tmp_path)
    page = Pages(journal, "cell", lambda: 3).get("data/campaign.js")
    assert page is not None
    assert b'"version":3}' in page.data
