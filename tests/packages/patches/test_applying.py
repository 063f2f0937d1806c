"""Patches are applied as git applies them, and what cannot be a mutant is named."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from mutabot_patches.changes import read_patch
from mutabot_patches.diffs import PatchError
from mutabot_patches.suite import FilesOfTests

LINES = "".join(f"line{n} = {n}\n" for n in range(1, 21))
HEAD = "--- a/x.py\n+++ b/x.py\n"
#: hunks that git and this package apply alike, to a file of these lines
ALIKE = {
    "one line": (LINES, "@@ -4,3 +4,3 @@\n line4 = 4\n-line5 = 5\n+line5 = 6\n line6 = 6\n"),
    "two hunks, the first longer": (
        LINES,
        "@@ -1,3 +1,5 @@\n line1 = 1\n+a = 1\n+b = 2\n line2 = 2\n line3 = 3\n"
        "@@ -15,3 +17,2 @@\n line15 = 15\n-line16 = 16\n line17 = 17\n",
    ),
    "three lines further down": (
        "x = 1\n" * 3 + LINES,
        "@@ -4,3 +4,3 @@\n line4 = 4\n-line5 = 5\n+y = 6\n line6 = 6\n",
    ),
    "two lines further up": (LINES, "@@ -6,3 +6,3 @@\n line4 = 4\n-line5 = 5\n+y = 6\n line6 = 6\n"),
    "the nearest of two places": (
        "a = 1\nb = 1\nc = 1\n" + LINES + "a = 1\nb = 1\nc = 1\nd = 4\n",
        "@@ -20,3 +20,3 @@\n a = 1\n-b = 1\n+b = 2\n c = 1\n",
    ),
    "the first line": (LINES, "@@ -1,2 +1,2 @@\n-line1 = 1\n+line1 = 2\n line2 = 2\n"),
    "the last line": (LINES, "@@ -19,2 +19,2 @@\n line19 = 19\n-line20 = 20\n+line20 = 2\n"),
    "lines at the end": (LINES, "@@ -19,2 +19,3 @@\n line19 = 19\n line20 = 20\n+z = 1\n"),
    "ends of CRLF": (
        LINES.replace("\n", "\r\n"),
        "@@ -4,3 +4,3 @@\n line4 = 4\r\n-line5 = 5\r\n+line5 = 6\r\n line6 = 6\r\n",
    ),
    "no end of the last line": (
        "a = 1\nb = 2",
        "@@ -1,2 +1,2 @@\n a = 1\n-b = 2\n\\ No newline at end of file\n"
        "+b = 3\n\\ No newline at end of file\n",
    ),
    "the last line gets an end": (
        "a = 1\nb = 2",
        "@@ -1,2 +1,2 @@\n a = 1\n-b = 2\n\\ No newline at end of file\n+b = 3\n",
    ),
    "an empty line of context without its space": (
        "a = 1\n\nb = 2\n",
        "@@ -1,3 +1,3 @@\n a = 1\n\n-b = 2\n+b = 3\n",
    ),
    "a line that begins with dashes": ("-- x\nb\n", "@@ -1,2 +1,2 @@\n--- x\n+++ x\n b\n"),
}
#: hunks that neither applies, and what is said
REFUSED = {
    "another line": (
        "@@ -4,3 +4,3 @@\n line4 = 4\n-line5 = 50\n+line5 = 6\n line6 = 6\n",
        "hunk 1 does not apply to x.py: line 5 was 'line5 = 50', and there is 'line5 = 5'",
    ),
    "the second hunk": (
        "@@ -1,2 +1,2 @@\n-line1 = 1\n+line1 = 2\n line2 = 2\n"
        "@@ -9,3 +9,3 @@\n line9 = 9\n-x = 1\n+x = 2\n line11 = 11\n",
        "hunk 2 does not apply to x.py: line 10 was 'x = 1', and there is 'line10 = 10'",
    ),
    "applied already": (
        "@@ -4,3 +4,3 @@\n line4 = 4\n-line5 = 6\n+line5 = 5\n line6 = 6\n",
        "hunk 1 does not apply to x.py: what it makes is there already",
    ),
    "ends of CRLF": (
        "@@ -4,3 +4,3 @@\r\n line4 = 4\r\n-line5 = 5\r\n+line5 = 6\r\n line6 = 6\r\n",
        "hunk 1 does not apply to x.py: its lines are there, but end otherwise (CRLF, LF, none) or stand "
        "elsewhere",
    ),
    "cut off": (
        "@@ -4,3 +4,3 @@\n line4 = 4\n-line5 = 5\n",
        "hunk 1 says 3 lines before and 3 after, and has others (line 6 of the patch)",
    ),
    "behind the end": (
        "@@ -40,3 +40,3 @@\n line40 = 4\n-line5 = 5\n+line5 = 6\n line6 = 6\n",
        "hunk 1 does not apply to x.py: line 40 was 'line40 = 4', and the file ends before",
    ),
}
#: whole patches that make no mutant, and what is said; any file is called as it says
NONE = {
    "empty": ("", "it is empty"),
    "text": ("Nothing to see here.\n", "it has no hunk, so that it changes nothing"),
    "the same": (
        HEAD + "@@ -1,1 +1,1 @@\n-line1 = 1\n+line1 = 1\n",
        "it changes nothing but comments and layout",
    ),
    "a comment": (
        HEAD + "@@ -1,2 +1,2 @@\n-line1 = 1\n+line1 = 1  # !\n line2 = 2\n",
        "it changes nothing but comments and layout",
    ),
    "no Python": (
        HEAD + "@@ -1,2 +1,2 @@\n-line1 = 1\n+line1 = (1\n line2 = 2\n",
        "x.py would no longer be valid Python: '(' was never closed, line 1",
    ),
    "binary": (
        "diff --git a/x.png b/x.png\nindex 1234567..89abcde 100644\n"
        "Binary files a/x.png and b/x.png differ\n",
        "x.png is binary: only lines of files can be changed",
    ),
    "a mode": (
        "diff --git a/x.py b/x.py\nold mode 100644\nnew mode 100755\n",
        "no line of x.py changes, at most its mode",
    ),
    "another name": (
        "diff --git a/x.py b/y.py\nsimilarity index 100%\nrename from x.py\nrename to y.py\n",
        "x.py is renamed: only lines of files can be changed",
    ),
    "deleted": (
        "--- a/y.py\n+++ /dev/null\n@@ -1,1 +0,0 @@\n-x = 1\n",
        "it deletes y.py: a mutant changes what files hold, and takes none away",
    ),
    "added, and there": (
        "--- /dev/null\n+++ b/y.py\n@@ -0,0 +1,1 @@\n+x = 1\n",
        "it adds y.py, which is there",
    ),
    "not there": (
        "--- a/z.py\n+++ b/z.py\n@@ -1,1 +1,1 @@\n-x = 1\n+x = 2\n",
        "hunk 1 does not apply: there is no file z.py",
    ),
    "elsewhere": (
        "--- a/../z.py\n+++ b/../z.py\n@@ -1,1 +1,1 @@\n-x = 1\n+x = 2\n",
        "../z.py is not a file of the project",
    ),
    "of the suite": (
        "--- a/conftest.py\n+++ b/conftest.py\n@@ -1,1 +1,1 @@\n-x = 1\n+x = 2\n",
        "conftest.py belongs to the tests, and a patch to these is no mutant of the program",
    ),
    "no name": (
        "@@ -1,1 +1,1 @@\n-x = 1\n+x = 2\n",
        "line 1 begins a hunk, and no lines --- and +++ name its file",
    ),
    "twice": (
        (HEAD + "@@ -1,2 +1,2 @@\n-line1 = 1\n+line1 = 2\n line2 = 2\n") * 2,
        "it changes x.py twice: join the hunks below one header",
    ),
}


def applied_by_git(folder: Path, patch: bytes) -> bool:
    """Whether git applies a patch to the files of a folder, which it changes then."""
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(folder.parent)}
    words = ["git", "apply", "-"]
    return subprocess.run(words, cwd=folder, env=environment, input=patch, check=False).returncode == 0


def why_none(folder: Path, patch: bytes) -> str:
    """What is said of a patch that makes no mutant."""
    with pytest.raises(PatchError) as told:
        read_patch(patch, folder, lambda name: name == "conftest.py")
    return str(told.value)


@pytest.mark.parametrize("name", ALIKE)
def test_a_patch_makes_what_git_makes(name: str, tmp_path: Path) -> None:
    before, hunks = ALIKE[name]
    (tmp_path / "x.txt").write_bytes(before.encode())
    patch = (HEAD.replace("x.py", "x.txt") + hunks).encode()
    (made,) = read_patch(patch, tmp_path, lambda _: False).files
    assert applied_by_git(tmp_path, patch)
    assert made.after == (tmp_path / "x.txt").read_bytes() != before.encode()


@pytest.mark.parametrize("name", REFUSED)
def test_a_hunk_that_does_not_apply_is_named(name: str, tmp_path: Path) -> None:
    hunks, said = REFUSED[name]
    (tmp_path / "x.py").write_text(LINES)
    assert why_none(tmp_path, (HEAD + hunks).encode()) == said
    assert not applied_by_git(tmp_path, (HEAD + hunks).encode())


@pytest.mark.parametrize("name", NONE)
def test_a_patch_that_makes_no_mutant_says_why(name: str, tmp_path: Path) -> None:
    (tmp_path / "x.py").write_text(LINES)
    for other in ("y.py", "conftest.py"):
        (tmp_path / other).write_text("x = 1\n")
    patch, said = NONE[name]
    assert why_none(tmp_path, patch.encode()) == said


def test_a_path_may_have_no_folder_before_it_or_stand_in_quotes(tmp_path: Path) -> None:
    (tmp_path / "ä.txt").write_text("a\nb\n")
    hunk = "@@ -1,2 +1,2 @@\n-a\n+A\n b\n"
    for head in (
        "--- ä.txt\t2026-01-01\n+++ ä.txt\t2026-01-02\n",
        '--- "a/\\303\\244.txt"\n+++ "b/\\303\\244.txt"\n',
    ):
        (made,) = read_patch((head + hunk).encode(), tmp_path, lambda _: False).files
        assert (made.path, made.after) == ("ä.txt", b"A\nb\n")


def test_where_hunks_stand_is_reported_for_the_file_as_it_is(tmp_path: Path) -> None:
    before, hunks = ALIKE["two hunks, the first longer"]
    (tmp_path / "x.py").write_text("# further down\n" + before)
    patch = read_patch((HEAD + hunks.replace("@@ -1,", "@@ -2,")).encode(), tmp_path, lambda _: False)
    assert patch.files[0].extents == ((2, 0, 2, 9), (17, 0, 17, 11))
    assert patch.notes == ("hunk 1 1 line further down", "hunk 2 1 line further down")


def test_a_file_of_the_program_with_doctests_is_none_of_the_suite() -> None:
    files = FilesOfTests(["mission.py::mission.go", "tests/test_go.py::test_go"], ["mission.py"])
    found = ["mission.py", "tests/test_go.py", "tests/data/go.json", "robot.py", "cell/conftest.py"]
    assert [files.has(path) for path in found] == [False, True, True, False, True]
