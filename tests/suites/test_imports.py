"""Mutants that act while the program is imported: what is forked there ends as plain pytest does.

Each suite imports the program in another way; plain pytest on an edited copy is the judge of both engines.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome
from tests.campaign.project import Quiet, outcomes, request_for

from .agreement import compare

CONFIGURATION = 'program = ["program"]\ntests = ["tests"]\nfamilies = ["conventional"]\ntimeout_seconds = 5\n'
TABLE = """
    import re

    LIMIT = 3 + 1
    WORD = re.compile("a" + "b*", re.I)
    SIZES = {name: number * 2 for number, name in enumerate(["small", "big"])}
    COUNT = sum(SIZES.values()) - 0

    def scaled(factor):
        def decorate(function):
            return lambda value: function(value) * factor
        return decorate

    @scaled(1 + 1)
    def area(value, offset=0 + 0):
        return value + offset
"""
TESTS = """
    from program import table

    def test_it_is_there():
        assert table.WORD

    def test_words():
        assert table.WORD.fullmatch("ABB")

    def test_area():
        assert table.area(2) == 4

    def test_limit():
        assert table.LIMIT > 3
"""
#: what there is beside an empty ``program/__init__.py``
SUITES: dict[str, dict[str, str]] = {
    "test files import it": {"program/table.py": TABLE, "tests/test_table.py": TESTS},
    "conftest.py imports it, and the session has a state": {
        "program/table.py": TABLE,
        "tests/conftest.py": """
            import pytest
            from program import table

            SEEN = [table.LIMIT]

            def pytest_configure(config):
                SEEN.append(config.rootpath.name)

            def pytest_sessionfinish(session):
                if SEEN[0] > 4:
                    session.exitstatus = 1

            @pytest.fixture(scope="session")
            def sizes():
                return dict(table.SIZES)
        """,
        "tests/test_table.py": """
            def test_sizes(sizes):
                assert sizes["big"] == 2

            def test_small(sizes):
                assert sizes["small"] < 2
        """,
    },
    "it cannot be imported": {
        "program/table.py": """
            LIMIT = 4 - 1
            assert LIMIT > 0, "no limit"
            NAMES = ("one", "two", "three")[:LIMIT]
            LAST = NAMES[LIMIT - 1]
        """,
        "tests/test_a.py": "def test_nothing():\n    pass\n",
        "tests/test_table.py": """
            from program.table import LAST, NAMES

            def test_names():
                assert LAST in NAMES
        """,
    },
    "conftest.py cannot import it": {
        "program/table.py": "LIMIT = 4 - 1\nLAST = [1, 2, 3][LIMIT - 1]\n",
        "tests/conftest.py": "from program import table\n",
        "tests/test_table.py": "def test_nothing():\n    pass\n",
    },
    "its tests do without it if need be": {
        "program/table.py": "LIMIT = 4 - 1\nif LIMIT != 3:\n    raise ValueError(LIMIT)\n",
        "tests/test_table.py": """
            try:
                from program.table import LIMIT
            except ValueError:
                LIMIT = 3

            def test_limit():
                assert LIMIT == 3
        """,
    },
    "it may never come to an end": {
        "program/table.py": """
            MORE = 1 + 1
            while MORE > 3:
                pass
        """,
        "tests/test_table.py": "from program.table import MORE\n\ndef test_more():\n    assert MORE\n",
    },
    "its values are parameters of tests": {
        "program/table.py": "LIMIT = 2 + 1\nNAMES = ['a', 'b', 'c', 'd'][:LIMIT]\n",
        "tests/test_table.py": """
            import pytest
            from program.table import LIMIT, NAMES

            @pytest.mark.parametrize("number", range(3))
            def test_number(number):
                assert number < LIMIT

            def test_names():
                assert NAMES[0] == "a"
        """,
    },
    "tests import it, and again": {
        "program/table.py": TABLE,
        "program/late.py": "from program import table\n\nBOUND = table.LIMIT * 2\n",
        "tests/test_late.py": """
            import importlib
            import sys

            def test_nothing_yet():
                assert "program.late" not in sys.modules

            def test_late():
                from program import late
                assert late.BOUND >= 8

            def test_reloaded():
                from program import late, table
                importlib.reload(table)
                importlib.reload(late)
                assert late.BOUND <= 8

            def test_afresh():
                for name in [name for name in sys.modules if name.startswith("program")]:
                    del sys.modules[name]
                from program import table
                assert table.area(1) == 2
        """,
    },
    "processes import it as well": {
        "program/table.py": """
            LIMIT = 3 + 1
            BOUND = LIMIT * 2

            if __name__ == "__main__":
                print(BOUND)
        """,
        "tests/test_table.py": """
            import subprocess
            import sys
            from program import table

            def said():
                command = [sys.executable, "-m", "program.table"]
                return int(subprocess.run(command, capture_output=True, check=True, text=True).stdout)

            def test_limit():
                assert table.LIMIT < 5

            def test_process():
                assert said() == table.BOUND

            def test_bound():
                assert said() > 6
        """,
    },
    "a process has called it before the tests do": {
        "program/table.py": """
            import sys

            def limit(number):
                return number * 2 + abs(number) - 3

            if __name__ == "__main__":
                print(limit(int(sys.argv[1])))
        """,
        "tests/conftest.py": """
            import subprocess
            import sys

            COMMAND = [sys.executable, "-m", "program.table", "7"]
            SAID = subprocess.run(COMMAND, capture_output=True, check=False, text=True).stdout
        """,
        "tests/test_table.py": """
            from program.table import limit
            from tests.conftest import SAID

            def test_said():
                assert limit(0) < 100
                assert SAID == "18\\n"
        """,
    },
    "a process has imported it before the tests do": {
        "program/table.py": """
            SIGN = -1 if __name__ == "__main__" else 1
            LIMIT = SIGN * 4

            if __name__ == "__main__":
                print(LIMIT)
        """,
        "tests/conftest.py": """
            import subprocess
            import sys

            COMMAND = [sys.executable, "-m", "program.table"]
            SAID = int(subprocess.run(COMMAND, capture_output=True, check=False, text=True).stdout or 0)

            from program import table

            def pytest_report_header():
                return f"{SAID} {table.LIMIT}"
        """,
        "tests/test_table.py": """
            from tests.conftest import SAID

            def test_said():
                assert SAID == -4
        """,
        "tests/__init__.py": "",
    },
    "it runs a thread while it is imported": {
        "program/table.py": """
            import threading
            import time

            WAIT = 3 - 2
            threading.Thread(target=time.sleep, args=(60,), daemon=True).start()
            LIMIT = WAIT * 4
        """,
        "tests/test_table.py": """
            from program import table

            def test_limit():
                assert table.LIMIT == 4
        """,
    },
    "tests look at warnings, arguments and the environment": {
        "program/table.py": """
            import warnings

            LIMIT = 3 + 1
            if LIMIT > 4:
                warnings.warn("too much", DeprecationWarning)
        """,
        "pytest.ini": "[pytest]\npythonpath = .\nfilterwarnings = error\n",
        "tests/test_table.py": """
            import os
            import sys
            from program import table

            def test_arguments():
                assert "PYTEST_CURRENT_TEST" in os.environ and len(sys.argv) > table.LIMIT - 5

            def test_files(tmp_path):
                (tmp_path / "one").write_text(str(table.LIMIT))
                assert (tmp_path / "one").read_text() == "4"
        """,
    },
}
#: suites in which nothing can be forked before the tests, and why
UNSAFE = {
    "a process has imported it before the tests do": "processes of the program were started before any test",
    "it runs a thread while it is imported": "1 more thread, such as Thread-1 (sleep)",
}


first, *others = SUITES


def project(folder: Path, files: dict[str, str]) -> Path:
    more = {
        "program/__init__.py": "",
        "mutabot.toml": CONFIGURATION,
        "pytest.ini": "[pytest]\npythonpath = .\n",
    }
    for name, text in {**more, **files}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text), encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    "suite", [first, *(pytest.param(other, marks=pytest.mark.whole) for other in others)]
)
def test_every_verdict_is_that_of_plain_pytest(tmp_path: Path, suite: str) -> None:
    folder = project(tmp_path / "imports", SUITES[suite])
    found = compare(
        folder, families=("conventional",), only={"conventional": 8}, engines=("fork",), limit=8.0
    )
    assert found.disagreements == []
    assert len(found.compared) >= 5


#: a program that ends the process: nobody knows what that says of the suite
LEAVES = {
    "program/table.py": """
        import os
        import sys

        LEFT = 3 - 2
        if LEFT > 1:
            os._exit(7)
        MORE = LEFT + 1
        if MORE < 2:
            sys.exit("none left")
    """,
    "tests/test_table.py": "from program.table import MORE\n\ndef test_more():\n    assert MORE\n",
}
FACTS = ("verdict", "by", "test", "exception", "hits", "acted", "example", "kills", "complete")


def run(folder: Path, engine: str, only: tuple[str, ...] = ()) -> tuple[dict[str, Outcome], list[str]]:
    quiet = Quiet()
    request = request_for(folder, engine=engine, families=("conventional",), fresh=True, only=only)
    return {outcome.mutant: outcome for outcome in outcomes(run_campaign(request, quiet))}, quiet.lines


@pytest.mark.whole  # the first suite says of one engine what the judge says
@pytest.mark.parametrize(
    "files", [LEAVES, SUITES["it cannot be imported"], SUITES["conftest.py cannot import it"]]
)
def test_both_engines_say_the_same_of_programs_that_cannot_be_imported(
    tmp_path: Path, files: dict[str, str]
) -> None:
    only = ("program/table.py:<module>:*AOR*", "program/table.py:<module>:*ABS=abs")
    forked, _ = run(project(tmp_path / "forked", files), "auto", only)
    replayed, _ = run(project(tmp_path / "replayed", files), "replay", only)
    assert {outcome.engine for outcome in forked.values()} == {"fork"}
    assert {name: _facts(value) for name, value in forked.items()} == {
        name: _facts(value) for name, value in replayed.items()
    }
    assert len({outcome.verdict for outcome in forked.values()}) >= 2


def _facts(outcome: Outcome) -> dict[str, object]:
    return {name: getattr(outcome, name) for name in FACTS}


@pytest.mark.whole
@pytest.mark.parametrize("suite", UNSAFE)
def test_what_cannot_be_forked_while_it_is_imported_runs_in_a_process_of_its_own(
    tmp_path: Path, suite: str
) -> None:
    found, said = run(project(tmp_path, SUITES[suite]), "auto", ("program/table.py:<module>:* 4#1:A*",))
    assert {outcome.engine for outcome in found.values()} == {"replay"}
    why = f"no forks while the program is imported: {UNSAFE[suite]}; "
    assert any(line.startswith(why) for line in said)
