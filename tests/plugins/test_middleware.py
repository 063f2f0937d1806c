"""A middleware that mutabot has never heard of: a package brings it, and no file of the core knows of it.

A bus keeps messages in the file that the environment names until its subscribers look there. The package is
installed as an installer would leave it, and campaigns run by the command line.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

#: what is installed beside mutabot: the client library, and what mutabot needs to know of it
SITE = {
    "toybus-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: toybus\nVersion: 1.0\n",
    "toybus-1.0.dist-info/entry_points.txt": "[mutabot]\ntoybus = toybus_mutabot:EXTENSION\n",
    "toybus.py": """
        import json, os
        from types import SimpleNamespace as Message

        def publish(topic, message):
            with open(os.environ["TOYBUS"], "a") as file:
                print(json.dumps([topic, vars(message)]), file=file)

        def look(topic, callback):
            if not os.path.exists(os.environ["TOYBUS"]):
                return
            with open(os.environ["TOYBUS"]) as file:
                messages = [json.loads(line) for line in file]
            os.remove(os.environ["TOYBUS"])
            for name, fields in messages:
                if name == topic:
                    callback(Message(**fields))
        """,
    "toybus_mutabot/__init__.py": """
        from mutabot.api.faults import Extension

        EXTENSION = Extension(
            interface=2,
            middlewares={"toybus": "toybus_mutabot.hooks"},
            environments={"toybus": "toybus_mutabot.environment"},
            libraries={"toybus": ()},
        )
        """,
    "toybus_mutabot/hooks.py": """
        import sys
        from functools import partial

        from mutabot.api.values import Form, MiddlewareControls, Where

        assert "toybus" in sys.modules, "hooks are imported before what they hook"

        NODE = "/main"

        def hook(names):
            toybus = sys.modules["toybus"]
            originals = toybus.publish, toybus.look

            def publish(topic, message):
                names.heard(topic, message)
                handler = names.find(Form.PUBLISH, topic, NODE)
                send = partial(originals[0], topic)
                if handler is None:
                    return send(message)
                return handler(send, None, (message,), {}, Where(node=NODE, means=MiddlewareControls()))

            def look(topic, callback):
                def received(message):
                    names.heard(topic, message)
                    handler = names.find(Form.RECEIVE, topic, NODE)
                    if handler is None:
                        return callback(message)
                    where = Where(callback.__code__, NODE, MiddlewareControls())
                    return where.deliver(handler, message, callback)
                originals[1](topic, received)

            def undo():
                toybus.publish, toybus.look = originals

            toybus.publish, toybus.look = publish, look
            return undo
        """,
    "toybus_mutabot/environment.py": """
        import os
        import tempfile

        def prepare(root, home, operations):
            name = f"toybus-{os.path.basename(home)}.txt"  # forks share the home, but not the temporary files
            os.environ["TOYBUS"] = os.path.join(tempfile.gettempdir(), name)
            return True
        """,
}
#: the same with a simulation of the bus, of which each message comes so many times
SIMULATED = {
    "toybus_mutabot/__init__.py": """
        from mutabot.api.faults import Extension

        EXTENSION = Extension(
            interface=2,
            middlewares={"toybus": "toybus_mutabot.hooks"},
            environments={"toybus": "toybus_mutabot.environment"},
            simulations={"toybus": "toybus_mutabot.simulation:InMemory"},
        )
        """,
    "toybus_mutabot/simulation.py": """
        from mutabot.api.processes import SimulatedMiddleware

        class InMemory(SimulatedMiddleware):
            name, title, real = "toybus", "a bus in memory", "the real bus"
            clock = "toybus_mutabot.in_memory:Clock.advance"

            def arguments(self, root, given, tables):
                return ["-p", "toybus_mutabot.in_memory"]
        """,
    "toybus_mutabot/in_memory.py": """
        import toybus

        kept = []

        class Clock:
            now = 0.0

            def advance(self):
                self.now += 0.1
                return self.now

        clock = Clock()

        def publish(topic, message):
            clock.advance()
            kept.append((topic, vars(message)))

        def look(topic, callback):
            came = TIMES * kept
            kept.clear()
            for name, fields in came:
                if name == topic:
                    callback(toybus.Message(**fields))

        toybus.publish, toybus.look = publish, look
        """,
}
PROJECT = {
    "mutabot.toml": """
        program = ["mission.py"]
        vocabulary = ["robot.toml"]
        pytest_args = ["-o", "pythonpath=."]
        """,
    "robot.toml": """
        [[operation]]
        topic = "/goal"
        direction = "publish"
        fields.x = { kind = "translation", axis = "x", unit = "m", mode = "to" }

        [[operation]]
        topic = "/goal"
        direction = "receive"
        """,
    "mission.py": """
        import toybus

        way = []

        def move(message):
            way.append(message.x)

        def run():
            toybus.publish("/goal", toybus.Message(x=0.25))
            toybus.look("/goal", move)
            return way

        if __name__ == "__main__":
            print(run())
        """,
    "tests/test_mission.py": """
        import mission

        def test_it_moves():
            assert mission.run() == [0.25]
        """,
}
#: a test that passes however often a message comes
LENIENT = """
    import mission

    def test_it_moves():
        del mission.way[:]
        assert mission.run()[-1] == 0.25
    """
#: the same in a process of its own
IN_A_PROCESS = """
    import subprocess, sys

    def test_it_moves():
        assert subprocess.check_output([sys.executable, "mission.py"]).strip() == b"[0.25]"
    """


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder into which the package is installed."""
    return written(tmp_path / "site", SITE)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project whose program uses the bus."""
    return written(tmp_path / "project", PROJECT)


def written(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(dedent(text), encoding="utf-8")
    return folder


def mutabot(site: Path, project: Path, *arguments: str, code: str = "") -> subprocess.CompletedProcess[str]:
    """Run the command line where the package is installed; ``code`` comes before."""
    return subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; from mutabot.cli.app import main; sys.exit(main())",
         "-C", str(project), *arguments],
        env={**os.environ, "PYTHONPATH": str(site)}, capture_output=True, text=True, check=False,
    )  # fmt: skip


def verdicts(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["mutants"]
    ends = {mutant["id"].partition(":")[2]: mutant["rounds"][0] for mutant in found}
    return {name: (end["verdict"], end["by"]) for name, end in ends.items()}


@pytest.mark.needs("catalogue")
@pytest.mark.parametrize(
    ("tests", "operators"),
    [
        (PROJECT["tests/test_mission.py"], ("reverse", "drop", "duplicate")),
        pytest.param(IN_A_PROCESS, ("reverse", "drop"), marks=pytest.mark.whole),
    ],
    ids=["in the tests' process", "in a process of its own"],
)
def test_its_messages_are_mutated(tests: str, operators: tuple[str, ...], site: Path, project: Path) -> None:
    written(project, {"tests/test_mission.py": tests})
    only = [word for name in operators for word in ("--only", name)]
    options = ("--family", "robot,middleware", "--json", "-o", "repeats=false", *only)
    ends = {
        "run:toybus.publish#1:x:reverse": ("killed", "check"),
        "run:toybus.publish#1:call:drop": ("killed", "check"),
        "run:toybus.publish#1:call:duplicate": ("killed", "check"),
        "move:def move#1:call:drop": ("killed", "check"),
        "move:def move#1:call:duplicate": ("killed", "check"),
    }
    assert verdicts(mutabot(site, project, "run", *options)) == {
        name: end for name, end in ends.items() if name.endswith(operators)
    }


@pytest.mark.parametrize(
    ("times", "told"),
    [
        ("1", "over a bus in memory; the original ends there as over the real bus (1 test compared)."),
        ("2", "over the real bus, not over a bus in memory: tests/test_mission.py::test_it_moves differs in"),
    ],
    ids=["alike", "otherwise"],
)
def test_its_simulation_is_used_if_the_original_ends_there_as_over_the_bus(
    times: str, told: str, site: Path, project: Path
) -> None:
    written(site, {name: text.replace("TIMES", times) for name, text in SIMULATED.items()})
    written(project, {"tests/test_mission.py": LENIENT})
    done = mutabot(site, project, "check")
    assert done.returncode == 0, done.stderr
    assert f"The tests ran {told}" in " ".join(done.stdout.split())
    assert "unused clock" not in " ".join(done.stdout.split())


@pytest.mark.needs("init")
def test_init_proposes_its_topics(site: Path, project: Path) -> None:
    for name in ("mutabot.toml", "robot.toml"):
        (project / name).unlink()
    done = mutabot(site, project, "init")
    assert done.returncode == 0, done.stderr
    text = (project / "robot.toml").read_text(encoding="utf-8")
    assert 'topic = "/goal"' in text
    assert "toybus" not in text


def test_names_where_no_middleware_is_installed_are_refused_with_what_is_needed(project: Path) -> None:
    nothing = "from mutabot import extensions\nextensions._declared = lambda: ()"
    done = mutabot(Path(), project, "check", code=nothing)
    assert done.returncode == 2
    assert "robot.toml:2 · publish /goal: it is a name on a middleware, but no installed" in done.stderr
    assert "mutabot_ros" in done.stderr


@pytest.mark.needs("ros")
def test_a_campaign_without_its_client_library_says_which_middlewares_are_known(project: Path) -> None:
    written(project, {"mission.py": "", "tests/test_mission.py": "def test_nothing(): pass\n"})
    done = mutabot(Path(), project, "check")
    assert "middlewares that are known here: rclpy, rospy, actionlib, tf2_ros" in done.stderr


def test_hooks_that_cannot_be_loaded_are_reported_and_the_package_is_named(site: Path, project: Path) -> None:
    (site / "toybus_mutabot" / "hooks.py").write_text("raise RuntimeError('no licence')\n", encoding="utf-8")
    done = mutabot(site, project, "check")
    assert done.returncode in (2, 3)
    text = "'toybus' of package 'toybus_mutabot' (toybus_mutabot.hooks) cannot be loaded: RuntimeError"
    assert text in " ".join(done.stderr.split())
