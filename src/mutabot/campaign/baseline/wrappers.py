"""Find functions of the program that only pass the arguments of their calls on to an operation.

The site in such a function is one for all of its calls, and a mutant acts on all of them at once: a test that
sees the first hides that none sees the last. Where the function itself is described, each call is a site.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from mutabot.languages.python import extent_of, head_size
from mutabot.model import Role, Vocabulary
from mutabot.model.events import Remark
from mutabot.model.source_units import FunctionNode

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline, Sources
    from mutabot.model.mutant import Extent


def shared_sites(
    baseline: Baseline, vocabulary: Vocabulary, sources: Sources, files: Iterable[str]
) -> Iterator[Remark]:
    """Yield remarks on sites inside such functions, saying what to describe in the vocabulary instead."""
    described = {operation.last_name for operation in vocabulary.operations}
    for place in baseline.hits:
        span, operation = place.site.span, vocabulary.operation(place.operation)
        name = span.function.rpartition(".")[2]
        if place.site.role is not Role.PROGRAM or operation is None or name in described:
            continue
        if not sources.is_among(span, passed_on):
            continue
        count = sum((sources.found_in(file, call_names) or {}).get(name, 0) for file in files)
        if count > 1:
            text = (
                f"{span.file}:{span.line} stands in {span.function}, which only passes on what {count} calls "
                "give it: a mutant there acts on all of them at once; to mutate each by itself, "
                f"describe {span.function} as an operation"
            )
            yield Remark(operation.source, "call", text)


def passed_on(source: str) -> frozenset[Extent]:
    """Return the calls that are the whole body of a function, with its own arguments only."""
    functions = (node for node in ast.walk(ast.parse(source)) if isinstance(node, FunctionNode))
    calls = ((_only_call(function), function) for function in functions)
    return frozenset(
        extent_of(call) for call, function in calls if call is not None and _fits(call, function)
    )


def call_names(source: str) -> Counter[str]:
    """Count the calls in a source by the last part of their names."""
    functions = (node.func for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    names = (getattr(function, "attr", None) or getattr(function, "id", None) for function in functions)
    return Counter(name for name in names if name is not None)


def _only_call(function: FunctionNode) -> ast.Call | None:
    body = function.body[head_size(function.body) :]
    value = body[0].value if len(body) == 1 and isinstance(body[0], ast.Expr | ast.Return) else None
    value = value.value if isinstance(value, ast.Await) else value
    return value if isinstance(value, ast.Call) else None


def _fits(call: ast.Call, function: FunctionNode) -> bool:
    """Return whether a call passes on arguments of the function, and otherwise only constants."""
    given = function.args
    own = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    names = {parameter.arg for parameter in own if parameter is not None} - {"self", "cls"}
    values = [*call.args, *(keyword.value for keyword in call.keywords)]
    plain = [value.value if isinstance(value, ast.Starred) else value for value in values]
    passed = [isinstance(expression, ast.Name) and expression.id in names for expression in plain]
    return any(passed) and all(
        is_own or isinstance(expression, ast.Constant)
        for is_own, expression in zip(passed, plain, strict=True)
    )
