"""Contact laws of a particle damper: those that a user states for pairs, and one entry for each kind of pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from rattlebox._util.exceptions import named

from .base import Part
from .contacts import AnyContact, Linear
from .errors import Hint
from .friction import AnyFriction, AnyRolling, Friction, Rolling
from .pairs import Pair

WALL = "wall"


def _two_names(value: object) -> Any:
    """Raise if a pair has one name; a pair of equal particles has the same name twice."""
    names = [value] if isinstance(value, str) else value
    if isinstance(names, (list, tuple)) and len(names) == 1 and isinstance(names[0], str):
        one = names[0]
        like = f'["{one}", "{WALL}"], or ["{one}", "{one}"] among themselves' if one != WALL else f'["steel", "{WALL}"]'
        raise Hint("two names are needed", like)
    return value


class PairLaws(Part):
    """Laws between two species, or a species and the wall, in place of the laws of the damper.

    Parameters
    ----------
    between
        Names of two species, or of a species and "wall".
    contact, friction, rolling
        Laws of the pair; default those of the damper. friction = 0 is no friction.
    """

    field_names: ClassVar[tuple[str, ...]] = ("pairs",)
    between: Annotated[tuple[str, str], BeforeValidator(_two_names)] = Field(examples=[["shot", "wall"]])
    contact: AnyContact | None = None
    friction: AnyFriction | None = None
    rolling: AnyRolling | None = None


@dataclass(frozen=True)
class Entry:
    """Laws of one kind of pair."""

    pair: Pair
    contact: AnyContact
    friction: Friction | None
    rolling: Rolling | None
    names: tuple[str, str]
    at_wall: bool
    place: tuple[str | int, ...]
    friction_place: tuple[str | int, ...]
    rolling_place: tuple[str | int, ...]

    def check_friction(self) -> None:
        """Raise if friction or rolling resistance does not suit the contact law."""
        between = " and ".join(self.names)
        if self.rolling is not None and self.rolling.coefficient and not (self.friction and self.friction.coefficient):
            raise Hint(
                f"rolling resistance needs friction, and there is none between {between}",
                f"{named(self.friction_place)} = 0.3, or no rolling",
                self.rolling_place,
            )
        linear = isinstance(self.contact, Linear)
        if self.friction is not None and (found := self.friction.unsuited(linear=linear)) is not None:
            need, advice = found
            kind = "linear" if linear else "not linear"
            raise Hint(f"{need}, but that of {between} is {kind}", advice, self.friction_place)


@dataclass(frozen=True)
class ContactTable:
    """Entries of all kinds of pairs in a damper."""

    entries: tuple[Entry, ...]
    particle_entry: NDArray[np.int64]  # Index of the entry of two species, (k, k)
    wall_entry: NDArray[np.int64]  # Index of the entry of a species and a kind of wall, (k, w)
    wall_kind: NDArray[np.int64]  # Kind of each wall, (walls,)

    def at_wall(self, species: int, wall: int) -> Entry:
        """Return the entry of a species and a wall."""
        return self.entries[int(self.wall_entry[species, self.wall_kind[wall]])]


def check_alike(what: str, given: Sequence[tuple[str, tuple[str | int, ...]]]) -> None:
    """Raise if the given words, each with its place, differ: such laws cannot be combined in a damper."""
    for word, place in given:
        if word != given[0][0]:
            raise Hint(
                f"{word} and {given[0][0]} cannot be combined: one {what} is needed among particles, and one at walls",
                f"{given[0][0]} in both",
                place,
            )
