"""What operators and middlewares work on: operations, their quantities, and calls of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.config.vocabulary.load import load_vocabulary, shipped_vocabularies
    from mutabot.model.call import Call, CallFault, Proceed, Reply
    from mutabot.model.operation import Form, Operation, Vocabulary
    from mutabot.model.path import Path
    from mutabot.model.quantity import Kind, Mode, Quantity, Value
    from mutabot.model.signature import parse_signature
    from mutabot.runtime.targets.target import Finding, MiddlewareControls, Names, Where, resolve

__all__ = [
    "Call",
    "CallFault",
    "Finding",
    "Form",
    "Kind",
    "MiddlewareControls",
    "Mode",
    "Names",
    "Operation",
    "Path",
    "Proceed",
    "Quantity",
    "Reply",
    "Value",
    "Vocabulary",
    "Where",
    "load_vocabulary",
    "parse_signature",
    "resolve",
    "shipped_vocabularies",
]
_HOMES = {
    "mutabot.config.vocabulary.load": (
        "load_vocabulary",
        "shipped_vocabularies",
    ),
    "mutabot.model.call": (
        "Call",
        "CallFault",
        "Proceed",
        "Reply",
    ),
    "mutabot.model.operation": (
        "Form",
        "Operation",
        "Vocabulary",
    ),
    "mutabot.model.path": ("Path",),
    "mutabot.model.quantity": (
        "Kind",
        "Mode",
        "Quantity",
        "Value",
    ),
    "mutabot.model.signature": ("parse_signature",),
    "mutabot.runtime.targets.target": (
        "Finding",
        "MiddlewareControls",
        "Names",
        "Where",
        "resolve",
    ),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
