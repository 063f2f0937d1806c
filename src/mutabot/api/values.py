"""What operators and middlewares work on: operations, their quantities, and calls of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.model.call import Call, Proceed, Reply
    from mutabot.model.operation import Operation, Pattern
    from mutabot.model.quantity import Kind, Mode, Quantity

__all__ = [
    "Call",
    "Kind",
    "Mode",
    "Operation",
    "Pattern",
    "Proceed",
    "Quantity",
    "Reply",
]
_HOMES = {
    "mutabot.model.call": (
        "Call",
        "Proceed",
        "Reply",
    ),
    "mutabot.model.operation": (
        "Operation",
        "Pattern",
    ),
    "mutabot.model.quantity": (
        "Kind",
        "Mode",
        "Quantity",
    ),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
