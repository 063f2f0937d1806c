"""What operators and middlewares work on: operations, their quantities, and calls of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.model.call import Call, CallFault, Proceed, Reply
    from mutabot.model.operation import Form, Operation
    from mutabot.model.path import Path
    from mutabot.model.quantity import Kind, Mode, Quantity, Value

__all__ = [
    "Call",
    "CallFault",
    "Form",
    "Kind",
    "Mode",
    "Operation",
    "Path",
    "Proceed",
    "Quantity",
    "Reply",
    "Value",
]
_HOMES = {
    "mutabot.model.call": (
        "Call",
        "CallFault",
        "Proceed",
        "Reply",
    ),
    "mutabot.model.operation": (
        "Form",
        "Operation",
    ),
    "mutabot.model.path": ("Path",),
    "mutabot.model.quantity": (
        "Kind",
        "Mode",
        "Quantity",
        "Value",
    ),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
