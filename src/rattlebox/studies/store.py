"""Studies on disk: a Zarr folder that grows block by block, and from which a study that was stopped goes on."""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
import socket
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.differences import differences
from rattlebox.model.errors import CaseError

from .blocks import Blocks

if TYPE_CHECKING:
    import xarray as xr

FORMAT = 1
"""Number of the layout; stores with a higher one are refused."""

Output = tuple[tuple[tuple[str, int], ...], Any, Mapping[str, Any]]
"""Further dimensions with their lengths, number type, attributes."""

JOURNAL = "trials.journal"
"""In which a design, which has no runs of its own, keeps its trials."""

_PROGRESS, _MAP = IN_STORE = "progress", "map"
"""Groups in a store beside the outputs."""


@dataclass(frozen=True)
class Plan:
    """What a study computes, and how the result is laid out.

    Attributes
    ----------
    dims, shape
        The grid of variants.
    outputs
        By name, what comes besides the dimensions of the grid.
    coords
        Coordinates of the result.
    about
        What the study is, in JSON's types; texts may be TOML. Stores that differ in it hold different studies.
    """

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    outputs: Mapping[str, Output]
    coords: Mapping[str, Any] = field(default_factory=dict)
    about: Mapping[str, Any] = field(default_factory=dict)

    @property
    def bytes_each(self) -> int:
        """Size of what is kept of a variant."""
        return sum(np.dtype(kind).itemsize * math.prod(n for _, n in extra) for extra, kind, _ in self.outputs.values())

    @cached_property
    def frame(self) -> xr.Dataset:
        """The coordinates and attributes, without numbers."""
        import xarray as xr

        texts = {name: about if isinstance(about, str) else json.dumps(about) for name, about in self.about.items()}
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return _with_texts(
            xr.Dataset(coords=dict(self.coords), attrs={"title": "Rattlebox study", "created": now, **texts})
        )

    @property
    def manifest(self) -> dict[str, Any]:
        """What tells this study from others, as JSON keeps it."""
        outputs = {
            name: " ".join([str(np.dtype(kind)), *(f"{dim}={length}" for dim, length in extra)])
            for name, (extra, kind, _) in self.outputs.items()
        }
        tree: dict[str, Any] = json.loads(json.dumps({**self.about, "outputs": outputs}))
        return tree

    def arrays(self) -> Iterator[tuple[str, tuple[str, ...], tuple[int, ...], np.dtype[Any], dict[str, Any]]]:
        """Return name, dimensions, shape, number type and attributes of each output."""
        for name, (extra, kind, attributes) in self.outputs.items():
            dims = (*self.dims, *(dim for dim, _ in extra))
            yield name, dims, (*self.shape, *(n for _, n in extra)), np.dtype(kind), dict(attributes)


class Memory:
    """A result that is kept in memory; used like a Store."""

    def __init__(self, plan: Plan, blocks: Blocks) -> None:
        self.blocks = blocks
        self.finished = np.zeros(len(blocks), bool)
        self._plan = plan
        self._arrays = {name: np.empty(shape, kind) for name, _, shape, kind, _ in plan.arrays()}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def write(self, block: int, values: Mapping[str, NDArray[Any]]) -> None:
        """Keep the result of a block."""
        region, sides = self.blocks.region(block), self.blocks.sides(block)
        for name, array in self._arrays.items():
            array[region] = values[name].reshape((*sides, *values[name].shape[1:]))
        self.finished[block] = True

    @property
    def done(self) -> int:
        """Number of variants that are there."""
        return self.blocks.variants(self.finished)

    def result(self) -> xr.Dataset:
        """Return all of it."""
        return self._plan.frame.assign(
            {name: (dims, self._arrays[name], attributes) for name, dims, _, _, attributes in self._plan.arrays()}
        )


class Store:
    """A study on disk, open for writing by this process alone.

    Each variable is cut into chunks as the study is into blocks, so that a block is one file of each variable.
    Files are written beside and renamed, and a block is marked finished after its last one: whatever ends the process,
    what is marked is whole.

    Parameters
    ----------
    path
        Folder of the study.
    plan
        What is computed.
    cut
        Cuts a new study into blocks; an old one keeps its own.

    Raises
    ------
    CaseError
        When the folder holds another study, with the differences, or something else; or when another process
        writes to it.
    OSError
        When the folder cannot be written.
    """

    def __init__(self, path: str | os.PathLike[str], plan: Plan, cut: Callable[[], Blocks]) -> None:
        self.path = Path(path)
        self._plan = plan
        with ExitStack() as stack:
            stack.enter_context(taken(self.path))
            with _telling(self.path), readable(self.path):
                self._open(cut)
            self._held = stack.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._held.close()

    def write(self, block: int, values: Mapping[str, NDArray[Any]]) -> None:
        """Put the result of a block on disk, then mark it finished.

        Raises
        ------
        OSError
            When the disk is full or the folder cannot be written any more.
        """
        region, sides = self.blocks.region(block), self.blocks.sides(block)
        with _telling(self.path):
            for name in self._plan.outputs:
                self._group[name][region] = values[name].reshape((*sides, *values[name].shape[1:]))
            self.finished[block] = True
            self._mask[...] = self.finished

    @property
    def done(self) -> int:
        """Number of variants that are there."""
        return self.blocks.variants(self.finished)

    def result(self) -> xr.Dataset:
        """Return all of it, read from disk when it is used."""
        return _open(self.path, list(self._plan.outputs))

    def _open(self, cut: Callable[[], Blocks]) -> None:
        if (self.path / _PROGRESS / JOURNAL).exists():
            raise CaseError(f"{self.path} holds a design\n  try: another folder, or remove this one")
        if (self.path / _PROGRESS / "finished" / "zarr.json").exists():
            _check_format(self.path)
            self._compare()
            for left in self.path.rglob("*.partial"):  # of a process that was killed while it wrote
                left.unlink(missing_ok=True)
        else:
            self._create(cut())
        self._group = _group(self.path, "r+")
        self._mask = self._group[f"{_PROGRESS}/finished"]
        self.finished: NDArray[np.bool_] = self._mask[...]
        self.blocks = _blocks(self._group)

    def _create(self, blocks: Blocks) -> None:
        """Write all but the numbers; the mask comes last and says that the rest is there."""
        import zarr

        for left in (*self.path.iterdir(), *(self.path / _PROGRESS).iterdir()):  # of a process that was killed here
            if left.name not in (_PROGRESS, "lock", "writer"):
                shutil.rmtree(left) if left.is_dir() else left.unlink()
        plan = self._plan
        kept = {"format": FORMAT, "shape": blocks.shape, "box": blocks.box, "manifest": plan.manifest}
        progress = zarr.create_group(self.path, path=_PROGRESS, attributes=kept)
        plan.frame.to_zarr(self.path, mode="a", zarr_format=3, consolidated=False)
        group = _group(self.path, "r+")
        for name, dims, shape, kind, attributes in plan.arrays():
            group.create_array(
                name,
                shape=shape,
                chunks=(*blocks.box, *shape[len(blocks.box) :]),
                dtype=kind,
                fill_value=_missing(kind),
                dimension_names=dims,
                attributes=attributes,
            )
        with warnings.catch_warnings():  # of the lock, and of a part of the format not agreed on that xarray asks for
            warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
            zarr.consolidate_metadata(group.store)
        progress.create_array("finished", shape=(len(blocks),), chunks=(len(blocks),), dtype="bool", fill_value=False)

    def _compare(self) -> None:
        there, here = _attributes(self.path)["manifest"], self._plan.manifest
        lines = differences(there, here)
        if not lines:
            return
        hint = "another folder, or remove this one"
        if len(lines) == 1 and there["core"] != here["core"]:
            hint = f"RATTLEBOX_SIMD={there['core']} in the environment, or another folder"
        raise CaseError("\n".join([f"{self.path} holds another study", *lines, f"  try: {hint}"]))


@contextmanager
def taken(path: Path) -> Iterator[Path]:
    """Be the only writer of a study; give the folder for what tells how far it is.

    Parameters
    ----------
    path
        Folder of the study, which need not exist.

    Raises
    ------
    CaseError
        When there is something else, or another process writes to it. The lock ends with its process, however that ends.
    OSError
        When the folder cannot be written.
    """
    from filelock import FileLock, Timeout

    progress = path / _PROGRESS
    if path.exists() and not progress.is_dir():
        if not path.is_dir():
            raise CaseError(f"{path} is a file; a study needs a folder\n  try: another name, as study.zarr")
        if any(path.iterdir()):
            raise CaseError(f"{path} holds other files\n  try: a folder that does not exist yet, as study.zarr")
    lock, name = FileLock(progress / "lock"), progress / "writer"
    with _telling(path):
        progress.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(blocking=False)
        except Timeout:
            writer = name.read_text() if name.exists() else "another process"
            raise CaseError(
                f"{path} is being written by {writer}\n"
                "  try: another folder, or wait; 'rattlebox show' tells how far it is"
            ) from None
    try:
        with _telling(path):
            name.write_text(f"process {os.getpid()} on {socket.gethostname()}")
        yield progress
    finally:
        lock.release()


@contextmanager
def _telling(path: Path) -> Iterator[None]:
    """Say of a disk that takes no more what that means for the study."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            said = "no space is left on the disk\n  try: make room and give the same command again, which goes on"
        else:
            said = f"the study cannot be written: {error.strerror or error}\n  try: another folder"
        raise OSError(error.errno, said, str(path)) from error


@contextmanager
def readable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Say of a study whose files are damaged that they are, and what to do.

    Parameters
    ----------
    path
        Folder of the study.

    Raises
    ------
    CaseError
        When they are.
    """
    try:
        yield
    except CaseError:
        raise
    except (ValueError, KeyError, RuntimeError, FileNotFoundError) as error:
        what = str(error).partition("\n")[0] or type(error).__name__
        raise CaseError(
            f"{path} is damaged: {what}\n  try: a copy of it, or remove it and give its command again"
        ) from error


def _with_texts(data: xr.Dataset) -> xr.Dataset:
    """The same with texts as Zarr has them, of any length."""
    return data.assign({name: data[name].astype(object) for name in data.variables if data[name].dtype.kind == "U"})


def keep_map(found: xr.Dataset, kind: str, path: str | os.PathLike[str] | None) -> xr.Dataset:
    """Say of a map which study it is, and put it beside the runs that it was made of.

    Parameters
    ----------
    found
        What was made of the runs of a study.
    kind
        Name of the study.
    path
        Folder of the study, if it has one. `open_study` then returns the map.

    Returns
    -------
    xarray.Dataset
        The map.

    Raises
    ------
    OSError
        When the folder cannot be written.
    """
    found = found.assign_attrs(study=kind)
    if path is not None:
        new, old = Path(path) / _PROGRESS / _MAP, Path(path) / _MAP
        with _telling(Path(path)):
            shutil.rmtree(new, ignore_errors=True)
            kept = _with_texts(found).drop_encoding().assign_attrs(variables=list(found.data_vars))
            kept.to_zarr(new, zarr_format=3, consolidated=False)
            shutil.rmtree(old, ignore_errors=True)
            new.rename(old)
    return found


@dataclass(frozen=True)
class Progress:
    """How far a study on disk is.

    Attributes
    ----------
    blocks
        How it is cut.
    finished
        Of each block, whether it is there, (len(blocks),).
    last
        When a block was last finished [s since 1970].
    """

    blocks: Blocks
    finished: NDArray[np.bool_]
    last: float

    @property
    def done(self) -> int:
        """Number of variants that are there."""
        return self.blocks.variants(self.finished)

    @property
    def total(self) -> int:
        """Number of variants of the study."""
        return math.prod(self.blocks.shape)


def has_map(path: str | os.PathLike[str]) -> bool:
    """Tell whether a study is a ready map that is finished."""
    return (Path(path) / _MAP).is_dir()


def open_study(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open a study, finished or not.

    Parameters
    ----------
    path
        Folder that `store=` or `rattlebox sweep -o` named.

    Returns
    -------
    xarray.Dataset
        Read from disk when it is used. Of a ready map, such as a bifurcation diagram, what the function returned; until that
        is finished, and of a sweep, the runs: what is not there is not-a-number, or the smallest number of an
        integer variable.

    Raises
    ------
    CaseError
        When there is no study.
    """
    if has_map(path):
        return _open(Path(path) / _MAP)
    with readable(path):
        _check_format(path)
        return _open(path, list(_attributes(path)["manifest"]["outputs"]))


def _open(path: str | os.PathLike[str], names: list[str] | None = None) -> xr.Dataset:
    """Variables in their order."""
    import xarray as xr

    with readable(path):
        data: xr.Dataset = xr.open_zarr(path, chunks=None, consolidated=False)
        return data[names or data.attrs.pop("variables")]


def progress_of(path: str | os.PathLike[str]) -> Progress:
    """Return how far a study on disk is, also while it runs.

    Parameters
    ----------
    path
        Folder of the study.

    Raises
    ------
    CaseError
        When there is no study.
    """
    with readable(path):
        _check_format(path)
        group = _group(path, "r")
        files = (Path(path) / _PROGRESS / "finished").rglob("*")
        last = max(file.stat().st_mtime for file in files)
        return Progress(_blocks(group), group[f"{_PROGRESS}/finished"][...], last)


def _group(path: str | os.PathLike[str], mode: Literal["r", "r+"]) -> Any:
    import zarr

    return zarr.open_group(path, mode=mode, use_consolidated=False)


def _attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """What is told of the study beside its progress."""
    attributes: dict[str, Any] = json.loads((Path(path) / _PROGRESS / "zarr.json").read_bytes())["attributes"]
    return attributes


def _check_format(path: str | os.PathLike[str]) -> None:
    if not (Path(path) / _PROGRESS / "finished" / "zarr.json").is_file():
        what = "is not a study" if Path(path).exists() else "is not there"
        raise CaseError(f"{path} {what}\n  try: the folder that 'rattlebox sweep -o' wrote")
    if _attributes(path)["format"] > FORMAT:
        raise CaseError(f"{path} was written by a later Rattlebox\n  try: update Rattlebox")


def _blocks(group: Any) -> Blocks:
    kept = group[_PROGRESS].attrs
    return Blocks(tuple(kept["shape"]), tuple(kept["box"]))


def _missing(kind: np.dtype[Any]) -> Any:
    """What stands for a number that is not there yet."""
    if kind.kind in "iu":
        return np.iinfo(kind).min if kind.kind == "i" else np.iinfo(kind).max
    return False if kind.kind == "b" else np.nan
