"""The space for particles in a cavity with bodies inside."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.quantities import amount

from .bodies import MOST_BODIES, Body, bodies_words
from .cavities import Cavity, Walls
from .elementwise import Vector
from .errors import Hint
from .necks import neck_notes, widest_sphere
from .solids import Solid, Solids
from .surfaces import Surface

_SAMPLES, _LEAST = 2**19, 2**11
"""Points on the surfaces of all bodies, and least number on one of them, by which areas are computed."""
_ON_WALLS = 2**17
"""Points on the faces of the cavity, by which the area under bodies is computed."""
_TOUCHING = (
    1e-7  # distance of two surfaces that touch, over the size of the cavity: files round coordinates to half of it
)
_STEPS, _HALVINGS, _SIGHT = 16, 24, 65  # points on an edge of a drawn body, halvings at the wall, points along the view
_SMALL = 0.05  # size of a body over the radius of a particle that suggests a wrong unit


class Interior(Cavity):
    """A cavity less the bodies inside."""

    kind: str
    shape: Cavity
    bodies: tuple[Body, ...]

    @classmethod
    def of(cls, shape: Cavity, bodies: Sequence[Body]) -> Cavity:
        """Return a cavity with bodies; the cavity itself without them."""
        return cls.model_construct(kind=shape.kind, shape=shape, bodies=tuple(bodies)) if bodies else shape

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """The bodies, with names of their own; an array of bodies has one name."""
        solids: list[Solid] = []
        names = list(self.shape.walls().names)
        total = sum(each.number for each in self.bodies)
        for each in self.bodies if total <= MOST_BODIES else ():
            name, number = each.label, 1
            while name in names:
                number += 1
                name = f"{each.label}{number}"
            names.append(name)
            solids += [replace(solid, name=name) for solid in each.solids(self.shape)]
        if max(total, len(solids)) > MOST_BODIES:
            raise Hint(f"{max(total, len(solids))} bodies are too many", f"at most {MOST_BODIES}", ["bodies"])
        return tuple(solids)

    @cached_property
    def _walls(self) -> Walls:
        walls = self.shape.walls()
        names = (*walls.names, *(solid.name for solid in self.solids))
        return replace(walls, names=names, solids=Solids((*walls.solids.each, *self.solids)))

    def walls(self) -> Walls:
        """Return the walls of the cavity and the bodies."""
        return self._walls

    @cached_property
    def _shares(self) -> list[float]:
        """Share of the volume of each body that is in the cavity, and in no body before it."""
        shares = []
        for k, solid in enumerate(self.solids):
            points = solid.samples(len(self.solids))
            free = self.shape.depth(points) >= 0
            for other in _overlapping(solid, self.solids[:k]):
                free &= ~other.is_within(points)
            shares.append(float(free.mean()))
        return shares

    @cached_property
    def volume(self) -> float:
        """Volume of the space for particles [m^3]; a body that is partly in a wall or another body counts by points."""
        taken = sum(share * solid.volume for share, solid in zip(self._shares, self.solids, strict=True))
        return self.shape.volume - taken

    @property
    def lengths(self) -> Vector:
        """Edges of the bounding box of the cavity, (3,) [m]."""
        return self.shape.lengths

    @property
    def inside(self) -> Vector:
        """Zeros: no box is known to be free, (3,) [m]."""
        return np.zeros(3)

    @property
    def frame(self) -> Vector:
        """Axes of the cavity, (3, 3)."""
        return self.shape.frame

    def face_instead(self, name: str, labels: Sequence[str]) -> str:
        """Return that of the cavity."""
        return self.shape.face_instead(name, labels)

    @cached_property
    def face_areas(self) -> Vector:
        """Area of each face of the cavity, then of each body, (f,) [m^2]; the bodies of an array are one face.

        The areas are those inside the cavity and outside all other bodies, computed from points on the surfaces.
        """
        labels = self.walls().labels
        areas = np.zeros(len(labels))
        count, tiny = max(_LEAST, _SAMPLES // len(self.solids)), _TOUCHING * float(self.lengths.max())
        faces = self.shape.face_areas
        areas[: len(faces)] = faces * (1 - self._covered(len(faces), tiny))
        for k, solid in enumerate(self.solids):
            points, normals = solid.surface_samples(count)
            free = self.shape.depth(points) > tiny
            for other in _overlapping(solid, self.solids, tiny):
                # Bodies that touch have no particles between them; of two in one place, the surface is that of the first.
                rest = np.flatnonzero(free)
                covered = other.is_within(points[rest] + tiny * normals[rest])
                if other in self.solids[:k]:
                    covered |= other.is_within(points[rest] - tiny * normals[rest])
                free[rest] = ~covered
            areas[labels.index(solid.name)] += float(free.mean()) * solid.area
        return areas

    def _covered(self, faces: int, tiny: float) -> Vector:
        """Return the share of each face of the cavity that is in bodies, or on them within a distance [m], (f,)."""
        walls = self.shape.walls()
        points, inward = self.shape.surface().spread(_ON_WALLS)
        label = walls.label_numbers[np.abs(walls.distances(points)).argmin(axis=1)]
        points += tiny * inward
        covered = np.zeros(len(points), bool)
        for solid in self.solids:
            low, high = solid.bounds
            near = np.flatnonzero(((points > low) & (points < high)).all(axis=1) & ~covered)
            covered[near] = solid.is_within(points[near])
        return np.bincount(label, covered, faces) / np.maximum(np.bincount(label, minlength=faces), 1)

    @property
    def period(self) -> Vector:
        """That of the cavity, (3,) [m]."""
        return self.shape.period

    def surface(self) -> Surface:
        """Return the polygons of the cavity and of the bodies."""
        parts = [self.shape.surface(), *(solid.surface() for solid in self.solids)]
        starts = np.cumsum([0, *(len(part.points) for part in parts)])
        polygons = (
            tuple(int(corner + start) for corner in polygon)
            for part, start in zip(parts, starts, strict=False)
            for polygon in part.polygons
        )
        return Surface(np.concatenate([part.points for part in parts]), tuple(polygons))

    def outline(self, view: Vector) -> list[Vector]:
        """Return the lines of the cavity, and what is seen of those of the bodies, which may reach out of it."""
        bodies = [(solid, line) for solid in self.solids for line in solid.surface().lines(view[2])]
        parts = [part for solid, line in bodies for part in self._seen_parts(solid, line, view[2])]
        return [*self.shape.outline(view), *parts]

    def _seen_parts(self, solid: Solid, line: Vector, towards_viewer: Vector) -> list[Vector]:
        """Return the parts of a line of a body at which a viewer sees the body in the cavity, each (n, 3) [m]."""
        steps = np.linspace(line[:-1], line[1:], _STEPS, endpoint=False).transpose(1, 0, 2)
        points = np.concatenate([steps.reshape(-1, 3), line[-1:]])
        seen = self._is_seen(solid, points, towards_viewer)
        if seen.all():
            return [line]
        last = np.flatnonzero(seen[1:] != seen[:-1])
        a, b = points[last], points[last + 1]
        for _ in range(_HALVINGS):
            middle = (a + b) / 2
            same = (self._is_seen(solid, middle, towards_viewer) == seen[last])[:, None]
            a, b = np.where(same, middle, a), np.where(same, b, middle)
        points, seen = np.insert(points, last + 1, a, axis=0), np.insert(seen, last + 1, True)
        ends = np.flatnonzero(np.diff(seen.astype(int), prepend=0, append=0)).reshape(-1, 2)
        return [points[first:end] for first, end in ends if end - first > 1]

    def _is_seen(self, solid: Solid, points: Vector, towards_viewer: Vector) -> NDArray[np.bool_]:
        """Return whether some of a body that is in the cavity is in front of points of its surface or behind them, (n,)."""
        size = float(self.lengths.max())
        seen: NDArray[np.bool_] = self.shape.depth(points) >= -_TOUCHING * size
        rest = np.flatnonzero(~seen)
        low, high = solid.bounds
        # Points of the surface are moved inside, where rounding does not decide.
        start = points[rest] + _TOUCHING * ((low + high) / 2 - points[rest])
        reach = float(np.linalg.norm(high - low))
        sight = start[:, None] + np.linspace(-reach, reach, _SIGHT)[:, None] * towards_viewer
        both = solid.is_within(sight.reshape(-1, 3))
        both[both] = self.shape.depth(sight.reshape(-1, 3)[both]) >= 0
        seen[rest] = both.reshape(-1, _SIGHT).any(axis=1)
        return seen

    def extent(self, direction: Vector) -> float:
        """Return the width of the cavity along a unit vector [m]."""
        return self.shape.extent(direction)

    @property
    def surface_over_volume(self) -> float:
        """Area of walls and bodies over the volume [1/m]."""
        area = self.shape.surface_over_volume * self.shape.volume
        area += sum(share * solid.area for share, solid in zip(self._shares, self.solids, strict=True))
        return area / self.volume

    def notes(self, radius: float) -> Iterator[str]:
        """Yield notes on the bodies, and where spheres do not pass."""
        for each in self.bodies:
            yield from each.notes()
        sizes: dict[str, float] = {}
        for solid in self.solids:
            low, high = solid.bounds
            sizes[solid.name] = max(sizes.get(solid.name, 0.0), float((high - low).max()))
        for name, size in sizes.items():
            if size < _SMALL * radius:
                yield (
                    f"warning: the body {name!r} has a size of {amount(size, 'm')}, too small to matter for particles of "
                    f"{amount(2 * radius, 'm')}; try: another unit for its sizes, or no body"
                )
        yield from neck_notes(self, radius)

    @cached_property
    def widest(self) -> float:
        """Diameter of the largest sphere inside [m]."""
        return 2 * widest_sphere(self)

    @property
    def digest(self) -> str:
        """Text that differs for other walls or bodies."""
        return " ".join([self.shape.digest, *(each.digest for each in self.bodies)])

    def check(self) -> None:
        """Raise if a body is outside of the cavity, or if the bodies leave no space."""
        if self.shape.period.any():
            raise Hint("a periodic cavity cannot contain bodies", "walls in place of periodic", ["bodies"])
        inside: dict[str, bool] = {}
        for solid, share in zip(self.solids, self._shares, strict=True):
            # The outer plates of an array may be outside of the cavity, but not all of them.
            is_inside = share > 0 or bool(self.shape.depth(solid.samples(len(self.solids))).max() >= 0)
            inside[solid.name] = inside.get(solid.name, False) or is_inside
        for name, is_inside in inside.items():
            if not is_inside:
                raise Hint(
                    f"the body {name!r} is outside of the cavity",
                    "a position relative to the centre of the cavity, in metres or with units",
                    ["bodies"],
                )
        if not self.volume > 0 or self.widest <= 0:
            raise Hint("the bodies fill the whole cavity", "smaller bodies", ["bodies"])

    def words(self) -> str:
        """Return a phrase about the cavity and its bodies."""
        return f"{self.shape.words()}, {bodies_words(self.bodies)}"


def _overlapping(solid: Solid, others: Sequence[Solid], tolerance: float = 0.0) -> list[Solid]:
    """Return the other bodies that may reach into a body, or are at most a distance from it [m]."""
    low, high = solid.bounds[0] - tolerance, solid.bounds[1] + tolerance
    return [
        other
        for other in others
        if other is not solid and (other.bounds[0] < high).all() and (other.bounds[1] > low).all()
    ]
