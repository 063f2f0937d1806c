"""Disturbances of a world: when they begin, what is said of them, and that all engines say the same."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.plugins.test_plugins import USAGE, mutabot

from .belts import FILES, LONG, SHORT, project, run, told

#: exit code of a campaign without a mutant
NO_MUTANTS = 3
SPEED = """
    [[tool.mutabot.world.parameter]]
    name = "speed"
    path = "speed"
    change = "scale"
    ladder = [0.01, 10, 50]
    more = "a belt that is {} faster"
    less = "a belt that is {} slower"
    """


@pytest.fixture(scope="module")
def speed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project whose belt was too fast and too slow."""
    folder = project(tmp_path_factory.mktemp("speed"), SPEED)
    run(folder)
    return folder


def test_what_no_test_notices_is_lived_with_or_suffered_unseen(speed: Path) -> None:
    found = told(speed)
    assert found["speed +"]["ends"] == {"0.01": "lived with", "10": "suffered unseen", "50": "noticed"}
    assert found["speed -"]["ends"] == {"0.01": "lived with", "10": "suffered unseen", "50": "noticed"}
    assert found["speed +"]["sentence"] == "your tests notice a belt that is 50 % faster, not one of 10 %"
    assert found["speed -"]["lived_with_up_to"] == 0.01


def test_a_disturbance_belongs_to_a_test_and_a_parameter(speed: Path) -> None:
    assert told(speed, of=LONG)["speed +"]["noticed_from"] == 50
    short = told(speed, of=SHORT)["speed +"]
    assert short["noticed_from"] is None
    assert short["sentence"] == "your tests do not notice a belt that is 50 % faster, the most that was tried"


def test_the_terminal_shows_what_is_suffered_unseen_first(speed: Path) -> None:
    done = mutabot(None, speed, "world")
    assert done.returncode == 0, done.stderr
    assert "speed +    0.01 … 50 %  ·!█" in done.stdout
    assert done.stdout.index("suffered unseen at 10 %") < done.stdout.index("How robust the program is")


def test_sentences_fit_the_terminal(speed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    done = mutabot(None, speed, "world")
    assert max(map(len, done.stdout.splitlines())) <= 60


def test_world_faults_are_in_no_score(speed: Path) -> None:
    done = mutabot(None, speed, "results", "--json")
    assert '"groups": []' in done.stdout.replace("\n", "") or '"mutants": []' in done.stdout


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
@pytest.mark.parametrize(
    ("when", "least"),
    [
        # half as fast from there on: the long way is 0.5 · (3 - t) too short, of which 0.6 is allowed
        ("made", True),
        ("1.5 s", True),
        ("2.5 s", False),
        ("call 16 of belt:Belt.advance", True),
        ("call 26 of belt:Belt.advance", False),
        ("while belt:is_far at belt:Belt.advance", True),
    ],
)
def test_moments(engine: str, when: str, least: bool, tmp_path: Path) -> None:
    half = SPEED.replace("[0.01, 10, 50]", "[50]").replace("    more =", f'    when = "{when}"\n    more =')
    found = run(project(tmp_path, half), "--engine", engine)
    assert (found["speed -"]["noticed_from"] == 50) == least


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
@pytest.mark.parametrize(
    ("of", "when"), [("belt:make_belt", "made"), ("belt:Belt", "call 16 of belt:advance")]
)
def test_functions_are_found_that_the_program_has_imported_by_their_names(
    engine: str, of: str, when: str, tmp_path: Path
) -> None:
    functions = """
        def make_belt():
            return Belt()


        def advance(belt):
            return belt.advance()
        """
    mission = """
        from belt import advance, make_belt


        def drive(seconds, on=None):
            here = on or make_belt()
            while here.time < seconds - 0.05:
                advance(here)
            return here.position
        """
    half = SPEED.replace("[0.01, 10, 50]", "[50]").replace("    more =", f'    when = "{when}"\n    more =')
    folder = project(tmp_path, half, **{"belt.py": FILES["belt.py"] + functions, "mission.py": mission})
    settings = folder / "pyproject.toml"
    settings.write_text(settings.read_text().replace('of = ["belt:Belt"]', f'of = ["{of}"]'))
    assert run(folder, "--engine", engine)["speed -"]["noticed_from"] == 50


@pytest.mark.parametrize("begins", ["super().__init__()", "vars(self).update(vars(Belt()))"])
def test_a_subclass_makes_the_world_to_its_end_before_that_is_disturbed(begins: str, tmp_path: Path) -> None:
    quick = f"""
        class Quick(Belt):
            def __init__(self):
                {begins}
                self.speed = 1.0
        """
    mission = FILES["mission.py"].replace("belt.Belt()", "belt.Quick()")
    half = SPEED.replace("[0.01, 10, 50]", "[50]")
    folder = project(tmp_path, half, **{"belt.py": FILES["belt.py"] + quick, "mission.py": mission})
    assert run(folder)["speed -"]["noticed_from"] == 50


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
@pytest.mark.parametrize("when", ["made", "1.5 s"])
def test_worlds_are_found_that_the_program_has_frozen(engine: str, when: str, tmp_path: Path) -> None:
    frozen = """
        import functools
        import gc

        import belt
        import mission
        import pytest

        made = belt.Belt()
        gc.freeze()


        @pytest.fixture(autouse=True)
        def always_the_same(monkeypatch):
            made.time, made.position = 0.0, 0.0
            monkeypatch.setattr(mission, "drive", functools.partial(mission.drive, on=made))
        """
    half = SPEED.replace("[0.01, 10, 50]", "[50]").replace("    more =", f'    when = "{when}"\n    more =')
    found = run(project(tmp_path, half, **{"conftest.py": frozen}), "--engine", engine)
    assert found["speed -"]["noticed_from"] == 50


def test_a_function_gets_names_and_options_and_says_what_is_not_there(tmp_path: Path) -> None:
    parameters = """
        [[tool.mutabot.world.parameter]]
        name = "load"
        apply = "belt:heavier"
        names = "{}"
        options = {{ share = 0.5 }}
        directions = ["+"]
        unit = "g"
        ladder = [100, 1000]
        """
    found = run(project(tmp_path / "there", parameters.format("sledge")))
    assert found["load +"]["ends"] == {"100": "suffered unseen", "1000": "noticed"}
    missing = run(project(tmp_path / "missing", parameters.format("cart")), code=3)["load +"]
    assert missing["sentence"] == "nothing is known of load: nothing is named 'cart'; there is: sledge"


def test_a_share_of_nothing_is_no_disturbance(tmp_path: Path) -> None:
    parameters = """
        [[tool.mutabot.world.parameter]]
        name = "slope"
        apply = "belt:steeper"
        change = "scale"
        directions = ["+"]
        ladder = [50]
        """
    steeper = """
        def steeper(belt, change, *, names, random):
            belt.slope = max(0.0, change(0.0))
        """
    folder = project(tmp_path, parameters, **{"belt.py": FILES["belt.py"] + steeper})
    said = "nothing is known of slope: what belt:steeper changes is the same with the change"
    assert run(folder, code=3)["slope +"]["sentence"] == said


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("ladder = [0.01, 10, 50]|ladder = [10, 5]", "the magnitudes of a ladder must rise"),
        ('path = "speed"|', "name what is changed, either by path or by apply"),
        ('change = "scale"|unit = "furlong"', "'furlong' is not a unit of disturbances"),
        ('change = "scale"|when = "soon"', "'soon' is not a moment of a disturbance"),
        ('change = "scale"|apply = "heavier"', "names nothing in a module"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(wrong: str, said: str, tmp_path: Path) -> None:
    before, _, after = wrong.partition("|")
    done = mutabot(None, project(tmp_path, SPEED.replace(before, after)), "list")
    assert done.returncode == USAGE
    assert said in done.stderr
    assert "world" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    folder = project(tmp_path, 'parameters = ["elsewhere:world.toml"]')
    done = mutabot(None, folder, "run")
    assert done.returncode == USAGE
    assert "there is no file 'world.toml' in a package 'elsewhere'" in done.stderr


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_a_world_in_a_process_below_the_tests_is_disturbed(engine: str, tmp_path: Path) -> None:
    below = {
        "belt.toml": 'clock = { tick = "belt:Belt.advance", unit = "s" }',
        "mission.py": """
            import subprocess
            import sys


            def drive(seconds):
                words = [sys.executable, "drive.py", str(seconds)]
                return float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
            """,
        "drive.py": """
            import sys

            import belt

            here = belt.Belt()
            while here.time < float(sys.argv[1]) - 0.05:
                here.advance()
            print(here.position)
            """,
    }
    folder = project(tmp_path, SPEED.replace("[0.01, 10, 50]", "[10, 50]"), **below)
    text = (folder / "pyproject.toml").read_text().replace('"mission.py"', '"mission.py", "drive.py"')
    (folder / "pyproject.toml").write_text(text)
    found = run(folder, "--engine", engine)
    assert found["speed +"]["noticed_from"] == 50


def test_a_file_for_a_library_that_is_not_installed_is_refused(tmp_path: Path) -> None:
    table = 'of = ["nowhere:World"]\n[[parameter]]\nname = "speed"\npath = "speed"\nladder = [1]\n'
    files = {"shipping/__init__.py": "", "shipping/world.toml": table}
    folder = project(tmp_path, 'parameters = ["shipping:world.toml"]', **files)
    done = mutabot(folder, folder, "check")
    assert done.returncode == USAGE
    assert "shipping:world.toml disturbs worlds of 'nowhere', which is not installed" in done.stderr


def test_a_table_without_a_parameter_says_how_to_get_some(tmp_path: Path) -> None:
    done = mutabot(None, project(tmp_path, ""), "run")
    assert done.returncode == NO_MUTANTS, done.stderr
    assert "the table `world` has no parameter; `mutabot init` proposes some" in done.stderr
