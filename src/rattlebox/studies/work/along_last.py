"""Order of variants that start from the final state of each other, along the last dimension of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.work.blocks import Blocks
from rattlebox.studies.work.case_work import CaseWork

if TYPE_CHECKING:
    from rattlebox.model.case import Case


@dataclass
class AlongLast(CaseWork):
    """Work whose variants run one after the other along the last dimension of the grid."""

    directions: tuple[str, ...] = ("up",)
    turn_back: bool = False

    @classmethod
    def along(
        cls, case: Case, grid: Grid, *, directions: Sequence[str], turn_back: bool = False, **options: Any
    ) -> Self:
        """Return the work along the last dimension of a grid."""
        coordinate = "direction", np.array(directions), {"long_name": "direction"}
        full_grid = Grid(
            ("direction", *grid.dims),
            (len(directions), *grid.shape),
            {path: column[None] for path, column in grid.columns.items()},
            {"direction": coordinate, **grid.coords()},
        )
        return cls(case, full_grid, directions=tuple(directions), turn_back=turn_back, **options)

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return {**super().describe(), "directions": list(self.directions), "turn_back": self.turn_back}

    @property
    def has_states(self) -> bool:
        """Whether the state at the end of a variant is not among the outputs."""
        return False

    def direction(self, index: int) -> str:
        """Return the direction of a variant."""
        return self.directions[index * len(self.directions) // self.size]

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each chain in order of execution."""
        rows = np.arange(len(blocks)).reshape(len(self.directions), -1, blocks.counts[-1])
        chains = [row if way == "up" else row[:, ::-1] for way, row in zip(self.directions, rows, strict=True)]
        if self.turn_back:
            chains = [np.concatenate(chains, axis=1)]
        return [chain.tolist() for rows in chains for chain in rows]

    def order(self, start: int, stop: int) -> range:
        """Return the variants of a block in order of execution."""
        return range(start, stop) if self.direction(start) == "up" else range(stop - 1, start - 1, -1)
