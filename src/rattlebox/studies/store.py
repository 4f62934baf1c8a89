"""Studies on disk: a Zarr folder that grows block by block, and from which a study that was stopped goes on."""

from __future__ import annotations

import errno
import json
import math
import os
import re
import socket
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, RattleboxError, ResourceError, StoreError
from rattlebox._util.owned_folder import (
    MARKER,
    DamagedError,
    ForeignFile,
    Marker,
    damaged_files,
    fill,
    is_free,
    read_marker,
    write_marker,
)
from rattlebox.model.differences import differences

from .blocks import Blocks

if TYPE_CHECKING:
    import xarray as xr

FORMAT = 2
"""Number of the layout; stores with a higher one are refused."""

KIND = "Rattlebox study"
"""Kind of folder in the marker of a study."""

_MAP_KIND = "Rattlebox map"

Output = tuple[tuple[tuple[str, int], ...], Any, Mapping[str, Any]]
"""Further dimensions with their lengths, number type, attributes."""

JOURNAL = "trials.journal"
"""In which a design, which has no runs of its own, keeps its trials."""

_PROGRESS, _MAP = "progress", "map"

IN_STORE = _PROGRESS, _MAP, MARKER
"""Names in a store beside the outputs."""

_PARTIAL = re.compile(r"(\d+|c|zarr)\.[0-9a-f]{32}\.partial")  # names that Zarr gives to files while it writes them
_REPAIR = "a copy of it, or remove it and give its command again"
_FOREIGN = "{} was not written by Rattlebox\n  try: move it out of this folder"


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

    Each variable is cut into chunks as the study is into blocks, so that a block is one file of each variable. Every chunk
    ends with a checksum. A block counts as computed if all its chunks are there and unchanged; any other block is computed
    again.

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
    StoreError
        When the folder holds another study, with the differences, or something else; when another process
        writes to it; or when it cannot be written.
    ResourceError
        When no space is left on the disk.
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
        """Write the result of a block to the disk.

        Raises
        ------
        ResourceError
            When the disk is full.
        StoreError
            When the folder cannot be written any more.
        """
        region, sides = self.blocks.region(block), self.blocks.sides(block)
        with _telling(self.path):
            if not (self.path / MARKER).is_file():
                raise StoreError(f"{self.path} was removed while the study ran", "the same command again")
            for name, array in self._arrays.items():
                (self.path / self._chunks.key(name, block)).unlink(missing_ok=True)  # it may be damaged
                array[region] = values[name].reshape((*sides, *values[name].shape[1:]))
        self.finished[block] = True

    @property
    def done(self) -> int:
        """Number of variants that are there."""
        return self.blocks.variants(self.finished)

    def result(self) -> xr.Dataset:
        """Return all of it, read from disk when it is used."""
        return _open_runs(self.path, _marker(self.path))

    def _open(self, cut: Callable[[], Blocks]) -> None:
        if (self.path / _PROGRESS / JOURNAL).exists():
            raise StoreError(f"{self.path} holds a design\n  try: another folder, or remove this one")
        marker = read_marker(self.path)
        if marker and marker.complete:
            self._compare(marker)
            if damaged_files(self.path, marker):
                marker = self._lay_out(_blocks(marker))
            self._remove_partial()
        else:
            marker = self._lay_out(cut())
        has_map(self.path)  # raises where it is damaged beyond repair
        group = _group(self.path, "r+")
        # A block of nothing but missing values is written, too, so that each computed block has its files.
        self._arrays = {name: group[name].with_config({"write_empty_chunks": True}) for name in self._plan.outputs}
        self._chunks = _Chunks(self.path, marker)
        self.blocks = self._chunks.blocks
        self.finished: NDArray[np.bool_] = self._chunks.finished()

    def _lay_out(self, blocks: Blocks) -> Marker:
        """Write all but the numbers. The marker is complete once the rest is there."""
        from rattlebox import __version__

        earlier = read_marker(self.path) or Marker(KIND, __version__)
        about = {"format": FORMAT, "shape": blocks.shape, "box": blocks.box, "manifest": self._plan.manifest}
        for name in self._plan.outputs:
            if os.path.lexists(self.path / name) and not any(file.startswith(f"{name}/") for file in earlier.files):
                raise StoreError(_FOREIGN.format(self.path / name))
        begun = Marker(KIND, __version__, earlier.identifier, about=about)
        try:
            return fill(self.path, begun, self._files(blocks))
        except ForeignFile as error:
            raise StoreError(str(error)) from None

    def _files(self, blocks: Blocks) -> dict[str, bytes]:
        """The files of a study before its first block."""
        import zarr
        from zarr.codecs import Crc32cCodec, ZstdCodec

        plan, files = self._plan, _InMemory()
        plan.frame.to_zarr(files.store, mode="a", zarr_format=3, consolidated=False)
        group = zarr.open_group(files.store, mode="r+", use_consolidated=False)
        for name, dims, shape, kind, attributes in plan.arrays():
            group.create_array(
                name,
                shape=shape,
                chunks=(*blocks.box, *shape[len(blocks.box) :]),
                dtype=kind,
                compressors=[ZstdCodec(), Crc32cCodec()],
                fill_value=_missing(kind),
                dimension_names=dims,
                attributes=attributes,
            )
        return files.content()

    def _remove_partial(self) -> None:
        """Remove the files that Zarr was writing when its process was killed."""
        for name in self._plan.outputs:
            for left in (self.path / name).rglob("*.partial"):
                if _PARTIAL.fullmatch(left.name):
                    left.unlink(missing_ok=True)

    def _compare(self, marker: Marker) -> None:
        there, here = marker.about["manifest"], self._plan.manifest
        lines = differences(there, here)
        if not lines:
            return
        hint = "another folder, or remove this one"
        if len(lines) == 1 and there["core"] != here["core"]:
            hint = f"RATTLEBOX_SIMD={there['core']} in the environment, or another folder"
        raise StoreError("\n".join([f"{self.path} holds another study", *lines, f"  try: {hint}"]))


class _InMemory:
    """A Zarr store in memory, from which the files of one on disk are made."""

    def __init__(self) -> None:
        from zarr.storage import MemoryStore

        self._files: dict[str, Any] = {}
        self.store = MemoryStore(self._files)

    def content(self) -> dict[str, bytes]:
        """Return the content of each file, by its path."""
        import zarr

        with warnings.catch_warnings():  # of a part of the format not agreed on that xarray asks for
            warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
            zarr.consolidate_metadata(self.store)
        return {name: buffer.to_bytes() for name, buffer in self._files.items()}


class _Chunks:
    """The files of the blocks of a study."""

    def __init__(self, path: Path, marker: Marker) -> None:
        self.blocks = _blocks(marker)
        self._path = path
        # "float64 step=3 mode=2": one further dimension for each word after the first
        self._further = {name: len(text.split()) - 1 for name, text in marker.about["manifest"]["outputs"].items()}
        self._keys: dict[str, int] = {}

    def key(self, name: str, block: int) -> str:
        """Return the path of the chunk of a variable."""
        place = np.unravel_index(block, self.blocks.counts) if self.blocks.shape else ()
        return "/".join([name, "c", *(str(int(i)) for i in place), *"0" * self._further[name]])

    def is_there(self, block: int) -> bool:
        """Return whether all chunks of a block are there and unchanged."""
        return all(_is_unchanged(self._path / self.key(name, block)) for name in self._further)

    def finished(self) -> NDArray[np.bool_]:
        """Return for each block whether it is there."""
        return np.array([self.is_there(block) for block in range(len(self.blocks))], bool)

    def block_of(self, key: str) -> int | None:
        """Return the block to which a path belongs; None for other files."""
        name, _, rest = key.partition("/c")
        if name not in self._further or not re.fullmatch(r"(/\d+)*", rest):
            return None
        place = [int(i) for i in rest.split("/")[1:]][: len(self.blocks.shape)]
        return int(np.ravel_multi_index(place, self.blocks.counts)) if place else 0


def _is_unchanged(chunk: Path) -> bool:
    """Return whether the checksum at the end of a chunk fits it."""
    import google_crc32c

    try:
        content = chunk.read_bytes()
    except OSError:
        return False
    return len(content) > 4 and google_crc32c.value(content[:-4]) == int.from_bytes(content[-4:], "little")


@cache
def _computed_only() -> Any:
    """Return the class of a Zarr store on disk that hides the blocks that are not computed, or are damaged."""
    from zarr.storage import LocalStore, WrapperStore

    class ComputedOnly(WrapperStore[LocalStore]):
        def __init__(self, store: Any, chunks: _Chunks) -> None:
            super().__init__(store)
            self._chunks = chunks
            self._there: dict[int, bool] = {}

        def _with_store(self, store: Any) -> Any:
            return type(self)(store, self._chunks)

        async def get(self, key: str, prototype: Any, byte_range: Any = None) -> Any:
            block = self._chunks.block_of(key)
            if block is None:
                return await super().get(key, prototype, byte_range)
            if not self._there.get(block):
                self._there[block] = self._chunks.is_there(block)
            return await super().get(key, prototype, byte_range) if self._there[block] else None

    return ComputedOnly


@contextmanager
def taken(path: Path) -> Iterator[Path]:
    """Be the only writer of a study; give the folder for what tells how far it is.

    Parameters
    ----------
    path
        Folder of the study, which need not exist.

    Raises
    ------
    StoreError
        When there is something else, when another process writes to it (the lock ends with its process, however that ends),
        or when the folder cannot be written.
    ResourceError
        When no space is left on the disk.
    """
    from filelock import FileLock, Timeout

    from rattlebox import __version__

    progress = path / _PROGRESS
    if path.exists() and not path.is_dir():
        raise StoreError(f"{path} is a file; a study needs a folder\n  try: another name, as study.zarr")
    with _telling(path), readable(path):
        path.mkdir(parents=True, exist_ok=True)
        if read_marker(path) is None:
            if not is_free(path):
                raise StoreError(
                    f"{path} holds other files, or a study of an earlier version\n"
                    "  try: a folder that does not exist yet, as study.zarr"
                )
            write_marker(path, Marker(KIND, __version__), new=True)
        _check(path)
        progress.mkdir(exist_ok=True)
        lock, name = FileLock(progress / "lock"), progress / "writer"
        try:
            lock.acquire(blocking=False)
        except Timeout:
            writer = name.read_text() if name.exists() else "another process"
            raise StoreError(
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
    except StoreError:
        raise
    except OSError as error:
        if isinstance(error, ResourceError) or error.errno in (errno.ENOSPC, errno.EDQUOT):
            advice = "make room and give the same command again, which goes on"
            raised: ResourceError | StoreError = ResourceError(f"{path}: no space is left on the disk", advice)
        else:
            why = error.complaint if isinstance(error, DataError) else error.strerror or error
            raised = StoreError(f"{path}: the study cannot be written: {why}", "another folder")
        raised.errno, raised.filename = error.errno, str(path)
        raise raised from error


@contextmanager
def readable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Say of a study whose files are damaged that they are, and what to do.

    Parameters
    ----------
    path
        Folder of the study.

    Raises
    ------
    StoreError
        When they are.
    """
    try:
        yield
    except RattleboxError as error:
        if isinstance(error, DamagedError):
            raise StoreError(f"{path} is damaged: {error}", _REPAIR) from error
        raise
    except PermissionError as error:
        raise StoreError(f"{path} cannot be opened: {error.strerror}", "another folder") from error
    except (ValueError, KeyError, RuntimeError, FileNotFoundError) as error:
        what = str(error).partition("\n")[0] or type(error).__name__
        raise StoreError(f"{path} is damaged: {what}", _REPAIR) from error


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
    StoreError
        When the folder cannot be written.
    ResourceError
        When no space is left on the disk.
    """
    from rattlebox import __version__

    found = found.assign_attrs(study=kind)
    if path is not None:
        files = _InMemory()
        kept = _with_texts(found).drop_encoding().assign_attrs(variables=list(found.data_vars))
        kept.to_zarr(files.store, zarr_format=3, consolidated=False)
        with taken(Path(path)), _telling(Path(path)):
            try:
                fill(Path(path) / _MAP, Marker(_MAP_KIND, __version__), files.content())
            except ForeignFile as error:
                raise StoreError(str(error)) from None
    return found


def add_attributes(path: str | os.PathLike[str], attributes: Mapping[str, str]) -> None:
    """Add attributes to a study on disk; `open_study` returns them with those of its plan.

    Parameters
    ----------
    path
        Folder of the study.
    attributes
        Attributes that are known once the study has run.

    Raises
    ------
    StoreError
        When the folder cannot be written.
    ResourceError
        When no space is left on the disk.
    """
    if attributes:
        with taken(Path(path)), _telling(Path(path)):
            marker = _marker(path)
            write_marker(Path(path), replace(marker, about={**marker.about, "added": dict(attributes)}))


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
    """Return whether a study is a ready map that is finished.

    Parameters
    ----------
    path
        Folder of the study.

    Raises
    ------
    StoreError
        If the list of the files of the map is damaged.
    """
    folder = Path(path) / _MAP
    try:
        marker = read_marker(folder)
    except DamagedError as error:
        raise StoreError(f"{folder} is damaged: {error}\n  try: remove {folder}, and give its command again") from None
    return marker is not None and marker.complete


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
    StoreError
        When there is no study.
    """
    if has_map(path):
        return _open_map(Path(path) / _MAP)
    with readable(path):
        marker = _marker(path)
        return _open_runs(Path(path), marker).assign_attrs(marker.about.get("added", {}))


def _open_map(folder: Path) -> xr.Dataset:
    import xarray as xr

    with readable(folder):
        marker = read_marker(folder)
        if marker and (damaged := damaged_files(folder, marker)):
            raise StoreError(
                f"{folder} is damaged: {damaged[0]} is lost or has changed\n"
                "  try: its command again, which makes the map anew from the runs"
            )
        data = xr.open_zarr(folder, chunks=None)
        found: xr.Dataset = data[data.attrs.pop("variables")]
        return found


def _open_runs(path: Path, marker: Marker) -> xr.Dataset:
    """Variables in their order, without the blocks that are not computed or damaged."""
    import xarray as xr
    from zarr.storage import LocalStore

    if damaged := damaged_files(path, marker):
        raise StoreError(
            f"{path} is damaged: {damaged[0]} is lost or has changed\n"
            "  try: the command that began it, which repairs it and computes only what is missing"
        )
    with readable(path):
        store = _computed_only()(LocalStore(path, read_only=True), _Chunks(path, marker))
        data: xr.Dataset = xr.open_zarr(store, chunks=None)
        return data[list(marker.about["manifest"]["outputs"])]


def progress_of(path: str | os.PathLike[str]) -> Progress:
    """Return how far a study on disk is, also while it runs.

    Parameters
    ----------
    path
        Folder of the study.

    Raises
    ------
    StoreError
        When there is no study.
    """
    with readable(path):
        marker = _marker(path)
        chunks = _Chunks(Path(path), marker)
        finished = chunks.finished()
        (name, *_) = marker.about["manifest"]["outputs"]
        files = [Path(path) / chunks.key(name, block) for block in np.flatnonzero(finished).tolist()]
        last = max((file.stat().st_mtime for file in files), default=0.0)
        return Progress(chunks.blocks, finished, last)


def _group(path: str | os.PathLike[str], mode: Literal["r", "r+"]) -> Any:
    import zarr

    return zarr.open_group(path, mode=mode, use_consolidated=False)


def _check(path: str | os.PathLike[str]) -> Marker | None:
    """Return the marker of a study, which may not be complete; raise if it belongs to something else."""
    marker = read_marker(Path(path))
    if marker and marker.name not in (KIND, ""):
        raise StoreError(f"{path} is no study, but a {marker.name}\n  try: another folder")
    if marker and marker.about.get("format", 0) > FORMAT:
        raise StoreError(f"{path} was written by a later Rattlebox\n  try: update Rattlebox")
    return marker


def _marker(path: str | os.PathLike[str]) -> Marker:
    """Return the marker of a study whose files are there."""
    marker = _check(path)
    if marker and marker.complete:
        return marker
    what = "is not a study" if Path(path).exists() else "is not there"
    raise StoreError(f"{path} {what}\n  try: the folder that 'rattlebox sweep -o' wrote")


def _blocks(marker: Marker) -> Blocks:
    return Blocks(tuple(marker.about["shape"]), tuple(marker.about["box"]))


def _missing(kind: np.dtype[Any]) -> Any:
    """What stands for a number that is not there yet."""
    if kind.kind in "iu":
        return np.iinfo(kind).min if kind.kind == "i" else np.iinfo(kind).max
    return False if kind.kind == "b" else np.nan
