"""Finds flat faces of parts in a depth picture, and where the suction cup gets at them.

World frame, m. It knows the picture, the drawing of the parts and where bin and stand are: nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from station import BIN, BIN_SIZE, BOTTOM, CUBE, CUP, NUT, PLATE, RIM, STAND, STAND_SIZE, STAND_TOP, TABLE_TOP

from mutabot_cell.depth_camera import DepthPicture
from mutabot_cell.geometry import Array

WINDOW = 5
"""Edge of the square in which a picture's point is compared with a plane, pixels."""
FLAT, STEEPEST, TILT = 0.0013, math.tan(math.radians(55)), math.cos(math.radians(46))
"""Points of a window lie around its plane with at most this standard deviation, m; it is not steeper than
this, nor a face that is grasped."""
FLAT_ENOUGH = math.cos(math.radians(25))
"""Faces that are steeper are grasped last."""
BEND, STEP, ON_FACE = 0.16, 0.0025, 0.0027
"""A face's windows differ by so much in slope, and in height, m; and points that belong to it, m."""
LEAST = 6
"""Windows of a face, at least."""
BOTTOM_WITHIN = 0.008
"""What is so near above the bottom is no part, m."""
ALIKE = 0.0015
"""Deviation of the spread of a face's points from that of the drawing, m."""
HIGHER, HIDDEN = 0.004, 0.2
"""What is so much higher beside a face, m, on more than this share of its outline, may hide some of it."""
EDGE = 0.0022
"""By so much the outline of a face appears smaller, m: pixels at the edge are often lost."""
STEM, HOUSING, SHORT, CLEARANCE = 0.009, 0.020, 0.034, 0.003
"""Radius of the cup, of the tool's housing, where above the lip it begins, and what must be free, m."""


@dataclass(frozen=True)
class Face:
    """A flat face of a part.

    Attributes:
        x, y, z: the place for the cup, world frame, m.
        slope_x, slope_y: of the face along x and y.
        shape: of the part; "unknown" if the face is hidden in part, or two faces look like one.
        thickness: of the part below it, m; 0 if that is not known.
        is_clear: whether little beside it is higher, which may hide some of it.
    """

    x: float
    y: float
    z: float
    slope_x: float
    slope_y: float
    shape: str
    thickness: float = 0.0
    is_clear: bool = True

    @property
    def normal(self) -> Array:
        """The unit vector out of the face, shape (3,)."""
        normal: Array = np.array([-self.slope_x, -self.slope_y, 1.0])
        return normal / np.linalg.norm(normal)


def spreads() -> dict[tuple[float, float], tuple[str, float]]:
    """Standard deviations of a face's points along and across it, m; the shape, and its thickness there."""
    long, wide, thick = PLATE
    edge, height = NUT
    drawn = {(long, wide): ("plate", thick), (long, thick): ("plate", wide), (wide, thick): ("plate", long)}
    drawn |= {(CUBE, CUBE): ("cube", CUBE), (height, edge): ("nut", edge * 3**0.5)}
    found = {
        ((item - EDGE) / 12**0.5, (other - EDGE) / 12**0.5): name for (item, other), name in drawn.items()
    }
    return found | {((edge * 2.5**0.5 - EDGE) / 12**0.5,) * 2: ("nut", height)}


SPREADS = spreads()


def is_empty(picture: DepthPicture) -> bool:
    """Whether the picture shows nothing in the bin."""
    return int(in_bin(picture.points).sum()) < LEAST


def locate(picture: DepthPicture, avoided: Sequence[tuple[float, float]] = ()) -> Face | None:
    """The face in the bin that is best to grasp: of a known part, and high up; None if there is none.

    Args:
        picture: of the bin.
        avoided: places (x, y) where a grasp has failed, m.
    """
    points = picture.points.reshape(-1, 3)
    points = points[np.abs(points - (*BIN, TABLE_TOP)).max(axis=1) < max(BIN_SIZE)]
    found = [
        face
        for face in faces(picture.points, in_bin(picture.points))
        if face.normal[2] > TILT
        and all(math.dist((face.x, face.y), place) > CUP / 2 for place in avoided)
        and is_free(face, points)
    ]
    return max(found, key=order, default=None)


def highest(picture: DepthPicture) -> tuple[float, float, float]:
    """The highest place in the bin, but where the tool would touch a wall, beside it; world frame, m."""
    points = picture.points[in_bin(picture.points)]
    x, y, z = points[np.argmax(points[:, 2])].tolist()
    reach = [edge / 2 - HOUSING - 2 * CLEARANCE for edge in BIN_SIZE]
    x, y = (min(max(at, mid - far), mid + far) for at, mid, far in zip((x, y), BIN, reach, strict=True))
    return x, y, z


def order(face: Face) -> tuple[bool, bool, bool, float]:
    """By this, faces are preferred: recognised, clear, flat, high."""
    return face.shape != "unknown", face.is_clear, face.normal[2] > FLAT_ENOUGH, face.z


def locate_on_stand(picture: DepthPicture) -> Face | None:
    """The face on top of the part on the stand, beside which nothing is higher; None if there is none."""
    off = np.abs(picture.points[..., :2] - STAND).max(axis=-1)
    high = picture.points[..., 2] - TABLE_TOP - STAND_TOP
    found = faces(picture.points, (off < STAND_SIZE / 2) & (high > BOTTOM_WITHIN))
    return max(found, key=lambda face: (face.is_clear, face.shape != "unknown", face.z), default=None)


def in_bin(points: Array) -> Array:
    """Which points of a picture, shape (rows, columns, 3), lie in the bin and above its bottom."""
    off = np.abs(points[..., :2] - BIN)
    inside: Array = (off < np.array(BIN_SIZE) / 2 - 0.001).all(axis=-1)
    return inside & (points[..., 2] > BOTTOM + BOTTOM_WITHIN)


def faces(points: Array, chosen: Array) -> Iterator[Face]:
    """Flat faces among the chosen points of a picture, shape (rows, columns, 3); the highest first."""
    if not chosen.any():
        return
    rows, columns = np.flatnonzero(chosen.any(axis=1)), np.flatnonzero(chosen.any(axis=0))
    part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    points, chosen = points[part], chosen[part]
    if min(chosen.shape) < WINDOW:
        return
    planes, flat = windows(points, chosen)
    for row, column in zip(
        *np.unravel_index(np.argsort(-points[..., 2], axis=None), flat.shape), strict=True
    ):
        if flat[row, column]:
            core = grown(points, planes, flat, (row, column))
            flat &= ~core
            if core.sum() >= LEAST:
                yield face_of(points, core, chosen)


def windows(points: Array, chosen: Array) -> tuple[Array, Array]:
    """Slopes of the plane around each point, shape (rows, columns, 2), and where points lie in a plane."""
    x, y, z = np.moveaxis(np.where(chosen[..., None], points - (*BIN, TABLE_TOP), 0.0), -1, 0)
    sums = [chosen.astype(float), x, y, z, x * x, x * y, y * y, x * z, y * z, z * z]
    view = np.lib.stride_tricks.sliding_window_view(
        np.pad(sums, ((0, 0), (2, 2), (2, 2))), (WINDOW, WINDOW), (1, 2)
    )
    count, x, y, z, xx, xy, yy, xz, yz, zz = view.sum(axis=(-1, -2))
    full = count == WINDOW**2
    count = np.maximum(count, 1)
    x, y, z = x / count, y / count, z / count
    xx, xy, yy = xx / count - x * x, xy / count - x * y, yy / count - y * y
    xz, yz, zz = xz / count - x * z, yz / count - y * z, zz / count - z * z
    det = np.where(full, xx * yy - xy * xy, 1.0)
    along, across = (xz * yy - yz * xy) / det, (yz * xx - xz * xy) / det
    left = np.maximum(zz - along * xz - across * yz, 0.0) / (1 + along**2 + across**2)
    flat = full & (left < FLAT**2) & (np.hypot(along, across) < STEEPEST)
    return np.stack([along, across], axis=-1), flat


def grown(points: Array, planes: Array, flat: Array, seed: tuple[int, int]) -> Array:
    """The flat points that hang together with a first one and lie in its plane, shape (rows, columns)."""
    slopes, level = planes[seed], points[seed]
    for _ in range(2):
        off = points[..., 2] - level[2] - (points[..., :2] - level[:2]) @ slopes
        alike = flat & (np.abs(off) < STEP) & (np.abs(planes - slopes).max(axis=-1) < BEND)
        core = np.zeros_like(flat)
        core[seed] = alike[seed] = True
        while True:
            wider = widened(core) & alike
            if wider.sum() == core.sum():
                break
            core = wider
        slopes, level = planes[core].mean(axis=0), points[core].mean(axis=0)
    return core


def widened(area: Array) -> Array:
    """The area and its neighbours."""
    wide = area.copy()
    wide[1:] |= area[:-1]
    wide[:-1] |= area[1:]
    wide[:, 1:] |= area[:, :-1]
    wide[:, :-1] |= area[:, 1:]
    return wide


def face_of(points: Array, core: Array, chosen: Array) -> Face:
    """The face around a core of flat windows."""
    level, slopes = plane_of(points[core])
    wide = core
    for _ in range(WINDOW // 2 + 1):
        wide = widened(wide)
    off = points[..., 2] - level[2] - (points[..., :2] - level[:2]) @ slopes
    area = wide & chosen & (np.abs(off) < ON_FACE * math.hypot(1.0, *slopes))
    level, slopes = plane_of(points[area])
    flat = (points[area] - level) @ basis(slopes)
    spread = np.sqrt(np.linalg.eigvalsh(np.cov(flat.T))[::-1])
    around = off[widened(widened(area)) & ~area]
    is_clear = bool(np.mean(around > HIGHER) < HIDDEN)
    miss, known = min((math.dist(spread, known), known) for known in SPREADS)
    if miss < ALIKE:
        return Face(*level.tolist(), *slopes.tolist(), *SPREADS[known], is_clear)
    while (inner := ~widened(~core) & core).any():
        core = inner
    inside = points[core]
    far = inside[np.argmax(((inside - level) ** 2).sum(axis=1))]
    z = level[2] + (far[:2] - level[:2]) @ slopes
    return Face(far[0], far[1], float(z), *slopes.tolist(), "unknown", 0.0, is_clear)


def plane_of(points: Array) -> tuple[Array, Array]:
    """The middle, shape (3,), and the slopes along x and y, shape (2,), of points, shape (points, 3)."""
    middle: Array = points.mean(axis=0)
    slopes: Array = np.linalg.lstsq(points[:, :2] - middle[:2], points[:, 2] - middle[2], rcond=None)[0]
    return middle, slopes


def basis(slopes: Array) -> Array:
    """Two unit vectors in a plane with these slopes, shape (3, 2)."""
    along = np.array([1.0, 0.0, slopes[0]])
    along /= np.linalg.norm(along)
    across = np.cross([-slopes[0], -slopes[1], 1.0], along)
    return np.stack([along, across / np.linalg.norm(across)], axis=-1)


def is_free(face: Face, points: Array) -> bool:
    """Whether the tool on this face touches neither the bin's walls nor what else the picture shows."""
    place, axis = np.array([face.x, face.y, face.z]), face.normal
    away = points - place
    height = away @ axis
    beside = np.linalg.norm(away - height[:, None] * axis, axis=1)
    blocks = (height > SHORT - CLEARANCE) & (beside < HOUSING + CLEARANCE)
    blocks |= (height > 2 * CLEARANCE) & (height <= SHORT) & (beside < STEM + CLEARANCE)
    if blocks.sum() > 2:
        return False
    for up in np.arange(0.0, 0.12, 0.01):
        x, y, z = place + up * axis
        radius = (STEM if up < SHORT else HOUSING) + CLEARANCE
        low = z - radius * math.hypot(*axis[:2]) < RIM + CLEARANCE
        if low and (np.abs((x - BIN[0], y - BIN[1])) + radius > np.array(BIN_SIZE) / 2).any():
            return False
    return True
