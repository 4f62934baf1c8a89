"""Reading of studies on disk, finished or not, and detection of missing or damaged blocks."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import RattleboxError, StoreError
from rattlebox._util.owned_folder import DamagedError, Marker, damaged_files, read_marker
from rattlebox.studies.work.blocks import Blocks

if TYPE_CHECKING:
    import xarray as xr

FORMAT = 2
"""Version of the layout; stores with a higher version are rejected."""

KIND = "Rattlebox study"
"""Kind of folder in the marker of a study."""

MAP = "map"
"""Subfolder of a store for the result of the study, if it differs from the runs."""

_DAMAGE_HINT = "a copy of it, or remove it and give its command again"


def open_study(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open a study on disk, finished or not.

    Parameters
    ----------
    path
        Folder given with `store=` or `rattlebox sweep -o`.

    Returns
    -------
    xarray.Dataset
        Result of the study, read from disk when values are accessed. Before the study has finished: its runs, in which
        missing variants are NaN, or the smallest number of an integer variable.

    Raises
    ------
    StoreError
        If there is no study, or it is damaged.
    """
    if has_map(path):
        return _open_map(Path(path) / MAP)
    with report_damage(path):
        marker = study_marker(path)
        return open_runs(Path(path), marker).assign_attrs(marker.about.get("added", {}))


def has_map(path: str | os.PathLike[str]) -> bool:
    """Return whether a store holds a result of its study in addition to the runs."""
    folder = Path(path) / MAP
    try:
        marker = read_marker(folder)
    except DamagedError as error:
        raise StoreError(f"{folder} is damaged: {error}", f"remove {folder}, and give its command again") from None
    return marker is not None and marker.complete


@dataclass(frozen=True)
class Progress:
    """State of a study on disk."""

    blocks: Blocks
    finished: NDArray[np.bool_]
    last: float

    @property
    def done(self) -> int:
        """Number of finished variants."""
        return self.blocks.variants(self.finished)

    @property
    def total(self) -> int:
        """Number of variants."""
        return math.prod(self.blocks.shape)


def progress_of(path: str | os.PathLike[str]) -> Progress:
    """Return the state of a study on disk, also while it runs."""
    with report_damage(path):
        marker = study_marker(path)
        chunks = Chunks(Path(path), marker)
        finished = chunks.finished()
        (name, *_) = marker.about["manifest"]["outputs"]
        files = [Path(path) / chunks.key(name, block) for block in np.flatnonzero(finished).tolist()]
        last = max((file.stat().st_mtime for file in files), default=0.0)
        return Progress(chunks.blocks, finished, last)


# ---- markers


def check_marker(path: str | os.PathLike[str]) -> Marker | None:
    """Return the marker of a study, complete or not; None if there is none."""
    marker = read_marker(Path(path))
    if marker and marker.name not in (KIND, ""):
        raise StoreError(f"{path} is not a study, but a {marker.name}", "another folder")
    if marker and marker.about.get("format", 0) > FORMAT:
        raise StoreError(f"{path} was written by a later version of Rattlebox", "update Rattlebox")
    return marker


def study_marker(path: str | os.PathLike[str]) -> Marker:
    """Return the complete marker of a study."""
    marker = check_marker(path)
    if marker and marker.complete:
        return marker
    what = "is not a study" if Path(path).exists() else "does not exist"
    raise StoreError(f"{path} {what}", "the folder that 'rattlebox sweep -o' wrote")


@contextmanager
def report_damage(path: str | os.PathLike[str]) -> Iterator[None]:
    """Convert errors of reading a store to errors about damage."""
    try:
        yield
    except RattleboxError as error:
        if isinstance(error, DamagedError):
            raise StoreError(f"{path} is damaged: {error}", _DAMAGE_HINT) from error
        raise
    except PermissionError as error:
        raise StoreError(f"{path} cannot be opened: {error.strerror}", "another folder") from error
    except (ValueError, KeyError, RuntimeError, FileNotFoundError) as error:
        what = str(error).partition("\n")[0] or type(error).__name__
        raise StoreError(f"{path} is damaged: {what}", _DAMAGE_HINT) from error


# ---- blocks


class Chunks:
    """Files of the blocks of a study: one file per block and variable, which ends with its CRC-32C."""

    def __init__(self, path: Path, marker: Marker) -> None:
        self.blocks = Blocks(tuple(marker.about["shape"]), tuple(marker.about["box"]))
        self._path = path
        # "float64 step=3 mode=2" is the number type, and a word for each dimension beyond the grid.
        self._further = {name: len(text.split()) - 1 for name, text in marker.about["manifest"]["outputs"].items()}

    def key(self, name: str, block: int) -> str:
        """Return the path of a block of a variable in the folder."""
        place = np.unravel_index(block, self.blocks.counts) if self.blocks.shape else ()
        return "/".join([name, "c", *(str(int(i)) for i in place), *"0" * self._further[name]])

    def is_intact(self, block: int) -> bool:
        """Return whether all files of a block exist and have their checksums."""
        return all(_has_checksum(self._path / self.key(name, block)) for name in self._further)

    def finished(self) -> NDArray[np.bool_]:
        """Return whether each block is intact, (len(blocks),)."""
        return np.array([self.is_intact(block) for block in range(len(self.blocks))], bool)

    def block_of(self, key: str) -> int | None:
        """Return the block to which a path belongs; None for other files."""
        name, _, rest = key.partition("/c")
        if name not in self._further or not re.fullmatch(r"(/\d+)*", rest):
            return None
        place = [int(i) for i in rest.split("/")[1:]][: len(self.blocks.shape)]
        return int(np.ravel_multi_index(place, self.blocks.counts)) if place else 0


def _has_checksum(chunk: Path) -> bool:
    import google_crc32c

    try:
        content = chunk.read_bytes()
    except OSError:
        return False
    return len(content) > 4 and google_crc32c.value(content[:-4]) == int.from_bytes(content[-4:], "little")


# ---- datasets


def open_runs(path: Path, marker: Marker) -> xr.Dataset:
    """Open the outputs of all variants; missing or damaged blocks are returned as missing values."""
    import xarray as xr
    from zarr.storage import LocalStore

    if damaged := damaged_files(path, marker):
        raise StoreError(
            f"{path} is damaged: {damaged[0]} is missing or has changed",
            "the command that started the study, which repairs it and computes only the missing blocks",
        )
    with report_damage(path):
        store = _intact_only()(LocalStore(path, read_only=True), Chunks(path, marker))
        data: xr.Dataset = xr.open_zarr(store, chunks=None)
        return data[list(marker.about["manifest"]["outputs"])]


def _open_map(folder: Path) -> xr.Dataset:
    import xarray as xr

    with report_damage(folder):
        marker = read_marker(folder)
        if marker and (damaged := damaged_files(folder, marker)):
            raise StoreError(
                f"{folder} is damaged: {damaged[0]} is missing or has changed",
                "its command again, which computes the result again from the runs",
            )
        data = xr.open_zarr(folder, chunks=None)
        result: xr.Dataset = data[data.attrs.pop("variables")]
        return result


@cache
def _intact_only() -> Any:
    """Return the class of a Zarr store that hides the blocks that are missing or damaged in any variable.

    Zarr itself would raise at a damaged chunk, and would show the other variables of an incomplete block.
    """
    from zarr.storage import LocalStore, WrapperStore

    class IntactOnly(WrapperStore[LocalStore]):
        def __init__(self, store: Any, chunks: Chunks) -> None:
            super().__init__(store)
            self._chunks = chunks
            self._intact: dict[int, bool] = {}

        def _with_store(self, store: Any) -> Any:
            return type(self)(store, self._chunks)

        async def get(self, key: str, prototype: Any, byte_range: Any = None) -> Any:
            block = self._chunks.block_of(key)
            if block is None:
                return await super().get(key, prototype, byte_range)
            if not self._intact.get(block):
                self._intact[block] = self._chunks.is_intact(block)
            return await super().get(key, prototype, byte_range) if self._intact[block] else None

    return IntactOnly
