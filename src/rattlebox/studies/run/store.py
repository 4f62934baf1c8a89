"""Layout of the result of a study, and the result in memory or in a Zarr folder, from which a stopped study resumes."""

from __future__ import annotations

import errno
import json
import math
import os
import re
import socket
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.exceptions import DataError, ResourceError, StoreError
from rattlebox._util.flags import type_flags
from rattlebox._util.owned_folder import (
    MARKER,
    ForeignFile,
    Marker,
    damaged_files,
    fill,
    is_free,
    read_marker,
    write_marker,
)
from rattlebox.model.differences import differences
from rattlebox.model.particle_damper import memory
from rattlebox.results.provenance import with_version
from rattlebox.studies.run.stored import (
    FORMAT,
    KIND,
    MAP,
    PROGRESS,
    WHOLE,
    Chunks,
    check_marker,
    has_map,
    open_runs,
    partial_file,
    report_damage,
    study_marker,
)
from rattlebox.studies.work.work import Blocks, Output

if TYPE_CHECKING:
    import xarray as xr


# ---- layout


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
        variables = self._plan.variables()
        result: xr.Dataset = type_flags(
            self._plan.frame.assign({v.name: (v.dims, self._arrays[v.name], v.attributes) for v in variables})
        )
        return result


# ---- store


JOURNAL = "trials.journal"
"""File with the trials of a design search, which has no grid of runs."""

_MAP_KIND = "Rattlebox map"

RESERVED = PROGRESS, MAP, MARKER
"""Names in a store that are not outputs."""

_PARTIAL = re.compile(r"(\d+|c|zarr)\.[0-9a-f]{32}\.partial")  # temporary files of Zarr


class Store:
    """A study on disk, open for writing by this process alone.

    The chunks of each variable are the blocks of the study, so that a block is one file per variable. Every chunk ends with
    a checksum. A block is finished if all its chunks exist with correct checksums; other blocks are computed again.

    Notes
    -----
    Blocks are written by zarr rather than by `xarray.Dataset.to_zarr(region=...)`, which opens the store and reads all its
    metadata for every block (7 ms instead of 3 ms for three variables).
    """

    def __init__(self, path: str | os.PathLike[str], plan: Plan, blocks: Blocks) -> None:
        self.path = Path(path)
        self._plan = plan
        with ExitStack() as stack:
            stack.enter_context(exclusive_writer(self.path))
            with _explain_disk_errors(self.path), report_damage(self.path):
                self._open(blocks)
            self._lock = stack.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.close()

    def has_state(self, block: int) -> bool:
        """Return whether the state at the end of a block is on disk, undamaged."""
        return bool(self.state(block))

    def state(self, block: int) -> dict[str, NDArray[Any]]:
        """Return the arrays of a block that are not outputs; empty if they are missing or damaged."""
        try:
            with self._state_file(block).open("rb") as content, np.load(content, allow_pickle=False) as file:
                return {name: file[name] for name in file.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error):
            return {}

    def _state_file(self, block: int) -> Path:
        return self.path / PROGRESS / f"state-{block}.npz"

    def write(self, block: int, values: Mapping[str, NDArray[Any]], stale: Sequence[int] = ()) -> None:
        """Write the outputs of a block to the disk, and before them its further arrays, the state at its end."""
        region, sides = self.blocks.region(block), self.blocks.sides(block)
        with _explain_disk_errors(self.path):
            if not (self.path / MARKER).is_file():
                raise StoreError(f"{self.path} was removed while the study ran", "the same command again")
            if state := {name: values[name] for name in values if name not in self._arrays}:
                with atomic_write(self._state_file(block), replace=True) as temporary, temporary.open("wb") as file:
                    np.savez(file, allow_pickle=False, **state)
            for name, array in self._arrays.items():
                # Without this, Zarr would read a chunk that may be damaged.
                (self.path / self._chunks.key(name, block)).unlink(missing_ok=True)
                array[region] = values[name].reshape((*sides, *values[name].shape[1:]))
        self.finished[block] = True
        for other in stale:
            self._state_file(other).unlink(missing_ok=True)

    @property
    def done(self) -> int:
        """Number of finished variants."""
        return self.blocks.variants(self.finished)

    def result(self) -> xr.Dataset:
        """Return the result, read from disk when its values are used."""
        return open_runs(self.path, study_marker(self.path))

    def _open(self, blocks: Blocks) -> None:
        if (self.path / PROGRESS / JOURNAL).exists():
            raise StoreError(f"{self.path} holds a design", "another folder, or remove this one")
        marker = read_marker(self.path)
        if marker and marker.complete:
            self._compare(marker)
            if damaged_files(self.path, marker):
                marker = self._create(Chunks(self.path, marker).blocks)
            self._remove_partial()
        else:
            marker = self._create(blocks)
        has_map(self.path)  # raises if it is damaged beyond repair
        import zarr

        group = zarr.open_group(self.path, mode="r+", use_consolidated=False)
        # Blocks with only missing values are also written, so that each finished block has its files.
        self._arrays: dict[str, Any] = {
            name: group[name].with_config({"write_empty_chunks": True})  # type: ignore[union-attr]
            for name in self._plan.outputs
        }
        self._chunks = Chunks(self.path, marker)
        self.blocks = self._chunks.blocks
        self.finished: NDArray[np.bool_] = self._chunks.finished()

    def _create(self, blocks: Blocks) -> Marker:
        """Write everything except the blocks. The marker is complete when the other files are on disk."""
        from rattlebox import __version__

        earlier = read_marker(self.path) or Marker(KIND, __version__)
        about = {"format": FORMAT, "shape": blocks.shape, "box": blocks.box, "manifest": self._plan.manifest}
        for name in self._plan.outputs:
            if os.path.lexists(self.path / name) and not any(file.startswith(f"{name}/") for file in earlier.files):
                raise StoreError(f"{self.path / name} was not written by Rattlebox", "move it out of this folder")
        incomplete = Marker(KIND, __version__, earlier.identifier, about=about)
        try:
            return fill(self.path, incomplete, self._files(blocks))
        except ForeignFile as error:
            raise StoreError(str(error)) from None

    def _files(self, blocks: Blocks) -> dict[str, bytes]:
        """Return the files of a study without blocks."""
        import zarr
        from zarr.codecs import Crc32cCodec, ZstdCodec

        files = _MemoryFiles()
        self._plan.frame.to_zarr(files.store, mode="a", zarr_format=3, consolidated=False)
        group = zarr.open_group(files.store, mode="r+", use_consolidated=False)
        for variable in self._plan.variables():
            group.create_array(
                variable.name,
                shape=variable.shape,
                chunks=(*blocks.box, *variable.shape[len(blocks.box) :]),
                dtype=variable.dtype,
                compressors=[ZstdCodec(), Crc32cCodec()],
                fill_value=variable.missing,
                dimension_names=variable.dims,
                attributes=variable.attributes,
            )
        return files.content()

    def _remove_partial(self) -> None:
        """Remove temporary files of Zarr, left by a killed process."""
        for name in self._plan.outputs:
            for left in (self.path / name).rglob("*.partial"):
                if _PARTIAL.fullmatch(left.name):
                    left.unlink(missing_ok=True)

    def _compare(self, marker: Marker) -> None:
        """Raise if the store holds another study."""
        there, here = marker.about["manifest"], self._plan.manifest
        lines = differences(there, here)
        if not lines:
            return
        hint = "another folder, or remove this one"
        if other := with_version(there["version"]):
            hint = f"another folder, or the same command{other}; rb.open_study reads this one"
        if len(lines) == 1 and there["core"] != here["core"]:
            hint = f"RATTLEBOX_SIMD={there['core']} in the environment, or another folder"
        raise StoreError("\n".join([f"{self.path} holds another study", *lines]), hint)


class _MemoryFiles:
    """A Zarr store in memory, whose files are then written to disk with their digests."""

    def __init__(self) -> None:
        from zarr.storage import MemoryStore

        self._files: dict[str, Any] = {}
        self.store = MemoryStore(self._files)

    def content(self) -> dict[str, bytes]:
        """Return the content of each file by its path."""
        import zarr

        with warnings.catch_warnings():  # consolidated metadata, which xarray asks for, is not yet part of Zarr 3
            warnings.simplefilter("ignore", zarr.errors.ZarrUserWarning)
            zarr.consolidate_metadata(self.store)
        return {name: buffer.to_bytes() for name, buffer in self._files.items()}


@contextmanager
def exclusive_writer(path: Path) -> Iterator[Path]:
    """Lock a study for writing until the process ends, and yield the folder of its progress."""
    from filelock import FileLock, Timeout

    from rattlebox import __version__

    progress = path / PROGRESS
    with _explain_disk_errors(path):
        if path.exists() and not path.is_dir():
            raise StoreError(f"{path} is a file; a study must be a folder", "another name, such as study.zarr")
        path.mkdir(parents=True, exist_ok=True)
    with _explain_disk_errors(path), report_damage(path):
        if read_marker(path) is None:
            if not is_free(path):
                raise StoreError(
                    f"{path} holds other files, or a study of an earlier version",
                    "a folder that does not exist yet, such as study.zarr",
                )
            write_marker(path, Marker(KIND, __version__), new=True)
        check_marker(path)
        progress.mkdir(exist_ok=True)
        lock, name = FileLock(progress / "lock"), progress / "writer"
        try:
            lock.acquire(blocking=False)
        except Timeout:
            writer = name.read_text() if name.exists() else "another process"
            raise StoreError(
                f"{path} is being written by {writer}",
                "another folder, or wait; 'rattlebox show' prints its progress",
            ) from None
    try:
        with _explain_disk_errors(path):
            name.write_text(f"process {os.getpid()} on {socket.gethostname()}")
        yield progress
    finally:
        lock.release()


@contextmanager
def _explain_disk_errors(path: Path) -> Iterator[None]:
    """Convert errors of a full or read-only disk to errors about the study."""
    try:
        yield
    except StoreError:
        raise
    except OSError as error:
        if isinstance(error, ResourceError) or error.errno in (errno.ENOSPC, errno.EDQUOT):
            advice = "free disk space and give the same command again, which resumes"
            raised: ResourceError | StoreError = ResourceError(f"{path}: no space is left on the disk", advice)
        else:
            why = error.complaint if isinstance(error, DataError) else error.strerror or error
            raised = StoreError(f"{path}: the study cannot be written: {why}", "another folder")
        raised.errno, raised.filename = error.errno, str(path)
        raise raised from error


def save_result(result: xr.Dataset, kind: str, path: str | os.PathLike[str] | None) -> xr.Dataset:
    """Add the kind of the study to its result, and write the result to the store next to the runs."""
    from rattlebox import __version__

    result = type_flags(result.assign_attrs(study=kind))
    if path is not None:
        files = _MemoryFiles()
        stored = with_texts(result).drop_encoding().assign_attrs(variables=list(result.data_vars))
        stored.to_zarr(files.store, zarr_format=3, consolidated=False)
        with exclusive_writer(Path(path)), _explain_disk_errors(Path(path)):
            try:
                fill(Path(path) / MAP, Marker(_MAP_KIND, __version__), files.content())
            except ForeignFile as error:
                raise StoreError(str(error)) from None
    return result


def save_finished(
    result: xr.Dataset, kind: str, path: str | os.PathLike[str] | None, manifest: Mapping[str, object]
) -> xr.Dataset:
    """Add the kind of a study without runs to its result, and write the result to a store of its own.

    `manifest`: description that distinguishes the study from others, in JSON types.
    """
    with open_whole(kind, path, manifest):
        pass
    return save_result(result, kind, path)


@contextmanager
def open_whole(kind: str, path: str | os.PathLike[str] | None, manifest: Mapping[str, object]) -> Iterator[Path | None]:
    """Open the store of a study that has no runs; yield the file for its result so far, None without a store.

    The study is finished at the end of the block.
    """
    if path is None:
        yield None
        return
    from rattlebox import __version__

    about = {**manifest, "study": kind, "version": __version__, "core": ""}
    plan = Plan((), (), {WHOLE: ((), np.dtype(float), {})}, about=about)
    with Store(path, plan, Blocks((), ())) as store:
        yield partial_file(path)
        store.write(0, {WHOLE: np.ones(1)})


def add_attributes(path: str | os.PathLike[str], attributes: Mapping[str, str]) -> None:
    """Add attributes to a study on disk; `open_study` returns them with those of its plan."""
    if attributes:
        with exclusive_writer(Path(path)), _explain_disk_errors(Path(path)):
            marker = study_marker(path)
            write_marker(Path(path), replace(marker, about={**marker.about, "added": dict(attributes)}))
