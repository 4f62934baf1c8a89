"""Base class of dampers: a cavity at a point of the structure, with balls or particles inside."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from .base import Part
from .space import Direction


class Damper(Part):
    """Base class of dampers."""

    field_names: ClassVar[tuple[str, ...]] = ("damper", "dampers")
    kind: str
    name: str = ""
    if TYPE_CHECKING:  # a field of each kind, at another place
        point: str | None

    @property
    @abstractmethod
    def mass(self) -> float:
        """Mass of the balls or particles [kg]."""

    @property
    @abstractmethod
    def base_direction(self) -> Direction | None:
        """Direction of a motion of the base; None if the damper moves along a line without a direction."""

    @property
    @abstractmethod
    def has_adjusted_dashpots(self) -> bool:
        """Whether the dashpots of contacts depend on the effective mass of the structure."""

    @property
    @abstractmethod
    def has_random_start(self) -> bool:
        """Whether repeated runs can start differently."""

    @abstractmethod
    def restarted(self, number: int, generator: np.random.Generator) -> Self:
        """Return the damper with the start of a repeated run; the first is number 0."""

    @abstractmethod
    def alike(self) -> Self:
        """Return the damper without the start, seed or rotation in which dampers with equal drawings differ."""

    @abstractmethod
    def each(self) -> Sequence[Self]:
        """Return the identical dampers that this one stands for, each with a start of its own."""

    @property
    def has_equal_cells(self) -> bool:
        """Whether the identical dampers that this one stands for have equal losses on average."""
        return True

    def check_packable(self) -> None:
        """Raise if the damper has what packed cases, of steppers and FMUs, cannot contain."""

    @abstractmethod
    def facts(self) -> list[tuple[str, str]]:
        """Return numbers that follow from the fields, with their names."""

    @abstractmethod
    def words(self) -> str:
        """Return a phrase about the damper for reports."""

    def label(self, index: int) -> str:
        """Return the name of the damper; by default it has the number of the damper in the case."""
        return self.name or ("damper" if index == 0 else f"damper{index + 1}")
