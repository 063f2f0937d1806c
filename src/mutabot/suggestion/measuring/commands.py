"""The commands of a robot API as a test can watch them: where the program looks them up."""

from __future__ import annotations

import ast

from mutabot.suggestion.sources.project import Project

#: module, class (empty for what the module has itself) and name
Command = tuple[str, str, str]


def commands_of(project: Project) -> list[Command]:
    """The vocabulary's commands; functions also under the names that the program imports them by."""
    found: dict[Command, None] = {}
    for operation in project.request.vocabulary.operations:
        if operation.command and operation.named is None and operation.kind is None:
            owner, _, name = operation.qualname.rpartition(".")
            found[operation.module, owner, name] = None
            if not owner:
                found.update(dict.fromkeys(_imported(project, operation.module, name)))
    return list(found)


def _imported(project: Project, module: str, name: str) -> list[Command]:
    found = []
    for file in project.python_files(project.request.configuration.program):
        tree = project.module(file)
        for node in tree.body if tree is not None else ():
            if isinstance(node, ast.ImportFrom) and node.module == module and not node.level:
                names = [alias.asname or alias.name for alias in node.names if alias.name == name]
                found += [(project.import_name(file), "", one) for one in names]
    return found
