"""The structures of RAPID: their components, values to begin with, and what literals become."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from mutabot_languages.core.frames import Frame
from mutabot_languages.core.scope import Structure

Components = tuple[tuple[str, str], ...]


def _of(text: str) -> Components:
    pairs = (part.split(":") for part in text.split())
    return tuple((name, type) for name, type in pairs)


def _numbers(names: str) -> Components:
    return tuple((name, "num") for name in names.split())


STRUCTURES: dict[str, Components] = {
    "pos": _numbers("x y z"),
    "orient": _numbers("q1 q2 q3 q4"),
    "confdata": _numbers("cf1 cf4 cf6 cfx"),
    "extjoint": _numbers("eax_a eax_b eax_c eax_d eax_e eax_f"),
    "robtarget": _of("trans:pos rot:orient robconf:confdata extax:extjoint"),
    "robjoint": _numbers("rax_1 rax_2 rax_3 rax_4 rax_5 rax_6"),
    "jointtarget": _of("robax:robjoint extax:extjoint"),
    "pose": _of("trans:pos rot:orient"),
    "loaddata": _of("mass:num cog:pos aom:orient ix:num iy:num iz:num"),
    "tooldata": _of("robhold:bool tframe:pose tload:loaddata"),
    "wobjdata": _of("robhold:bool ufprog:bool ufmec:string uframe:pose oframe:pose"),
    "speeddata": _numbers("v_tcp v_ori v_leax v_reax"),
    "zonedata": _of("finep:bool") + _numbers("pzone_tcp pzone_ori pzone_eax zone_ori zone_leax zone_reax"),
    "progdisp": _of("pdisp:pose eoffs:extjoint"),
}
_PLAIN = {"num": 0, "dnum": 0, "bool": False, "string": ""}


class RapidArray(list[Any]):
    """An array, whose elements have a type."""

    type = ""


def initial(type: str, structures: Mapping[str, Components], sizes: list[int] | None = None) -> Any:
    """Return the value that data of a type begins with."""
    if sizes:
        made = RapidArray(initial(type, structures, sizes[1:]) for _ in range(sizes[0]))
        made.type = type
        return made
    if type in structures:
        value = Structure.of(type, {name: initial(inner, structures) for name, inner in structures[type]})
        if type == "orient":
            value["q1"] = 1
        return value
    return _PLAIN.get(type, 0)


def shaped(value: Any, type: str, structures: Mapping[str, Components]) -> Any:
    """Return a value with literals made structures of a type. Raises ValueError if it does not fit."""
    if isinstance(value, Structure):
        return copy.deepcopy(value)
    if isinstance(value, list) and type in structures:
        components = structures[type]
        if len(value) != len(components):
            raise ValueError(f"{type} has {len(components)} components, not {len(value)}")
        pairs = zip(components, value, strict=True)
        return Structure.of(type, {name: shaped(part, inner, structures) for (name, inner), part in pairs})
    if isinstance(value, list):
        made = RapidArray(shaped(element, type, structures) for element in value)
        made.type = type
        return made
    return value


def frame_of(value: Any) -> Frame:
    """Return the frame of a pose or a target, which is in mm. Raises TypeError."""
    if not (isinstance(value, dict) and "trans" in value and "rot" in value):
        raise TypeError(f"expected a pose or a robtarget, found {value!r}")
    return Frame.of_quaternion([mm / 1000 for mm in value["trans"].values()], list(value["rot"].values()))


def put_frame(value: Structure, frame: Frame) -> Structure:
    """Return a copy of a pose or a target with this frame."""
    made = copy.deepcopy(value)
    made["trans"] = Structure.of("pos", dict(zip("xyz", (m * 1000 for m in frame.position), strict=True)))
    made["rot"] = Structure.of("orient", dict(zip(("q1", "q2", "q3", "q4"), frame.rotation, strict=True)))
    return made
