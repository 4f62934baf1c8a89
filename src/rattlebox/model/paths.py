"""Paths to values in a case, such as "damper.ball.radius"."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar, get_args

import numpy as np
from pydantic import ValidationError

from rattlebox._util.narrow import instance

from .as_written import Given
from .base import Part, vocabulary
from .dampers import ImpactDamper
from .errors import Hint, nearest, several, translate
from .materials import Material
from .signals import Signal
from .units import SI

Place = tuple[str | int, ...]
AnyPart = TypeVar("AnyPart", bound=Part)  # a case; any other part has paths, too

_EDGES = {"length": 0, "width": 1, "depth": 1, "height": 2}  # synonyms of the edges of a box
_STEP = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")


def place_of(case: Part, path: str) -> Place:
    """Return the place in a case that a path refers to."""
    place: list[str | int] = []
    node: Any = case
    steps = _steps(path)
    for number, step in enumerate(steps):
        so_far = "".join(_words(steps[:number]))
        # "dampers.gap" means the only damper.
        if isinstance(step, str) and _is_row_of_parts(node):
            node = node[_only(node, path, so_far)]
            place.append(0)
        if isinstance(step, int):
            if not isinstance(node, (tuple, list, np.ndarray)):
                raise Hint(f"{path}: {so_far or 'a case'} is not a list", "the same without an index in brackets")
            if step >= len(node):
                raise Hint(
                    f"{path}: {so_far} has {several(len(node), 'item')}, counted from 0",
                    f"an index of at most {len(node) - 1}" if len(node) else "",
                )
            place.append(step)
            node = node[step]
        elif isinstance(node, Part):
            # "damper" at the end of a path is the only item of "dampers".
            alias = type(node).aliases.get(step)
            if (alias or step) not in type(node).model_fields:
                known = {*type(node).model_fields, *type(node).aliases} - {"kind"}
                raise Hint(f"{path}: there is no {step!r} in {so_far or 'a case'}", _suggested(case, path, step, known))
            place.append(alias or step)
            node = get_field(node, alias or step)
            if alias and number == len(steps) - 1 and node:
                place.append(_only(node, path, "".join(_words(steps))))
        elif isinstance(node, dict) and step in node:
            place.append(step)
            node = node[step]
        elif node is None:
            raise Hint(f"{path}: {so_far} is not set in this case", f"give {so_far} as a whole")
        elif isinstance(node, dict):
            holder = part_at(case, place[:-1])
            raise Hint(f"{path}: there is no {step!r} in {so_far}", holder.absent_item(str(place[-1]), step))
        else:
            raise Hint(f"{path}: there is no {step!r} in {so_far}", _suggested(case, path, step, set()))
    return tuple(place)


def spelt(case: Part, place: Place) -> str:
    """Return the shortest path to a place: "damper.gap" for a single damper, else "dampers[0].gap"."""
    words = list(_words(place))
    for number, step in enumerate(place):
        row = part_at(case, place[:number])
        if isinstance(step, int) and _is_row_of_parts(row) and len(row) == 1:
            holder = part_at(case, place[: number - 1])
            words[number] = ""
            others = [other for other, name in type(holder).aliases.items() if name == place[number - 1]]
            if others:
                words[number - 1] = words[number - 1].replace(str(place[number - 1]), others[0])
    return "".join(words)


def get(case: Part, path: str) -> Any:
    """Return the value at a path, in SI units."""
    return part_at(case, place_of(case, path))


def part_at(case: Part, place: Sequence[str | int]) -> Any:
    """Return the value at a place."""
    node: Any = case
    for step in place:
        node = get_field(node, str(step)) if isinstance(node, Part) else node[step]
    return node


def get_field(part: Part, name: str) -> Any:
    """Return a field of a part; diameters and lengths of cavities are computed from radii and gaps."""
    if name == "diameter":
        radius = getattr(part, "radius", None)
        return None if radius is None else 2 * radius
    if isinstance(part, ImpactDamper) and name == "cavity_length":
        return part.clearance + part.row
    return getattr(part, name)


def unit_of(case: Part, path: str) -> str | None:
    """Return the SI unit of the numbers at a path, "1" for dimensionless numbers, None for other values."""
    place = place_of(case, path)
    node: Any = case
    unit: str | None = None
    for step in place:
        if isinstance(node, Part):
            step = instance(step, str)
            unit = unit_of_field(node, step)
            node = get_field(node, step)
        else:
            node = node[step]
    return unit


def unit_of_field(part: Part, name: str) -> str | None:
    """Return the SI unit of the numbers of a field, "1" for dimensionless numbers, None for other values."""
    if isinstance(part, Signal) and name in ("amplitude", "values"):
        return part.unit
    field = type(part).model_fields[name]
    return next(_units([*field.metadata, field.annotation]), None)


def _units(annotations: Sequence[object]) -> Iterator[str]:
    """Yield the SI units in annotations; "1" for plain numbers comes last."""
    for annotation in annotations:
        if isinstance(annotation, SI):
            yield annotation.unit
        yield from _units([item.unit for item in getattr(annotation, "__metadata__", ()) if isinstance(item, SI)])
        yield from _units(get_args(annotation))
    if any(annotation in (int, float) for annotation in annotations):
        yield "1"


def replaced(case: AnyPart, values: Mapping[str, object]) -> AnyPart:
    """Return a copy of a case with other values.

    A new value removes alternatives that exclude it: a damping ratio replaces a damping. Dampers store their gap: balls of
    another radius do not change the gap unless the length of the cavity is given as well.
    """
    places = places_of(case, values)
    tree: Any = case
    for place in sorted(places, key=len):  # whole parts before their fields
        tree = _with(tree, place, places[place])
    tree = _briefly(tree, (type(case), ImpactDamper))
    own = {material.name: material for material in _materials(case)}
    try:
        return type(case).model_validate(tree, context=own)
    except ValidationError as error:
        raise translate(error, "case", vocabulary(), tree) from None


def places_of(case: Part, values: Mapping[str, object]) -> dict[Place, Any]:
    """Return values by place, with None at the places of alternatives that they exclude."""
    paths: dict[Place, str] = {}
    for path in values:
        place = place_of(case, path)
        if place in paths:
            raise Hint(f"{path} and {paths[place]} are the same", "one of them")
        paths[place] = path
    places = {place: values[path] for place, path in paths.items()}
    for place, path in paths.items():
        for length, step in enumerate(place):
            holder = part_at(case, place[:length])
            if isinstance(holder, Part) and step in holder.fields_from_file():
                raise Hint(
                    f"{path}: the value was read from {getattr(holder, 'file', None)}",
                    "numbers in the case in place of the file",
                )
        if places[place] is None:
            continue
        *above, name = place
        holder = part_at(case, above)
        if isinstance(holder, Part):
            for other in holder.excludes(str(name), places[place]):
                places.setdefault((*above, other), None)
    return places


def _with(node: Any, place: Place, value: Any) -> Any:
    """Return a copy with another value at a place, in which the parts above it are dicts."""
    if not place:
        return value
    step, *rest = place
    if isinstance(step, int):
        return [_with(item, tuple(rest), value) if i == step else item for i, item in enumerate(node)]
    fields = node.as_given() if isinstance(node, Part) else node
    if not isinstance(fields, dict):
        raise Hint(f"there is no {step!r} in {node!r}", "a whole part, or fields of it, not both")
    return Given.changed(node, {**fields, step: _with(fields.get(step), tuple(rest), value)}, step)


def _briefly(node: object, kinds: Sequence[type[Part]]) -> Any:
    """Return a copy with aliases such as "damper" for lists of one item, as in messages."""
    if isinstance(node, list):
        return [_briefly(item, kinds) for item in node]
    if not isinstance(node, dict):
        return node
    tree = Given.changed(node, {name: _briefly(item, kinds) for name, item in node.items()})
    for part in kinds:
        for other, name in part.aliases.items():
            if isinstance(tree.get(name), list) and len(tree[name]) == 1:
                tree[other] = tree.pop(name)[0]
    return tree


def _materials(node: object) -> Iterator[Material]:
    if isinstance(node, Material):
        yield node
    elif isinstance(node, Part):
        for name in type(node).model_fields:
            yield from _materials(getattr(node, name))
    elif isinstance(node, (tuple, Mapping)):
        for item in node.values() if isinstance(node, Mapping) else node:
            yield from _materials(item)


def all_paths(case: Part) -> list[str]:
    """Return the paths of all fields of a case, as short as they can be."""
    return [spelt(case, place) for place in _places(case, ())]


def _places(node: Any, place: Place) -> Iterator[Place]:
    if isinstance(node, Part):
        for name in type(node).model_fields:
            if name != "kind":
                yield (*place, name)
                yield from _places(getattr(node, name), (*place, name))
    elif _is_row_of_parts(node):
        for number, item in enumerate(node):
            yield from _places(item, (*place, number))


def _is_row_of_parts(value: object) -> bool:
    return isinstance(value, tuple) and (not value or isinstance(value[0], Part))


def _only(row: Sequence[object], path: str, name: str) -> int:
    """Return the index of the only item of a list, 0."""
    if not row:
        raise Hint(f"{path}: there is no {name} in this case", f"a case with a {name}, or another path")
    if len(row) > 1:
        raise Hint(
            f"{path}: the case has {len(row)} of {name}, and an index is needed", f"{name}[0] to {name}[{len(row) - 1}]"
        )
    return 0


def _steps(path: str) -> list[str | int]:
    """Return the names and indices of a path."""
    steps: list[str | int] = []
    end = 0
    for match in _STEP.finditer(path):
        if match.start() != end or (match.start() == 0 and match[0][0] in ".["):
            break
        steps.append(match[1] if match[2] is None else int(match[2]))
        end = match.end()
    if end != len(path) or not steps:
        raise Hint(
            f"{path!r} is not a path", 'names with dots between and numbers in brackets: "dampers[1].ball.radius"'
        )
    return steps


def _words(steps: Sequence[str | int]) -> Iterator[str]:
    for number, step in enumerate(steps):
        yield f"[{step}]" if isinstance(step, int) else f".{step}" if number else step


def _suggested(case: Part, path: str, step: str, known: set[str]) -> str:
    """Return a suggestion of existing paths similar to one that does not exist."""
    if step in _EDGES and "size" in known:
        return f"did you mean '{path.removesuffix(step)}size[{_EDGES[step]}]'?"
    near = nearest(step, known)
    if near.startswith("did"):
        return near
    everywhere = all_paths(case)
    like = [other for other in everywhere if re.split(r"[.\[]", other)[-1] == re.split(r"[.\[]", path)[-1]]
    like = like or get_close_matches(path, everywhere, n=2, cutoff=0.6)
    if like:
        return "did you mean " + " or ".join(map(repr, like[:3])) + "?"
    return nearest(step, known) if known else ""
