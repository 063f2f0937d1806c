"""Paths into arguments and results: attribute, index, key and slice; and the names of classes.

    .pose.x      attribute of an attribute
    [0]          index
    ["gap"]      key
    [3:6]        slice: the values of several elements at once
    target[0].z  the same, starting at an argument's name

Replacing a value copies what lies on the way and leaves the original object untouched.
"""

from __future__ import annotations

import ast
import copy
import re
from array import array
from collections.abc import Iterator
from dataclasses import fields as dataclass_fields
from dataclasses import is_dataclass
from typing import Any

from mutabot.errors import PathError, StrangeValueError, error_text, nearest_name, text_of
from mutabot.frozen import frozen
from mutabot.model.data import is_mock, is_scalar_of_numpy, is_unchangeable
from mutabot.model.enumeration import is_member

_STEP = re.compile(r"\.(?P<attribute>[^\W\d]\w*)|\[(?P<item>[^\[\]]*)\]")
_NAME = re.compile(r"[^\W\d]\w*")
_SLICE = re.compile(r"\s*(-?\d{1,9})?\s*:\s*(-?\d{1,9})?\s*(?::\s*(-?\d{1,9})?\s*)?")


@frozen
class Step:
    """A step of a path: an attribute's name, or an index, key or slice in brackets."""

    attribute: str | None = None
    item: Any = None
    bounds: tuple[int | None, int | None, int | None] | None = None

    def __str__(self) -> str:
        if self.attribute is not None:
            return f".{self.attribute}"
        if self.bounds is not None:
            start, stop, stride = ("" if bound is None else str(bound) for bound in self.bounds)
            return f"[{start}:{stop}{f':{stride}' if stride else ''}]"
        return f"[{self.item!r}]"

    @property
    def key(self) -> Any:
        """The content of the brackets, as Python would use it."""
        return slice(*self.bounds) if self.bounds is not None else self.item


#: the steps of a path, from an object on
PathSteps = tuple[Step, ...]


@frozen
class Path:
    """The location of a value inside an object; without steps, the object itself.

    Attributes:
        root: the argument's (or text field's) name a path starts at; None for a path into a result.
        steps: the way from there.
    """

    root: str | None = None
    steps: PathSteps = ()

    def __str__(self) -> str:
        return (self.root or "") + "".join(str(step) for step in self.steps)

    @classmethod
    def parse(cls, text: str, *, rooted: bool) -> Path:
        """Read a path. ``rooted`` paths begin with a name, others with ``.`` or ``[``.

        Raises ValueError, saying where the text stops making sense.
        """
        root, position = None, 0
        if rooted:
            name = _NAME.match(text)
            if name is None:
                raise ValueError(f"path {text!r} must begin with an argument's name")
            root, position = name.group(), name.end()
        steps: list[Step] = []
        while position < len(text):
            match = _STEP.match(text, position)
            if match is None:
                raise ValueError(
                    f"path {text!r} makes no sense from {text[position:]!r} on; "
                    "steps are .name, [index], ['key'] or [start:stop]"
                )
            steps.append(_read_step(match, text))
            position = match.end()
        return cls(root, tuple(steps))

    def get(self, value: Any) -> Any:
        """Return the value at the end of the steps, starting at ``value``.

        A mock on the way is returned itself if the next step is an item: to read that is a call of the mock.
        Raises PathError if a step does not fit.
        """
        for step in self.steps:
            if step.attribute is None and is_mock(value):
                return value
            value = self._advance(value, step)
        return value

    def put(self, value: Any, new: Any) -> Any:
        """Return a copy of ``value`` in which the end of the path holds ``new``.

        Raises PathError if a step does not fit or an object on the way cannot be copied and changed.
        """
        return self._put(value, new, 0)

    def fixed_part(self, value: Any) -> str:
        """Return the step whose part cannot be replaced, as ``.imag of complex``; empty if there is none.

        What a class does not show is tried: the value that is there is put in its place in a copy. An object
        with a finalizer is not tried, since the end of its copy would be noticed. Raises PathError if a step
        does not fit.
        """
        way = [value]
        for step in self.steps:
            if _is_fixed(way[-1], step):
                return _part(way[-1], step)
            way.append(self._advance(way[-1], step))
        inner = way.pop()
        for owner, step in zip(reversed(way), reversed(self.steps), strict=True):
            if hasattr(type(owner), "__del__"):
                return ""
            try:
                inner = _with_step(owner, step, inner)
            except Exception:  # as above: it may refuse in any way
                return _part(owner, step)
        return ""

    def _put(self, value: Any, new: Any, depth: int) -> Any:
        if depth == len(self.steps):
            return new
        step = self.steps[depth]
        inner = self._put(self._advance(value, step), new, depth + 1)
        try:
            return _with_step(value, step, inner)
        except Exception as error:  # messages of ROS 2 assert what a field takes; others may do anything
            raise PathError(
                f"cannot replace {step} of {type(value).__name__} (path {self}): {text_of(error)}",
                step=str(step),
            ) from error

    def _advance(self, value: Any, step: Step) -> Any:
        try:
            if step.attribute is not None:
                return getattr(value, step.attribute)
            return value[step.key]
        except (AttributeError, KeyError, IndexError, TypeError) as error:
            if value is None:  # an answer to "nothing there", or an optional part that is left out
                text = f"{str(self) or 'the value'}: NoneType has no {step}, so it is left as it is"
                raise StrangeValueError(text, step=str(step)) from error
            known = known_steps(value)
            wanted = step.attribute if step.attribute is not None else str(step)
            near = nearest_name(wanted, known) or nearest_name(str(step), known)
            hint = f"; did you mean {near!r}?" if near else f"; it has {', '.join(known[:8]) or 'no parts'}"
            raise PathError(
                f"{str(self) or 'the value'}: {type(value).__name__} has no {step}{hint}",
                step=str(step),
                known=known,
            ) from error
        except Exception as error:  # what the user's objects do when they are asked is up to them
            what = f"{step} of {type(value).__name__} raises {error_text(error)}"
            raise PathError(f"{str(self) or 'the value'}: {what}", step=str(step)) from error


def _read_step(match: re.Match[str], text: str) -> Step:
    attribute = match["attribute"]
    if attribute is not None:
        return Step(attribute=attribute)
    inside = match["item"]
    bounds = _SLICE.fullmatch(inside)
    if bounds is not None:
        start, stop, stride = (None if bound is None else int(bound) for bound in bounds.groups())
        if stride == 0:
            raise ValueError(f"path {text!r}: a slice cannot have a stride of zero")
        return Step(bounds=(start, stop, stride))
    try:
        item = ast.literal_eval(inside)
    except (ValueError, SyntaxError):
        raise ValueError(
            f"path {text!r}: [{inside}] is not an index, a quoted key or a slice (a key needs quotes)"
        ) from None
    if isinstance(item, bool) or not isinstance(item, int | str):
        raise ValueError(f"path {text!r}: [{inside}] must be a whole number or a quoted key")
    return Step(item=item)


def known_steps(value: Any) -> list[str]:
    """Return the steps that could be taken from ``value``, for error messages."""
    try:
        return _known_steps(value)
    except Exception:  # as above
        return []


def _known_steps(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [f"[{key!r}]" for key in list(value)[:20]]
    names = list(getattr(value, "_fields", ()))
    if not names and is_dataclass(value):
        names = [field.name for field in dataclass_fields(value)]
    if not names and (isinstance(value, list | tuple) or hasattr(type(value), "tolist")):
        return [f"[{index}]" for index in range(min(len(value), 20))]
    if not names and not isinstance(value, int | float | str | bytes | bool | None):
        names = [name for name in dir(value) if not name.startswith("_")]
    return [f".{name}" for name in names[:40]]


def _with_step(value: Any, step: Step, inner: Any) -> Any:
    if step.attribute is not None:
        return _with_attribute(value, step.attribute, inner)
    if isinstance(value, tuple):
        items = list(value)
        items[step.key] = inner
        return type(value)(*items) if hasattr(value, "_fields") else type(value)(items)
    copied = _copy_for_item(value, inner)
    is_slice_of_array = isinstance(copied, array) and step.bounds is not None
    copied[step.key] = array(copied.typecode, inner) if is_slice_of_array else inner
    return copied


def _copy_for_item(value: Any, inner: Any) -> Any:
    # An array of integers of numpy's would silently cut off a fraction, and one of Python's refuses it; one
    # without signs refuses a negative number. Numpy is not imported for this.
    if isinstance(value, array) and value.typecode not in "fdu":
        numbers = list(_numbers(inner if not isinstance(inner, array) else inner.tolist()))
        if not all(float(number).is_integer() for number in numbers):
            return array("d", value)
        is_refused = value.typecode.isupper() and any(number < 0 for number in numbers)
        return array("q", value) if is_refused else copy.copy(value)
    kind = getattr(getattr(value, "dtype", None), "kind", None)
    if kind in ("i", "u"):
        numbers = list(_numbers(inner))
        if not all(float(number).is_integer() for number in numbers):
            return value.astype(float)
        if kind == "u" and any(number < 0 for number in numbers):
            return value.astype(int)
    return copy.copy(value)


def _numbers(value: Any) -> Iterator[Any]:
    """Yield the numbers in a number, array or nested sequence."""
    for item in getattr(value, "flat", value if isinstance(value, list | tuple) else (value,)):
        if isinstance(item, list | tuple):
            yield from _numbers(item)
        else:
            yield item


def _with_attribute(value: Any, name: str, inner: Any) -> Any:
    if isinstance(value, tuple) and name in getattr(value, "_fields", ()):
        return value._replace(**{name: inner})  # type: ignore[attr-defined]  # a namedtuple
    copied = copy.copy(value)
    if copied is value:
        raise TypeError("it cannot be copied")
    try:
        setattr(copied, name, inner)
    except Exception as error:
        if not isinstance(error, AttributeError) and _can_be_set(copied, name):
            raise  # it refuses this value
        # A frozen dataclass or model forbids setattr, but its copy is ours alone. A property without a setter
        # shows what is stored under another name, or is computed: then object.__setattr__ refuses it.
        object.__setattr__(copied, _stored_as(value, name), inner)
    return copied


def _can_be_set(copied: Any, name: str) -> bool:
    """Return whether an attribute takes the value that it has."""
    try:
        setattr(copied, name, getattr(copied, name))
    except Exception:  # each library has its own for what is frozen
        return False
    return True


def _part(value: Any, step: Step) -> str:
    return f"{step} of {type(value).__name__}"


def _is_fixed(value: Any, step: Step) -> bool:
    """Return whether a step of an object is a read-only part of it, or is computed."""
    if is_member(value) or is_scalar_of_numpy(value):
        return True
    if step.attribute is None:
        return is_unchangeable(type(value))
    owner = next((base for base in type(value).__mro__ if step.attribute in vars(base)), None)
    if owner is None:
        return False
    shown = vars(owner)[step.attribute]
    is_computed = issubclass(type(shown), property) and shown.fset is None
    return is_unchangeable(owner) or (is_computed and _stored_as(value, step.attribute) == step.attribute)


def _stored_as(value: Any, name: str) -> str:
    """Return the attribute in which a property stores its value, such as ``_value``; else the name itself."""
    if isinstance(getattr(type(value), name, None), property):
        shown = getattr(value, name)
        hidden = (f"_{name}", *(f"_{base.__name__.lstrip('_')}__{name}" for base in type(value).__mro__))
        return next((other for other in hidden if getattr(value, other, None) is shown), name)
    return name


def class_name(kind: type[Any]) -> str:
    """``module:Qualified.Name``."""
    return f"{kind.__module__}:{kind.__qualname__}"


def opaque(value: Any) -> dict[str, str]:
    """Return a placeholder for a value that is not plain data."""
    return {"opaque": class_name(type(value))}
