"""Plain data survives the way over JSON."""

from __future__ import annotations

import json
import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, Union, get_args, get_origin, get_type_hints

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mutabot import model
from mutabot.model import Call, Reply, job
from mutabot.model.codec import from_data, to_data, to_json
from mutabot.model.events import EVENTS, event_from_data, event_to_data
from mutabot.model.path import Step

#: plain data that operators may put anywhere; tuples are lists after JSON
plain: st.SearchStrategy[Any] = (
    st.booleans() | st.integers() | st.text(max_size=5) | st.floats(allow_nan=False)
)
few = settings(max_examples=25, deadline=None)
#: these hold callables and never leave the process
STAY_INSIDE = {Call, Reply}
NAMED = [getattr(model, name) for name in model.__all__]
KINDS = list(
    dict.fromkeys(
        kind
        for kind in [*NAMED, *vars(job).values(), *EVENTS.values()]
        if isinstance(kind, type) and is_dataclass(kind)
    )
)


def values_of(kind: Any) -> st.SearchStrategy[Any]:
    """Values of a type, by the type hints that the codec goes by."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind is Any:
        return plain
    if origin in (Union, types.UnionType):
        return st.one_of(*(values_of(option) for option in arguments))
    if origin is tuple:
        if arguments[-1] is Ellipsis:
            return st.lists(values_of(arguments[0]), max_size=2).map(tuple)
        return st.tuples(*map(values_of, arguments))
    if origin is not None and issubclass(origin, Mapping):
        return st.dictionaries(st.text(max_size=3), values_of(arguments[1]), max_size=2)
    if is_dataclass(kind):
        return instances_of(kind)
    return of_plain_type(kind)


@cache  # one strategy per class, so that classes may hold themselves
def instances_of(kind: Any) -> st.SearchStrategy[Any]:
    hints = get_type_hints(kind)
    return st.deferred(
        lambda: st.builds(kind, **{each.name: values_of(hints[each.name]) for each in fields(kind)})
    )


def of_plain_type(kind: Any) -> st.SearchStrategy[Any]:
    if issubclass(kind, Enum):
        return st.sampled_from(list(kind))
    strategies: dict[Any, st.SearchStrategy[Any]] = {
        str: st.text(max_size=5),
        bool: st.booleans(),
        int: st.integers(),
        float: st.floats(allow_nan=False),
        type(None): st.none(),
    }
    return strategies[kind]


def over_json(data: Any) -> Any:
    return json.loads(json.dumps(data))


@pytest.mark.parametrize("kind", [*(kind for kind in KINDS if kind not in STAY_INSIDE), Step])
def test_every_dataclass_survives_the_way_over_json(kind: type[Any]) -> None:
    @few
    @given(value=instances_of(kind))
    def survives(value: Any) -> None:
        assert from_data(kind, over_json(to_data(value))) == value

    survives()


@pytest.mark.parametrize("kind", EVENTS.values())
def test_every_report_line_survives_the_way_over_json_with_its_type(kind: type[Any]) -> None:
    @few
    @given(line=instances_of(kind))
    def survives(line: Any) -> None:
        assert event_from_data(over_json(event_to_data(line))) == line
        assert from_data(kind, json.loads(to_json(line, default=str))) == line

    survives()


def test_the_job_of_a_mutant_survives_with_its_vocabulary_and_mutant() -> None:
    assert {job.Job, model.Vocabulary, model.Mutant, model.Quantity, model.Pattern} <= set(KINDS)


def test_an_unknown_type_of_line_is_refused() -> None:
    with pytest.raises(KeyError):
        event_from_data({"type": "Gossip"})


@pytest.mark.parametrize("kind", KINDS)
def test_no_field_has_another_default_where_none_means_something(kind: type[Any]) -> None:
    # None is left out of the data, so it would come back as that default
    hints = get_type_hints(kind)
    for each in fields(kind):
        optional = type(None) in get_args(hints[each.name])
        assert not optional or each.default in (None, MISSING), f"{kind.__name__}.{each.name}"


def test_keys_that_are_no_texts_are_written_as_texts() -> None:
    assert json.loads(to_json({(1, 2): 3, None: 4}, default=str)) == {"(1, 2)": 3, "None": 4}
