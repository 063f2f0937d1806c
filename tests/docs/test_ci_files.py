"""The files that users copy for their CI: they are YAML, and their steps do what they say in a clone."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer.main
from tests.campaign.project import write_project

import pages
from mutabot.cli.app import app
from mutabot.journal.journal import Journal
from mutabot.results.results import read_results

yaml: Any = pytest.importorskip("yaml")

MISSION = """
    def fetch(arm):
        arm.move_by(0.5)
        arm.move_by(-0.25)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_fetch():
        arm = Arm()
        mission.fetch(arm)
        assert arm.x == 0.25
"""


def loaded(name: str) -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load((pages.ROOT / "ci" / name).read_text(encoding="utf-8"))
    return found


def jobs_of_github() -> dict[str, Any]:
    found: dict[str, Any] = loaded("github.yml")["jobs"]
    return found


def steps_of(job: dict[str, Any], action: str) -> list[dict[str, Any]]:
    return [step for step in job["steps"] if step.get("uses", "").startswith(action)]


def test_the_workflow_has_a_job_for_changes_and_jobs_in_parts() -> None:
    jobs = jobs_of_github()
    assert jobs.keys() == {"change", "shard", "merge", "publish"}
    number = len(jobs["shard"]["strategy"]["matrix"]["shard"])
    scripts = [step["run"] for step in jobs["shard"]["steps"] if step.get("name") == "Run"]
    assert f"/{number}" in scripts[0]
    assert jobs["merge"]["needs"] == "shard"


def test_the_journal_is_fetched_from_where_it_is_kept() -> None:
    caches = [step["with"] for job in jobs_of_github().values() for step in steps_of(job, "actions/cache/")]
    assert len(caches) == 3
    assert {cache["path"] for cache in caches} == {"${{ runner.temp }}/mutabot-main"}
    assert {cache["key"].partition("$")[0] for cache in caches} == {"mutabot-main-"}
    file = loaded("gitlab.yml")
    jobs = [file[name] for name in ("mutants", "merge")]
    assert {job["cache"]["policy"] for job in jobs} == {"pull", "push"}
    kept = {(job["cache"]["key"], *job["cache"]["paths"]) for job in jobs}
    assert kept == {("mutabot-main", ".mutabot/journal.sqlite", ".mutabot/journal-evidence.sqlite")}
    assert set(jobs[1]["cache"]["paths"]) < set(jobs[1]["artifacts"]["paths"])


def test_strangers_pull_requests_have_no_rights() -> None:
    file = loaded("github.yml")
    assert set(file[True]) == {"pull_request", "push", "workflow_dispatch"}  # YAML reads `on` as true
    assert file["permissions"] == {"contents": "read"}
    jobs = jobs_of_github()
    assert {name for name, job in jobs.items() if "permissions" in job} == {"publish"}
    assert not [step for step in jobs["publish"]["steps"] if "run" in step]
    assert not steps_of(jobs["publish"], "actions/checkout")
    assert "head.repo.full_name == github.repository" in jobs["publish"]["if"]
    for name in ("github.yml", "gitlab.yml"):
        text = "\n".join(
            line for line in (pages.ROOT / "ci" / name).read_text().splitlines() if "# never" not in line
        )
        assert "pull_request_target" not in text
        assert "workflow_run" not in text
        assert not re.search(r"secrets\.|TOKEN(?!: \$CI_JOB_TOKEN)(?!\")", text)


def test_the_checkout_keeps_no_credentials() -> None:
    found = [step for job in jobs_of_github().values() for step in steps_of(job, "actions/checkout@")]
    assert len(found) == 3
    assert all(step["with"]["persist-credentials"] is False for step in found)


def test_actions_are_named_by_their_commit_with_the_version_beside() -> None:
    lines = (pages.ROOT / "ci" / "github.yml").read_text().splitlines()
    used = [line.strip(" -") for line in lines if "uses:" in line]
    assert len(used) > 10
    wrong = [
        line for line in used if not re.fullmatch(r"uses: [\w./-]+@[0-9a-f]{40}  # v\d+\.\d+\.\d+", line)
    ]
    assert wrong == []
    assert len(set(used)) == len({line.partition("@")[0] for line in used})


def test_nothing_that_others_choose_is_pasted_into_a_script() -> None:
    scripts = [step["run"] for job in jobs_of_github().values() for step in job["steps"] if "run" in step]
    assert scripts
    assert not [script for script in scripts if "${{" in script]


def test_only_main_writes_what_others_read() -> None:
    jobs = jobs_of_github()
    writers = {name for name, job in jobs.items() for step in steps_of(job, "actions/cache/save@")}
    assert writers == {"merge"}
    assert not [job for job in jobs.values() for step in steps_of(job, "actions/cache@")]  # it would save
    assert "default_branch" in jobs["shard"]["if"]
    assert "needs.shard.result != 'skipped'" in jobs["merge"]["if"]
    file = loaded("gitlab.yml")
    assert file["mutants of the change"]["cache"] == []
    for name in ("mutants", "merge"):
        assert file[name]["cache"]["unprotect"] is False
        (rule,) = file[name]["rules"]
        assert '$CI_COMMIT_BRANCH == $CI_DEFAULT_BRANCH && $CI_COMMIT_REF_PROTECTED == "true"' in rule["if"]


def test_what_is_believed_lies_where_no_commit_can_put_a_file() -> None:
    for job in jobs_of_github().values():
        for step in (*steps_of(job, "actions/cache/"), *steps_of(job, "actions/download-artifact@")):
            path = step["with"].get("path", "")
            assert path.startswith("${{ runner.temp }}/") or step["with"].get("name") == "mutabot-sarif"
    for name in ("github.yml", "gitlab.yml"):
        text = (pages.ROOT / "ci" / name).read_text()
        named = re.findall(r'--journal "?(\$\w+)', text)
        assert named == ["$RUNNER_TEMP" if name == "github.yml" else "$MAIN"]


def test_mutabot_comes_from_no_index() -> None:
    files = loaded("github.yml")["env"], loaded("gitlab.yml")[".mutabot"]["variables"]
    for given in files:
        assert re.fullmatch(r"git\+https://[\w.-]+\.invalid/[\w./-]+@[0-9a-f]{40}", given["MUTABOT"])


def options_of(name: str) -> set[str]:
    """The options of a command of ours."""
    command = typer.main.get_command(app).commands[name]  # type: ignore[attr-defined]
    return {option for parameter in command.params for option in parameter.opts}


class Site:
    """A repository, and a place where jobs run in clones of it."""

    def __init__(self, home: Path) -> None:
        self.home, self.origin, self.programs = home, home / "origin", home / "bin"
        write_project(self.origin, MISSION, TESTS, more={"requirements.txt": "", ".gitignore": ".mutabot/"})
        self.programs.mkdir()
        self._program("pip", "true")
        self._program("mutabot", f'exec {sys.executable} -m mutabot.cli.app "$@"')
        self.git("init", "-q", "-b", "main")
        self.git("add", "-A")
        self.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "first")

    def _program(self, name: str, text: str) -> None:
        path = self.programs / name
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)

    def git(self, *words: str) -> str:
        done = subprocess.run(["git", *words], cwd=self.origin, check=True, capture_output=True, text=True)
        return done.stdout.strip()

    def clone(self, name: str) -> Path:
        folder = self.home / name
        self.git("clone", "-q", str(self.origin), str(folder))
        return folder

    def run(self, script: str, folder: Path, **environment: str) -> None:
        """Run a script as runners do. Fails with what it printed."""
        path = f"{self.programs}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", script], cwd=folder, capture_output=True, text=True,
            env={**os.environ, **environment, "PATH": path}, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{script}\n{done.stdout}\n{done.stderr}"


def steps_of_github(site: Site, job: dict[str, Any], folder: Path, *, base: str = "", **matrix: str) -> None:
    """Run the steps of a job; what other actions do is done here by copying files."""
    store, said = site.home / "stored", site.home / "summary.md"
    temp = site.home / f"temp-of-{folder.name}"
    temp.mkdir()

    def filled(text: str) -> str:
        known = {"github.sha": "abc", "github.event.pull_request.base.sha": base, "runner.temp": str(temp)}
        known.update((f"matrix.{name}", value) for name, value in matrix.items())
        return re.sub(r"\$\{\{ *([^} ]+) *\}\}", lambda found: known[found[1]], text)

    for step in job["steps"]:
        action, given = step.get("uses", ""), step.get("with", {})
        if "run" in step:
            given = {**loaded("github.yml")["env"], **step.get("env", {})}
            environment = {name: filled(str(value)) for name, value in given.items()}
            known = {"GITHUB_STEP_SUMMARY": str(said), "RUNNER_TEMP": str(temp)}
            site.run(step["run"], folder, **known, **environment)
        elif action.startswith("actions/upload-artifact"):
            paths = [Path(path) for path in filled(given["path"]).split()]
            files = [found_path for path in paths for found_path in (folder / path.parent).glob(path.name)]
            assert files
            for file in files:
                to = store / filled(given["name"]) / file.name
                to.parent.mkdir(parents=True, exist_ok=True)
                shutil.copytree(file, to) if file.is_dir() else shutil.copy(file, to)
        elif action.startswith("actions/download-artifact"):
            for source in store.glob(given["pattern"]):
                shutil.copytree(source, Path(filled(given["path"])) / source.name)
        elif action.startswith("actions/cache/save"):
            shutil.copytree(filled(given["path"]), store / "cache")
        elif action.startswith("actions/cache/restore") and (store / "cache").is_dir():
            shutil.copytree(store / "cache", filled(given["path"]))
    if (folder / "mutants.sarif").exists():
        assert json.loads((folder / "mutants.sarif").read_text())["version"] == "2.1.0"


@pytest.mark.whole
def test_the_workflow_runs_in_parts_and_goes_on_from_its_journal(tmp_path: Path) -> None:
    site, jobs = Site(tmp_path), loaded("github.yml")["jobs"]
    for number in jobs["shard"]["strategy"]["matrix"]["shard"]:
        steps_of_github(site, jobs["shard"], site.clone(f"shard-{number}"), shard=str(number))
    steps_of_github(site, jobs["merge"], site.clone("merge"))
    with Journal.open(tmp_path / "merge" / ".mutabot" / "journal.sqlite") as journal:
        found = read_results(journal)
    assert found.state == "complete"
    assert found.done == found.planned > 0
    assert "## Mutation testing" in (tmp_path / "summary.md").read_text()
    again = site.clone("again")
    steps_of_github(site, jobs["shard"], again, shard="1")
    with Journal.open(again / ".mutabot" / "journal.sqlite") as journal:
        assert len(journal.reused()) == len(journal.outcomes()) > 0

    base = site.git("rev-parse", "HEAD")
    mission = site.origin / "mission.py"
    mission.write_text(mission.read_text().replace("-0.25", "-0.125"))
    test = site.origin / "tests" / "test_mission.py"
    test.write_text(test.read_text().replace("0.25", "0.375"))
    site.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qam", "second")
    change = site.clone("change")
    steps_of_github(site, jobs["change"], change, base=base)
    with Journal.open(change / ".mutabot" / "journal.sqlite") as journal:
        assert read_results(journal).done


@pytest.mark.whole
def test_the_jobs_of_gitlab_run_in_parts(tmp_path: Path) -> None:
    site, file = Site(tmp_path), loaded("gitlab.yml")
    kept = tmp_path / "artifacts"
    number = file["mutants"]["parallel"]
    for index in range(1, number + 1):
        folder = site.clone(f"node-{index}")
        environment = {"CI_NODE_INDEX": str(index), "CI_NODE_TOTAL": str(number)}
        for part in ("script", "after_script"):
            site.run("\n".join(file["mutants"][part]), folder, **environment)
        shutil.copytree(folder / ".mutabot" / "shards", kept, dirs_exist_ok=True)
    folder = site.clone("merge")
    shutil.copytree(kept, folder / ".mutabot" / "shards")
    for part in ("script", "after_script"):
        site.run("\n".join(file["merge"][part]), folder)
    for path in file["merge"]["artifacts"]["paths"]:
        assert (folder / path).exists()
    with Journal.open(folder / ".mutabot" / "journal.sqlite") as journal:
        assert read_results(journal).state == "complete"

    packed = shutil.make_archive(str(tmp_path / "main"), "zip", folder, ".mutabot/journal.sqlite")
    site._program(
        "curl", f'for word; do case "$before" in --output) cp {packed} "$word";; esac; before=$word; done'
    )
    site._program("python", f'exec {sys.executable} "$@"')
    change = site.clone("change")
    variables = {"CI_MERGE_REQUEST_DIFF_BASE_SHA": site.git("rev-parse", "HEAD"), "CI_DEFAULT_BRANCH": "main"}
    site.run("\n".join(file["mutants of the change"]["script"]), change, **variables)
    with Journal.open(change / ".mutabot" / "journal.sqlite") as journal:
        assert len(journal.reused()) == len(journal.outcomes()) > 0
