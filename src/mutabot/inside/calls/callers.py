"""The robot is called by the program: what looks at its caller finds the program's line.

Warnings with ``stacklevel=2``, ``sys._getframe(1)`` and ``inspect.stack()[1]`` tell by whom a function was
called. Between the program and an operation there are frames of ours; the last of them has the program's
file, line, function and global names.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import CodeType, FrameType, FunctionType
from typing import Any

Caller = Callable[[Callable[..., Any], tuple[Any, ...], dict[str, Any]], Any]

_PLAIN = "def call(wrapped, args, kwargs, __tracebackhide__=True): return wrapped(*args, **kwargs)"
_ASYNC = f"async {_PLAIN}".replace("return", "return await")


class Callers:
    """Makes calls in the name of frames."""

    def __init__(self) -> None:
        # the code is kept, so that no other can get its address
        self._made: dict[tuple[int, int, bool], tuple[Caller, CodeType, dict[str, Any]]] = {}

    def of(self, frame: FrameType, is_async: bool) -> Caller:
        """What makes a call as if this frame did, where it stands now."""
        code = frame.f_code
        key = (id(code), frame.f_lasti, is_async)
        known = self._made.get(key)
        if known is None or known[2] is not frame.f_globals:
            made = _made(code, frame.f_lasti, frame.f_globals, is_async)
            known = self._made[key] = (made, code, frame.f_globals)
        return known[0]


def _made(code: CodeType, instruction: int, names: dict[str, Any], is_async: bool) -> Caller:
    line, end_line, column, end_column = list(code.co_positions())[instruction // 2]
    tree = ast.parse(_ASYNC if is_async else _PLAIN)
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt | ast.expr | ast.arg | ast.keyword):
            node.lineno = line or code.co_firstlineno
            node.end_lineno = end_line or node.lineno
            node.col_offset, node.end_col_offset = column or 0, end_column or 0
    module = compile(tree, code.co_filename, "exec", dont_inherit=True)
    own = next(one for one in module.co_consts if isinstance(one, CodeType))
    own = own.replace(co_name=code.co_name, co_qualname=code.co_qualname)
    return FunctionType(own, names, code.co_name, (True,))
