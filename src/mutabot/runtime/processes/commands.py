"""Read from the command of a program that is about to start what it means for a campaign.

A shell, ``make``, or what runs the command that it is given (``env``, ``sudo``), may start Python in turn,
also from a script: its text is read as well. What a program reads in files of another kind is not known.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise, takewhile
from shutil import which
from typing import Any

from mutabot.model.event_file import VARIABLE
from mutabot.model.files import read_file

#: audit events of the start of a program; the last is our own: ``multiprocessing`` makes none
STARTS = ("os.system", "subprocess.Popen", "os.posix_spawn", "os.exec", "mutabot.fork_exec")
#: the folder of the start-up module
STARTUP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "startup")
_SHELLS = {"sh", "bash", "dash", "zsh", "ksh"}
#: programs that run a command that they are given
_RUNNERS = {
    *_SHELLS, "env", "sudo", "nice", "nohup", "setsid", "xargs", "timeout", "stdbuf", "flock", "time",
    "xvfb-run",
}  # fmt: skip
#: programs that end others: with ``timeout`` and the launchers of ROS, which end what they have started
_KILLERS = {
    "kill", "pkill", "killall", "skill", "fuser", "timeout", "rosnode", "roslaunch", "rostest", "ros2",
}  # fmt: skip
_KILLER_IN_TEXT = re.compile(rf"(?<![\w.-])(?:{'|'.join(sorted(_KILLERS))})(?![\w.-])")
#: between the words of a command, which a shell may read
_BETWEEN_WORDS = re.compile(r"[\s;|&<>()='\"`]+")
#: also as a shell's or make's variable
_PYTHON = re.compile(r"python[\d.]*[dt]?|\$?\{?PY(THON)?[23]?\}?")
#: options of Python by which it leaves out the environment, or what is loaded at its start
_APART = "IES"
#: options of Python that take a value; after the latter two, all else is for the program
_WITH_VALUE = "WXcm"
#: names in the environment without which no Python joins a campaign
_NEEDED = ("PYTHONPATH", VARIABLE)
_CLEARS = ("-", "-i", "--ignore-environment")
_SETS_PATH = re.compile(rf"(?<![\w$])PYTHONPATH=(?!\S*(?:\$\{{?PYTHONPATH\b|{re.escape(STARTUP)}))")
_MAKES = {"make", "gmake"}
_MAKEFILES = ("GNUmakefile", "makefile", "Makefile")
#: bytes of a script that are looked at
_MOST = 65536


def command_of(event: str, arguments: tuple[Any, ...]) -> list[str]:
    """Return the words of the command that an audit event starts; none if they make no sense."""
    if event not in STARTS:
        return []
    if event == "os.system":
        return ["sh", "-c", os.fsdecode(arguments[0])]
    executable, command = arguments[:2]
    try:
        given = [command] if isinstance(command, str | bytes | os.PathLike) else list(command)
        words = [os.fsdecode(word) for word in given]
        return [os.fsdecode(executable), *words[1:]] if executable is not None else words
    except TypeError:  # it will not start either
        return []


def texts_of(event: str, arguments: tuple[Any, ...]) -> list[str]:
    """Return the words of a command, and the texts of the shell's scripts and of the makefiles among them."""
    words, folder = command_of(event, arguments), folder_of(event, arguments)
    return [*words, *_scripts(words, folder), *_makefiles(words, folder)]


def folder_of(event: str, arguments: tuple[Any, ...]) -> str:
    """Return the folder in which a command runs."""
    return os.fsdecode((arguments[2] if event == "subprocess.Popen" else None) or ".")


def words_in(texts: Sequence[str]) -> list[str]:
    """Return the words in texts that a shell may read."""
    return [word for text in texts for word in _BETWEEN_WORDS.split(text) if word]


def is_python(word: str) -> bool:
    """Return whether a word of a command starts Python."""
    return _PYTHON.fullmatch(os.path.basename(word)) is not None


def starts_a_killer(event: str, arguments: tuple[Any, ...]) -> bool:
    """Return whether an audit event starts a program that may end others, directly or by a shell.

    It cannot be known from outside which processes such a program ends.
    """
    words = command_of(event, arguments)
    name = os.path.basename(words[0]) if words else ""
    return name in _KILLERS or (name in _RUNNERS and any(map(_KILLER_IN_TEXT.search, words)))


def why_unseen(event: str, arguments: tuple[Any, ...]) -> str | None:
    """Return why a Python process that is being started cannot join the campaign; None if it can."""
    texts = texts_of(event, arguments)
    if texts and is_python(texts[0]):
        options = _options(texts[1:])
    else:
        is_read = len(texts) > len(command_of(event, arguments))  # a script is, or a makefile
        words = words_in(texts) if is_read or (texts and os.path.basename(texts[0]) in _RUNNERS) else []
        pythons = [index for index, word in enumerate(words) if is_python(word)]
        if not pythons:
            return None
        if (why := _why_without_environment(" ".join(texts), words)) is not None:
            return why
        options = "".join(_options(words[index + 1 :]) for index in pythons)
    apart = next((option for option in options if option in _APART), None)
    if apart is not None:
        return f"the option -{apart} isolates it"
    environment = arguments[2] if event in ("os.posix_spawn", "os.exec") else None
    if environment is None:
        return None
    given = {os.fsencode(name): os.fsencode(value) for name, value in environment.items()}
    path = os.fsdecode(given.get(b"PYTHONPATH", b"")).split(os.pathsep)
    if os.fsencode(VARIABLE) in given and STARTUP in path:
        return None
    return f"its environment lacks PYTHONPATH and {VARIABLE}: hand them on, they are in os.environ"


def _options(words: Sequence[str]) -> str:
    """Return the letters of the options of Python with which a command goes on."""
    found, is_value = "", False
    for word in words:
        if is_value:
            is_value = False
            continue
        if not word.startswith("-") or word == "-":
            break
        if word.startswith("--"):
            is_value = word == "--check-hash-based-pycs"
            continue
        letters = word[1:]
        end = next((index for index, letter in enumerate(letters) if letter in _WITH_VALUE), len(letters))
        found += letters[:end]
        if letters[end:] and letters[end] in "cm":
            break
        is_value = len(letters[end:]) == 1
    return found


def _why_without_environment(text: str, words: Sequence[str]) -> str | None:
    """Return why a command that a shell reads gives Python another environment."""
    if _SETS_PATH.search(text):
        return "the command sets PYTHONPATH: write PYTHONPATH=…:$PYTHONPATH"
    if any(first == "unset" and second in _NEEDED for first, second in pairwise(words)):
        return "the command unsets its environment"
    for index, word in enumerate(words):
        name = os.path.basename(word)
        if name == "env" and _clears(words[index + 1 :]):
            return "env clears its environment"
        if name == "sudo" and not {"-E", "--preserve-env"} & {*words[index + 1 :]}:
            return "sudo clears its environment"
    return None


def _clears(words: Sequence[str]) -> bool:
    """Return whether options of ``env`` leave out what a Python needs to join."""
    options = list(takewhile(lambda word: word.startswith("-") or word in _NEEDED, words))
    return not {*options}.isdisjoint((*_CLEARS, *_NEEDED, *(f"-u{name}" for name in _NEEDED)))


def _scripts(words: Sequence[str], folder: str) -> Iterator[str]:
    """Yield the texts of the scripts that a shell reads, and the first lines of those of other programs."""
    for path, is_read in scripts_named(words, folder):
        yield from _script(path, is_read)


def scripts_named(words: Sequence[str], folder: str) -> Iterator[tuple[str, bool]]:
    """Yield the paths of what may be scripts in a command, and whether a shell reads it, or it is begun."""
    is_read = False
    may_begin = len(words) if words and os.path.basename(words[0]) in _RUNNERS else 1
    for number, word in enumerate(words_in(words)):
        if word.startswith("-"):
            is_read = is_read and word != "-c"
            continue
        if is_read or ("/" in word and not is_python(word)):
            yield os.path.realpath(os.path.join(folder, word)), is_read
        elif number < may_begin and "/" not in word and (found := which(word)):
            yield os.path.realpath(found), False
        is_read = os.path.basename(word) in _SHELLS


def _makefiles(words: Sequence[str], folder: str) -> Iterator[str]:
    """Yield the texts of the files that ``make`` reads; of all targets, as the names of some are made."""
    if not any(os.path.basename(word) in _MAKES for word in words_in(words[:3])):
        return
    folder = next((os.path.join(folder, to) for option, to in pairwise(words) if option == "-C"), folder)
    given = [file for option, file in pairwise(words) if option == "-f"]
    for name in given or _MAKEFILES:
        try:
            yield read_file(os.path.join(folder, name), _MOST).decode("utf-8", "replace")
        except (OSError, ValueError):
            continue


def _script(path: str, is_read: bool) -> Iterator[str]:
    try:
        if read_file(path, 2) != b"#!" and not is_read:
            return
        text = read_file(path, _MOST).decode("utf-8", "replace")
    except (OSError, ValueError):
        return
    line = text.removeprefix("#!").partition("\n")[0]
    is_of_shell = is_read or not {*map(os.path.basename, line.split())}.isdisjoint(_SHELLS)
    yield text if is_of_shell else line
