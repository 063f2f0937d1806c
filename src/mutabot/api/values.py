"""The interface for operators and middlewares: operations, their quantities, and calls of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.config.vocabulary.load import load_vocabulary as load_vocabulary
    from mutabot.config.vocabulary.load import shipped_vocabularies as shipped_vocabularies
    from mutabot.model.call import Call as Call
    from mutabot.model.call import CallFault as CallFault
    from mutabot.model.call import Proceed as Proceed
    from mutabot.model.call import Reply as Reply
    from mutabot.model.operation import Form as Form
    from mutabot.model.operation import Operation as Operation
    from mutabot.model.operation import Vocabulary as Vocabulary
    from mutabot.model.path import Path as Path
    from mutabot.model.quantity import Kind as Kind
    from mutabot.model.quantity import Mode as Mode
    from mutabot.model.quantity import Quantity as Quantity
    from mutabot.model.signature import parse_signature as parse_signature
    from mutabot.runtime.targets.target import Finding as Finding
    from mutabot.runtime.targets.target import MiddlewareControls as MiddlewareControls
    from mutabot.runtime.targets.target import Names as Names
    from mutabot.runtime.targets.target import Where as Where
    from mutabot.runtime.targets.target import resolve as resolve

_HOMES = {
    "mutabot.config.vocabulary.load": ("load_vocabulary", "shipped_vocabularies"),
    "mutabot.model.call": ("Call", "CallFault", "Proceed", "Reply"),
    "mutabot.model.operation": ("Form", "Operation", "Vocabulary"),
    "mutabot.model.path": ("Path",),
    "mutabot.model.quantity": ("Kind", "Mode", "Quantity"),
    "mutabot.model.signature": ("parse_signature",),
    "mutabot.runtime.targets.target": ("Finding", "MiddlewareControls", "Names", "Where", "resolve"),
}
__getattr__ = lazily(__name__, _HOMES)
