"""Disturbances for any program that uses PyBullet: the functions that ``pybullet.toml`` names.

Importing this puts functions around those of PyBullet that load bodies, or say again what a disturbance
changed: what a program sets itself, or after a reset of the simulation, is disturbed as well. Each
disturbance is a function of a body or of what gravity was set to, of the change in SI units and, by name, of
``names``, in which ``*`` stands for any text. Bodies without a name are called ``body 3``, by their number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from random import Random
from typing import Any

import pybullet
import wrapt

from .change import NotInWorldError, NumberChange
from .patching import mark_raised, rebind

#: the arguments of functions, in their order; those of all others are known by name alone
_ORDER = {
    "changeDynamics": ("bodyUniqueId", "linkIndex", "mass", "lateralFriction"),
    "resetBasePositionAndOrientation": ("bodyUniqueId", "posObj", "ornObj"),
    "setGravity": ("gravX", "gravY", "gravZ"),
    "setJointMotorControl2": (
        "bodyUniqueId", "jointIndex", "controlMode", "targetPosition", "targetVelocity", "force",
        "positionGain", "velocityGain", "maxVelocity",
    ),
    "setJointMotorControlArray": (
        "bodyUniqueId", "jointIndices", "controlMode", "targetPositions", "targetVelocities", "forces",
        "positionGains", "velocityGains",
    ),
}  # fmt: skip
_LOADING = ("loadURDF", "loadSDF", "loadMJCF", "loadBullet", "createMultiBody")
_REMOVING = ("removeBody", "resetSimulation", "disconnect")
#: what PyBullet takes for arguments of motors that are not given
_DEFAULTS = {"force": 100000.0, "positionGain": 0.1}
_LEAST, _AXES, _BASE, _CLIENTS = 1e-9, "xyz", -1, 16

#: PyBullet's own functions, by name, and what changes the arguments of their calls by the program
_own: dict[str, Any] = {}
_changes: dict[str, list[Callable[[dict[str, Any]], None]]] = {name: [] for name in _ORDER}
_worlds: dict[tuple[int, object], Body | Pull] = {}


class Body:
    """A body that the program has loaded.

    Attributes:
        client: of its simulation.
        number: PyBullet's own, unique in the simulation.
        name: as its file has it.
    """

    def __init__(self, client: int, number: int) -> None:
        self.client, self.number = client, number
        self.name = pybullet.getBodyInfo(number, physicsClientId=client)[1].decode() or f"body {number}"

    def links(self, names: str) -> list[int]:
        """Return its links with these names; the base is -1, named as the body. Raises NotInWorldError."""
        return self._named(names, "body or link", {_BASE: self.name, **self._joints(12)})

    def bases(self, names: str) -> list[int]:
        """Return its base, if its name is among these. Raises NotInWorldError."""
        return self._named(names, "body", {_BASE: self.name})

    def joints(self, names: str) -> list[int]:
        """Return its movable joints with these names. Raises NotInWorldError."""
        return self._named(names, "joint", self.moving())

    def moving(self) -> dict[int, str]:
        """Return the names of its movable joints, by their numbers."""
        fixed = [number for number, kind in self._joints(2).items() if kind == pybullet.JOINT_FIXED]
        return {n: name for n, name in self._joints(1).items() if n not in fixed}

    def is_of(self, named: dict[str, Any]) -> bool:
        """Return whether a call of a PyBullet function concerns this body."""
        key = named.get("physicsClientId", 0), named.get("bodyUniqueId")
        # another body may have the number after a reset of the simulation
        return key == (self.client, self.number) and _worlds.setdefault(key, self) is self

    def own(self, name: str, *arguments: Any, **named: Any) -> Any:
        """Call PyBullet's unwrapped function for this body."""
        return _own.get(name, getattr(pybullet, name))(
            self.number, *arguments, **named, physicsClientId=self.client
        )

    def _joints(self, item: int) -> dict[int, Any]:
        count = pybullet.getNumJoints(self.number, physicsClientId=self.client)
        found = {n: self.own("getJointInfo", n)[item] for n in range(count)}
        return {n: name.decode() if isinstance(name, bytes) else name for n, name in found.items()}

    def _named(self, names: str, kind: str, known: dict[int, str]) -> list[int]:
        found = [
            number
            for number, name in known.items()
            if fnmatchcase(name, names) or fnmatchcase(f"{self.name}/{name}", names)
        ]
        if not found:
            of_all = sorted(
                {world.name for world in _worlds.values() if isinstance(world, Body)} | {self.name}
            )
            there = ", ".join(filter(None, known.values())) or "none"
            raise NotInWorldError(
                f"no {kind} is named {names!r}; the last body has: {there}; bodies: {', '.join(of_all)}"
            )
        return found


@dataclass(eq=False)
class Pull:
    """The gravity that a program has set in a client's simulation: along x, y and z, m/s²."""

    client: int
    gravity: tuple[float, ...]


def mass(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the mass of links, kg, with their inertia; a link without mass stays fixed."""
    body = _body(world)
    links = [link for link in body.links(names) if body.own("getDynamicsInfo", link)[0] > 0.0]
    if not links:
        raise NotInWorldError(f"{body.name} has no mass: it stands still")
    _of_links(body, links, "mass", change, _LEAST)


def friction(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the sliding friction of links; PyBullet multiplies the friction of two that touch."""
    body = _body(world)
    _of_links(body, body.links(names), "lateralFriction", change)


def damping(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the damping of joints, N·s/m or N·m·s/rad."""
    body = _body(world)
    _of_links(body, body.joints(names), "jointDamping", change)


def position(world: Any, change: NumberChange, *, names: str, random: Random, axis: str) -> None:
    """Change the position of bodies along a world axis, m, when they are loaded and reset."""
    body, number = _body(world), _AXES.index(axis)
    body.bases(names)

    def moved(place: Sequence[float]) -> list[float]:
        return [
            float(change(coordinate)) if n == number else float(coordinate)
            for n, coordinate in enumerate(place)
        ]

    def put(named: dict[str, Any]) -> None:
        if body.is_of(named):
            named["posObj"] = moved(named["posObj"])

    place, turned = body.own("getBasePositionAndOrientation")
    speeds = body.own("getBaseVelocity")
    body.own("resetBasePositionAndOrientation", moved(place), turned)
    body.own("resetBaseVelocity", *speeds)
    _changes["resetBasePositionAndOrientation"].append(put)


def gain(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the gain of the joints' position control."""
    _of_motors(_body(world), change, names, "positionGain")


def strength(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the largest force or torque of joint motors, N or Nm, as the program sets it."""
    _of_motors(_body(world), change, names, "force")


def gravity(world: Any, change: NumberChange, *, names: str, random: Random) -> None:
    """Change the vertical gravity, m/s²; a positive change pulls harder."""
    if not isinstance(world, Pull):
        raise NotInWorldError("the program sets no gravity")
    x, y, z = world.gravity
    _own["setGravity"](x, y, -float(change(-z)), physicsClientId=world.client)


def offered_parameters(world: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield the parameters that a body, or gravity, offers, and the names of the things that have them."""
    if isinstance(world, Pull):
        yield "gravity", ["*"]
    elif isinstance(world, Body):
        free = [world.name] if world.own("getDynamicsInfo", _BASE)[0] > 0.0 else []
        joints = world.moving()
        yield from (("mass", free), ("friction", free), ("gain", [*joints.values()]))
        yield "damping", [name for n, name in joints.items() if world.own("getJointInfo", n)[6] > 0.0]


def _body(world: Any) -> Body:
    if not isinstance(world, Body):
        raise NotInWorldError("the program loads no body")
    return world


def _of_links(body: Body, links: Iterable[int], key: str, change: NumberChange, least: float = 0.0) -> None:
    """Change a number of links now, and each time that the program sets it again."""
    meant = {*links}

    def say(named: dict[str, Any]) -> None:
        if body.is_of(named) and named["linkIndex"] in meant and key in named:
            before = float(named[key])
            named[key] = max(float(change(before)), least)
            if key == "mass" and "localInertiaDiagonal" in named and before:
                factor = named[key] / before
                named["localInertiaDiagonal"] = [moment * factor for moment in named["localInertiaDiagonal"]]

    for link in meant:
        mass, friction, inertia = body.own("getDynamicsInfo", link)[:3]
        damping = body.own("getJointInfo", link)[6] if link != _BASE else 0.0
        there = {"mass": mass, "lateralFriction": friction, "jointDamping": damping}
        named = {"bodyUniqueId": body.number, "physicsClientId": body.client, "linkIndex": link}
        named |= {key: there[key], **({"localInertiaDiagonal": inertia} if key == "mass" else {})}
        say(named)
        _own["changeDynamics"](**named)
    _changes["changeDynamics"].append(say)


def _of_motors(body: Body, change: NumberChange, names: str, key: str) -> None:
    joints, default = {*body.joints(names)}, _DEFAULTS[key]

    def of_one(named: dict[str, Any]) -> None:
        if body.is_of(named) and named["jointIndex"] in joints:
            named[key] = float(change(float(named.get(key, default))))

    def of_many(named: dict[str, Any]) -> None:
        if body.is_of(named) and joints & {*named["jointIndices"]}:
            numbers = [*named["jointIndices"]]
            values = [float(value) for value in named.get(f"{key}s", [default] * len(numbers))]
            pairs = zip(numbers, values, strict=True)
            named[f"{key}s"] = [float(change(value)) if n in joints else value for n, value in pairs]

    _changes["setJointMotorControl2"].append(of_one)
    _changes["setJointMotorControlArray"].append(of_many)


def _wrapper(name: str) -> Callable[..., Any]:
    """Return a wrapper of a PyBullet function that changes arguments and records bodies and gravity."""

    def call(wrapped: Any, instance: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        if name in _ORDER:
            named = {**dict(zip(_ORDER[name], arguments, strict=False)), **named}
            arguments = arguments[len(_ORDER[name]) :]
            for change in _changes[name]:
                change(named)
        try:
            result = wrapped(*arguments, **named)
        except pybullet.error as error:
            mark_raised(error)
            raise
        _note(name, named)
        return result

    return call


def _note(name: str, named: dict[str, Any]) -> None:
    """Record the bodies and gravity that exist after a call."""
    client = named.get("physicsClientId", 0)
    if name in _REMOVING:
        for key in [key for key in _worlds if key[0] == client]:
            if name != "removeBody" or key[1] == named.get("bodyUniqueId"):
                del _worlds[key]
    elif name == "setGravity":
        _worlds[client, "gravity"] = Pull(client, tuple(named[axis] for axis in _ORDER[name]))
    elif name in _LOADING:
        _find_bodies(client)


def _find_bodies(client: int) -> None:
    for index in range(pybullet.getNumBodies(physicsClientId=client)):
        number = pybullet.getBodyUniqueId(index, physicsClientId=client)
        if (client, number) not in _worlds:
            _worlds[client, number] = Body(client, number)


def _begin() -> None:
    for name in (*_ORDER, *_LOADING, *_REMOVING):
        _own[name] = getattr(pybullet, name)
        # clients of pybullet_utils take what says of itself that it is a built-in function
        rebind(_own[name], wrapt.FunctionWrapper(_own[name], _wrapper(name)))
    for client in range(_CLIENTS):
        if pybullet.isConnected(client):
            _find_bodies(client)
            found = pybullet.getPhysicsEngineParameters(client)
            pull = tuple(found[f"gravityAcceleration{axis}"] for axis in "XYZ")
            if any(pull):
                _worlds[client, "gravity"] = Pull(client, pull)


_begin()
