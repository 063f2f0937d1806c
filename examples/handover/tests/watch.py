"""What must hold at every moment: watched by the strong suite."""

from __future__ import annotations

import math

from station import APART, BASE_HEIGHT, TABLE_TOP, Station

from mutabot_cell.simulation import TICK

MIDDLE = 0.24, 0.16
"""Half of the zone, as seen from the middle between the robots, along x and y, m."""
STANDING = 0.004
"""A tool that settles or hangs at a bar that is gripped is not faster, m/s."""
STOPPED_WITHIN = 0.6
"""After a person has passed the light curtain, s: two readings, and braking from full speed."""
NEAR, SLOWED_WITHIN, SLOW = 1.5, 0.6, 0.25
"""A person so near, m, for so long, s: no tool is faster than this, m/s."""
TIPPING = 0.005
"""A bar that is put down may tip by so much in a tick, m; one that falls from 13 mm is faster."""


class Tools:
    """Places and speeds of both tools, from tick to tick.

    Attributes:
        places: by the robot's name, world frame, m.
        speeds: m/s.
    """

    def __init__(self, station: Station) -> None:
        self._truth = station.cell.truth
        self.places = self._now()
        self.speeds = dict.fromkeys(self.places, 0.0)

    def update(self) -> bool:
        """Look again; always true."""
        before, self.places = self.places, self._now()
        self.speeds = {name: math.dist(before[name], place) / TICK for name, place in self.places.items()}
        return True

    def _now(self) -> dict[str, tuple[float, float, float]]:
        left, right = (self._truth.tool_position(name) for name in ("left", "right"))
        return {
            "left": (left.x, left.y, left.z + BASE_HEIGHT),
            "right": (APART - right.x, -right.y, right.z + BASE_HEIGHT),
        }


def watch(station: Station) -> None:
    """Watch all that must hold at every moment, from now on."""
    cell, tools = station.cell, Tools(station)
    cell.always(tools.update, "the tools are somewhere")
    watch_zone(station, tools)
    watch_person(station, tools)
    watch_bars(station, tools)


def watch_zone(station: Station, tools: Tools) -> None:
    """In the middle at most one tool moves; the left robot owns it there, the right one may be its guest."""

    def inside() -> list[str]:
        x, y = MIDDLE
        return [name for name, at in tools.places.items() if abs(at[0] - APART / 2) < x and abs(at[1]) < y]

    def is_calm() -> bool:
        found = inside()
        return len(found) < 2 or min(tools.speeds[name] for name in found) < STANDING

    def is_owned() -> object:
        owner = station.zone.owner
        return all(owner == "left" if name == "left" else owner for name in inside())

    station.cell.always(is_calm, "in the middle at most one robot moves")
    station.cell.always(is_owned, "the middle belongs to who enters it")


def watch_person(station: Station, tools: Tools) -> None:
    """Nothing moves when a person has passed the curtain, and nothing moves fast when one is near."""
    cell, since = station.cell, {"in": math.inf, "near": math.inf}

    def note(name: str, is_so: bool, within: float) -> bool:
        since[name] = min(since[name], cell.time) if is_so else math.inf
        return cell.time - since[name] > within

    def is_safe() -> bool:
        is_in = note("in", not station.guards.is_clear(), STOPPED_WITHIN)
        is_near = note("near", station.guards.true_distance() < NEAR, SLOWED_WITHIN)
        fastest = max(tools.speeds.values())
        return not (is_in and fastest > STANDING) and not (is_near and fastest > SLOW)

    cell.always(is_safe, "robots stand beside a person and are slow when one comes near")


def watch_bars(station: Station, tools: Tools) -> None:
    """A bar is on a table, or moves no faster than a tool that holds it: it is never dropped or thrown."""
    cell = station.cell
    count = sum(part.name.startswith("bar") for part in cell.simulation.scene.parts)
    heights = dict.fromkeys(range(count), TABLE_TOP)

    def is_carried() -> bool:
        for number, before in heights.items():
            heights[number] = cell.truth.box_position(f"bar {number}").z
            if before - heights[number] > max(tools.speeds.values()) * TICK + TIPPING:
                return False
        return True

    cell.always(is_carried, "no bar falls")
