"""Layout of the result of a study, and the result in memory."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import ResourceError
from rattlebox.model.particle_damper import memory
from rattlebox.studies.work.blocks import Blocks
from rattlebox.studies.work.work import Output

if TYPE_CHECKING:
    import xarray as xr


class Variable(NamedTuple):
    """An output as xarray and Zarr hold it."""

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    attributes: dict[str, Any]

    @property
    def missing(self) -> Any:
        """Value that stands for a variant that is not computed: NaN, or the smallest integer."""
        if self.dtype.kind in "iu":
            return np.iinfo(self.dtype).min if self.dtype.kind == "i" else np.iinfo(self.dtype).max
        return False if self.dtype.kind == "b" else np.nan


@dataclass(frozen=True)
class Plan:
    """Outputs of a study over its grid."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    outputs: Mapping[str, Output]
    coords: Mapping[str, Any] = field(default_factory=dict)
    about: Mapping[str, Any] = field(default_factory=dict)

    @property
    def bytes_each(self) -> int:
        """Size of the outputs of one variant [bytes]."""
        return sum(np.dtype(kind).itemsize * math.prod(n for _, n in extra) for extra, kind, _ in self.outputs.values())

    @cached_property
    def frame(self) -> xr.Dataset:
        """Result without its variables: coordinates and attributes."""
        import xarray as xr

        texts = {name: about if isinstance(about, str) else json.dumps(about) for name, about in self.about.items()}
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return with_texts(
            xr.Dataset(coords=dict(self.coords), attrs={"title": "Rattlebox study", "created": now, **texts})
        )

    @property
    def manifest(self) -> dict[str, Any]:
        """Description that distinguishes this study from others, in JSON types."""
        outputs = {
            name: " ".join([str(np.dtype(kind)), *(f"{dim}={length}" for dim, length in extra)])
            for name, (extra, kind, _) in self.outputs.items()
        }
        tree: dict[str, Any] = json.loads(json.dumps({**self.about, "outputs": outputs}))
        return tree

    def variables(self) -> Iterator[Variable]:
        """Return the variables of the result."""
        for name, (extra, kind, attributes) in self.outputs.items():
            dims = (*self.dims, *(dim for dim, _ in extra))
            yield Variable(name, dims, (*self.shape, *(n for _, n in extra)), np.dtype(kind), dict(attributes))


def with_texts(data: xr.Dataset) -> xr.Dataset:
    """Return a dataset with its texts as objects, which Zarr stores at any length."""
    return data.assign({name: data[name].astype(object) for name in data.variables if data[name].dtype.kind == "U"})


class MemoryResult:
    """A result in memory, with the interface of a Store."""

    def __init__(self, plan: Plan, blocks: Blocks) -> None:
        self.blocks = blocks
        self.finished = np.zeros(len(blocks), bool)
        self._plan = plan
        size = plan.bytes_each * math.prod(plan.shape)
        if size > memory():
            raise ResourceError(
                f"the results of {math.prod(plan.shape):.3g} variants take {1e-9 * size:.3g} GB, and this machine has "
                f"{1e-9 * memory():.3g} GB",
                'a store, store="study.zarr", or fewer variants',
            )
        self._arrays = {variable.name: np.empty(variable.shape, variable.dtype) for variable in plan.variables()}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def has_state(self, block: int) -> bool:
        """Return whether the state at the end of a block is stored; never in memory, where no study resumes."""
        return False

    def state(self, block: int) -> dict[str, NDArray[Any]]:
        """Return the state at the end of a block: none."""
        return {}

    def write(self, block: int, values: Mapping[str, NDArray[Any]], stale: Sequence[int] = ()) -> None:
        """Store the outputs of a block."""
        region, sides = self.blocks.region(block), self.blocks.sides(block)
        for name, array in self._arrays.items():
            array[region] = values[name].reshape((*sides, *values[name].shape[1:]))
        self.finished[block] = True

    @property
    def done(self) -> int:
        """Number of finished variants."""
        return self.blocks.variants(self.finished)

    def result(self) -> xr.Dataset:
        """Return the result."""
        return self._plan.frame.assign(
            {each.name: (each.dims, self._arrays[each.name], each.attributes) for each in self._plan.variables()}
        )
