"""Vectors and directions in 3-D, with axes x, y, z."""

from __future__ import annotations

import json
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

from .elementwise import Vector
from .errors import Hint, at
from .units import SI, numbers, parse

AXES = ("x", "y", "z")
Triple = tuple[float, float, float]


def _three(value: object, what: str, example: str) -> list[Any]:
    if not isinstance(value, (list, tuple, np.ndarray)) or len(value) != 3:
        raise Hint(f"three {what}, along x, y and z, are needed", example)
    return list(value)


def triple(unit: str, what: str, example: str) -> Any:
    """Return the annotations of a field that holds three quantities in this SI unit."""

    def read(value: object) -> Triple:
        read = []
        for index, item in enumerate(_three(value, what, example)):
            with at(index):
                try:
                    read.append(parse(item, (unit,))[0])
                except Hint as hint:
                    raise hint.restated(suggestion=hint.suggestion or f"three {what}, such as {example}") from None
        return read[0], read[1], read[2]

    item = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    schema = {
        "type": "array",
        "items": item,
        "minItems": 3,
        "maxItems": 3,
        "description": f"{what}, in {unit}",
        "examples": [json.loads(example)],
    }
    return SI(unit), BeforeValidator(read), WithJsonSchema(schema)


def _direction(value: object) -> Any:
    if isinstance(value, str):
        if value.removeprefix("-") not in AXES:
            raise Hint("a direction is x, y, z, one of them with a minus, or three numbers", '"z"')
        return value
    try:
        vector = numbers(_three(value, "numbers", "[0, 0, 1]"))
    except Hint as hint:
        raise hint.restated(suggestion=hint.suggestion or "[0, 0, 1]") from None
    if not np.linalg.norm(vector) > 0:
        raise Hint("a direction must not be zero", "[0, 0, 1]")
    return tuple(vector.tolist())


Direction = Annotated[
    str | Triple,
    BeforeValidator(_direction),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": [sign + axis for sign in ("", "-") for axis in AXES]},
                {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
            ],
            "description": "x, y, z, one of them with a minus, or three numbers of any length",
        }
    ),
]


def unit_vector(direction: str | Triple) -> Vector:
    """Return a direction as a vector of length one, (3,)."""
    if isinstance(direction, str):
        vector = np.zeros(3)
        vector[AXES.index(direction[-1])] = -1.0 if direction[0] == "-" else 1.0
        return vector
    vector = np.array(direction)
    return np.asarray(vector / np.linalg.norm(vector))


def axis_of(direction: str | Triple) -> str:
    """Return x, y, z, or one of them with a minus, if a direction is along an axis; else an empty text."""
    vector = unit_vector(direction)
    number = int(np.argmax(np.abs(vector)))
    if abs(vector[number]) < 1 - 1e-12:
        return ""
    return ("-" if vector[number] < 0 else "") + AXES[number]


def components_along(vectors: Vector, axis: Vector) -> Vector:
    """Return the components of vectors along an axis, (n,).

    `@` would call BLAS, whose last bits depend on the processor; packings have the same bits on all of them.
    """
    return np.asarray(np.einsum("ij,j->i", vectors, axis))


def to_global(coordinates: Vector, frame: Vector) -> Vector:
    """Return vectors along x, y and z from their coordinates in a frame with one axis in each row, (n, 3).

    Without BLAS; see `components_along`.
    """
    return np.asarray(np.einsum("ij,jk->ik", coordinates, frame))


def wrapped(positions: Vector, period: Vector) -> Vector:
    """Return positions with those of the images in [-L/2, L/2) along the axes with a period L > 0, (n, 3)."""
    if not np.any(period):
        return positions
    length = np.where(period > 0, period, np.inf)
    inside = positions - period * np.floor(positions / length + 0.5)
    # Rounding may leave a position beyond an end; both ends are images of each other.
    return np.where((inside >= 0.5 * length) | (inside < -0.5 * length), -0.5 * period, inside)


def to_nearest_image(branch: Vector, period: Vector) -> Vector:
    """Return branch vectors to the nearest images along the axes with a period, (n, 3)."""
    if not np.any(period):
        return branch
    return np.asarray(branch - period * np.rint(branch / np.where(period > 0, period, np.inf)))


def rotated(vectors: Vector, axis: Vector, angle: Any) -> Vector:
    """Return vectors, (..., 3), after a rotation about a unit vector by an angle, or by one for each vector [rad]."""
    angle = np.asarray(angle)[..., None]
    along = (vectors @ axis)[..., None] * axis
    return np.asarray(along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(axis, vectors))


Accelerations = Annotated[Triple, *triple("m/s^2", "accelerations", "[0, 0, -9.81]")]
Velocities = Annotated[Triple, *triple("m/s", "velocities", "[0.1, 0, 0]")]
Lengths = Annotated[Triple, *triple("m", "lengths", '["40 mm", "40 mm", "60 mm"]')]
