"""unittest: methods of ``TestCase`` classes."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import Insertion

from .functions import STYLE as PYTEST
from .functions import at_ends
from .style import Addition, Place, class_of


class _TestCases:
    name = "unittest"
    order = 10

    def place(self, project: Project, node: str) -> Place | None:
        file, *path = node.split("::")
        module = project.module(file)
        if module is None or len(path) != 2 or not _is_test_case(module, path[0]):
            return None
        found = PYTEST.place(project, node)
        return Place(self.name, file, node, found.names) if found is not None else None

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        return at_ends(project, additions, fixtures=False)

    def within(self, text: str, value: str, tolerance: str) -> str:
        return f"self.assertAlmostEqual({text}, {value}, delta={tolerance})"

    def equal(self, text: str, value: str) -> str:
        plain = {
            "True": f"self.assertTrue({text})",
            "False": f"self.assertFalse({text})",
            "None": f"self.assertIsNone({text})",
        }
        return plain.get(value, f"self.assertEqual({text}, {value})")

    def needs(self, line: str) -> tuple[str, ...]:
        return ()


def _is_test_case(module: ast.Module, name: str, depth: int = 5) -> bool:
    owner = class_of(module, name)
    bases = [ast.unparse(one) for one in owner.bases] if owner is not None else []
    return any(
        base.endswith("TestCase") or (depth > 0 and _is_test_case(module, base, depth - 1)) for base in bases
    )


STYLE = _TestCases()
