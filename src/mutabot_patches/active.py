"""A patch in the test processes."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping
from pathlib import Path
from random import Random
from types import CodeType, FunctionType
from typing import Any, ClassVar

from mutabot.api.faults import ActiveFault

from .functions import codes_of


class PatchedFiles(ActiveFault):
    """The project's files after a patch, and loaded functions with the code of these files.

    ``data``: the new contents by path, in Latin-1, and by path the functions to change in a process that has
    imported the file: qualified name, first line before and after.
    """

    is_of_text: ClassVar[bool] = True

    def prepare_process(self) -> None:
        """Change the files; in a forked process, the loaded functions as well."""
        contents = {path: text.encode("latin-1") for path, text in self.data["files"].items()}
        for path, content in contents.items():
            self.context.change_file(path, content)
        for path, functions in self.data["functions"].items():
            if functions:
                _update_functions(path, contents[path], functions)
        self.acts()  # whatever is imported from here on has the patch

    def start_test(self, test: str, random: Random) -> None:
        """Note that the patch is active."""
        self.acts()

    def end_test(self) -> None:
        """Do nothing: the patch is active from the first test to the last."""


def _update_functions(path: str, content: bytes, functions: list[list[Any]]) -> None:
    """Give the loaded functions of a file the code that the file has now."""
    wanted = {(name, old): (name, new) for name, old, new in functions}
    codes = dict[str, Mapping[tuple[str, int], CodeType]]()
    for function in list(_functions_of(path)):
        file = function.__code__.co_filename
        key = wanted.get((function.__code__.co_qualname, function.__code__.co_firstlineno))
        if key is None:
            continue
        if file not in codes:
            codes[file] = _codes_in(file, content)
        if key in codes[file]:
            function.__code__ = codes[file][key]


def _functions_of(path: str) -> Iterator[FunctionType]:
    gc.unfreeze()  # what the program has frozen is in no list; to freeze more than it did would keep garbage
    for object_ in gc.get_objects():
        if type(object_) is FunctionType and object_.__code__.co_filename.endswith(path):
            yield object_


def _codes_in(file: str, content: bytes) -> Mapping[tuple[str, int], CodeType]:
    """Return the code of a file by qualified name and first line; empty if its content is another one."""
    try:
        if Path(file).read_bytes() != content:
            return {}
    except OSError:
        return {}
    module = compile(content, file, "exec", dont_inherit=True)
    return {(code.co_qualname, code.co_firstlineno): code for code in codes_of(module)}
