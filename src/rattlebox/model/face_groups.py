"""Groups of triangles of a surface, each of which is a wall."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from rattlebox._util.phrases import counted
from rattlebox._util.text import has_controls

from .also_accepts import AlsoAccepts
from .base import Part
from .elementwise import Vector
from .errors import Hint, at, nearest
from .space import AXES, Direction, unit_vector
from .units import Angle, Length

REST, FROM_FILE = "rest", "file"
MOST_GROUPS = 200
UNGROUPED = "mesh"
"""Name of the triangles that are in no group."""

DIRECTIONS = tuple(sign + axis for sign in ("-", "+", "") for axis in AXES)
_TOLERANCE = 1e-7  # of a place, over the size of the surface: files in single precision round to half of it
_IN_PATHS = ".[]"  # characters that have a meaning in paths such as damper.walls.floor.friction
_EXAMPLE = '{ floor = "-z", side = "rest" }'


def _limits(value: object) -> Any:
    """Return the lowest and the highest coordinate."""
    if value is not None and not (isinstance(value, (list, tuple, np.ndarray)) and len(value) == 2):
        raise Hint("the lowest and the highest coordinate are needed", '["-5 mm", "5 mm"]')
    return value


_Range = Annotated[tuple[Length, Length] | None, BeforeValidator(_limits)]


def _outward(value: object) -> Any:
    """Return a direction without a plus, which the names of the faces of a box have."""
    return value.removeprefix("+") if isinstance(value, str) else value


class FaceGroup(Part):
    """Faces of a surface of triangles that are one wall, chosen by direction and place.

    A triangle belongs to the group if all conditions that are given hold.

    Parameters
    ----------
    facing
        Direction into which the faces look outward, as in the names of the faces of a box: "-z" for a floor; or three
        components.
    within
        Largest angle between the normal of a triangle and this direction [rad].
    x, y, z
        Lowest and highest coordinate of all corners of a triangle, relative to the centre of the cavity [m].
    rest
        Whether these are the triangles that no other group contains; without other conditions.

    Examples
    --------
    A can of triangles with a floor and a lid; all other faces are its side.

    >>> import rattlebox as rb
    >>> groups = {"floor": "-z", "lid": rb.FaceGroup("z", within="30 deg"), "side": "rest"}
    """

    field_names: ClassVar[tuple[str, ...]] = ("groups",)
    positional: ClassVar[tuple[str, ...]] = ("facing",)
    elementwise: ClassVar[bool] = False
    facing: Annotated[Direction | None, BeforeValidator(_outward)] = Field(default=None, examples=["-z"])
    within: Angle = float(np.radians(10.0))
    x: _Range = Field(default=None, examples=[["-5 mm", "5 mm"]])
    y: _Range = Field(default=None, examples=[["-5 mm", "5 mm"]])
    z: _Range = Field(default=None, examples=[["-5 mm", "5 mm"]])
    rest: bool = False

    @model_validator(mode="after")
    def _selects(self) -> FaceGroup:
        ranges = [name for name in AXES if getattr(self, name) is not None]
        if self.rest == bool(self.facing is not None or ranges):
            raise Hint(
                "a group of faces has conditions, or is the rest of the surface",
                f'facing = "-z", or z = ["-10 mm", "0 mm"], or the word {REST}',
            )
        if not 0 < self.within <= np.pi / 2:
            raise Hint("an angle above 0 and up to 90 degrees is needed", '"10 deg"', ["within"])
        for name in ranges:
            low, high = getattr(self, name)
            if low > high:
                raise Hint(
                    f"the lowest coordinate, {low:g} m, is above the highest one, {high:g} m",
                    "the lowest first",
                    [name],
                )
        return self

    def select(self, points: Vector, normals: Vector) -> tuple[NDArray[np.bool_], int]:
        """Return which triangles are in the group, (m,), and how many reach across its limits.

        `points`: corners relative to the centre of the cavity, (m, 3, 3) [m]. `normals`: unit vectors out of the space.
        """
        chosen = np.full(len(points), not self.rest)
        if self.facing is not None:
            chosen &= normals @ unit_vector(self.facing) >= np.cos(self.within) - 1e-9
        partly = chosen.copy()
        tolerance = _TOLERANCE * float(np.ptp(points, axis=(0, 1)).max())
        for axis, name in enumerate(AXES):
            if (limits := getattr(self, name)) is not None:
                along, low, high = points[:, :, axis], limits[0] - tolerance, limits[1] + tolerance
                chosen &= ((along >= low) & (along <= high)).all(axis=1)
                partly &= (along.max(axis=1) > low + 2 * tolerance) & (along.min(axis=1) < high - 2 * tolerance)
        return chosen, int((partly & ~chosen).sum())


def _group(value: object) -> Any:
    """Return the fields of a group for one word: a direction, or "rest"."""
    if isinstance(value, str) and value == REST:
        return {"rest": True}
    if isinstance(value, (Mapping, FaceGroup)):
        return value
    words = [REST, *DIRECTIONS]
    if isinstance(value, (list, tuple, np.ndarray)) or value in words:
        return {"facing": value}
    what = f"a group of faces is a direction, a table, or the word {REST}"
    raise Hint(what, nearest(value, words) if isinstance(value, str) else '"-z"')


def _groups(value: object, table: Callable[[object], Any]) -> Any:
    """Return the groups by name, or the word that takes those of the file."""
    if isinstance(value, str) and value == FROM_FILE:
        return value
    if not isinstance(value, Mapping):
        raise Hint(f'groups are a table of names and directions, or the word "{FROM_FILE}"', _EXAMPLE)
    return table(value)


class _Table:
    """Annotation of a table of groups, or a word: pydantic's union of both has two messages for each fault of a group."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(lambda value: value)
        table = handler.generate_schema(dict[str, AnyGroup])
        return core_schema.no_info_wrap_validator_function(_groups, table, serialization=written)


AnyGroup = Annotated[FaceGroup, BeforeValidator(_group), AlsoAccepts({"type": "string"})]
AnyGroups = Annotated[dict[str, AnyGroup] | Literal["file"], _Table(), AlsoAccepts({"const": FROM_FILE})]


def check_names(names: Iterable[str]) -> None:
    """Raise unless groups have names that the paths of a case can contain."""
    names = list(names)
    for name in names:
        if not name.strip() or set(name) & set(_IN_PATHS) or has_controls(name):
            what = f"is no name of a group: it is empty, or contains a control character or one of {_IN_PATHS}"
            raise Hint(f"{name!r} {what}", "letters", [name])
    if len(names) > MOST_GROUPS:
        raise Hint(f"{len(names)} groups are too many", f"at most {MOST_GROUPS}")


def select_groups(
    groups: Mapping[str, FaceGroup], points: Vector, normals: Vector
) -> tuple[tuple[str, ...], NDArray[np.int64], tuple[str, ...]]:
    """Return the names of the walls of a surface, the number of that of each triangle, (m,), and warnings.

    `points`: corners relative to the centre of the cavity, (m, 3, 3) [m]. `normals`: unit vectors out of the space, (m, 3).

    Raises
    ------
    Hint
        If a group contains no triangle, or two groups the same one.
    """
    number = np.full(len(points), -1)
    notes = []
    rest = [name for name, group in groups.items() if group.rest]
    if len(rest) > 1:
        raise Hint(f"{rest[0]} and {rest[1]} are both the rest of the surface", "one of them", [rest[1]])
    # Each triangle has one group, and each group a triangle.
    for k, (name, group) in enumerate(groups.items()):
        chosen, across = group.select(points, normals)
        twice = np.flatnonzero(chosen & (number >= 0))
        if twice.size:
            other = list(groups)[number[twice[0]]]
            raise Hint(
                f"{counted(twice.size, 'triangle')} would be in the groups {other!r} and {name!r}, the first near "
                f"{_place(points[twice[0]])}",
                "smaller angles, or limits x, y or z that exclude each other",
                [name],
            )
        if not group.rest and not chosen.any():
            normal = ", ".join(f"{component:.2g}" for component in normals[np.argmax(_likeness(group, normals))])
            nearby = f"; the nearest direction of a triangle is ({normal})" if group.facing is not None else ""
            limits = f"; {counted(across, 'triangle')} {'reaches' if across == 1 else 'reach'} across its limits"
            raise Hint(
                f"no triangle of the surface is in the group {name!r}{limits if across else nearby}",
                _advice(group, points, normals, across),
                [name],
            )
        if across:
            notes.append(
                f"warning: {counted(across, 'triangle')} {'reaches' if across == 1 else 'reach'} across the limits of the "
                f"group {name!r} and {'is' if across == 1 else 'are'} not in it; try: limits at edges of triangles, or a "
                "finer surface"
            )
        number[chosen] = k
    # Triangles that no group has chosen.
    names = list(groups)
    left = number < 0
    if rest and not left.any():
        raise Hint(f"no triangle is left for the group {rest[0]!r}", "no such group", [rest[0]])
    number[left] = names.index(rest[0]) if rest else len(names)
    if left.any() and not rest:
        names = _with_ungrouped(names)
    return tuple(names), number.astype(np.int64), tuple(notes)


def named_groups(name_of_face: Iterable[str]) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Return the names of the walls of a surface in alphabetical order, and the number of that of each triangle, (m,)."""
    given, number = np.unique(np.array(list(name_of_face), dtype=object).astype(str), return_inverse=True)
    # The order of the triangles in a file does not matter: numbers in names are in the order of their values.
    order = sorted(range(len(given)), key=lambda k: (not given[k], _natural(str(given[k]))))
    names = [str(given[k]) for k in order]
    check_names(filter(None, names))
    if "" in names:
        names = _with_ungrouped(names[:-1])
    return tuple(names), np.argsort(order)[number.reshape(-1)].astype(np.int64)


def _with_ungrouped(names: list[str]) -> list[str]:
    """Return names with that of the triangles in no group."""
    if UNGROUPED in names:
        with at(UNGROUPED):
            raise Hint(f"{UNGROUPED!r} is the name of the triangles that are in no group", "another name")
    return [*names, UNGROUPED]


def _natural(name: str) -> list[tuple[int, str]]:
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def _advice(group: FaceGroup, points: Vector, normals: Vector, across: int) -> str:
    """Return what to try for a group without a triangle: the smallest whole angle with which it has one, if there is one."""
    wide, _ = group.model_copy(update={"within": np.pi / 2}).select(points, normals)
    if group.facing is None or across or not wide.any():
        return "limits at edges of triangles, relative to the centre" + (
            ", or another direction" * (group.facing is not None)
        )
    angle = np.degrees(np.arccos(min(1.0, float(_likeness(group, normals)[wide].max()))))
    return f'within = "{min(90, np.ceil(angle)):.0f} deg"'


def _likeness(group: FaceGroup, normals: Vector) -> Vector:
    """Return the component of normals along the direction of a group, (m,)."""
    return np.asarray(normals @ unit_vector(group.facing)) if group.facing is not None else np.zeros(len(normals))


def _place(points: Vector) -> str:
    return f"({', '.join(f'{1e3 * x:.4g}' for x in points.mean(axis=0))}) mm from the centre"
