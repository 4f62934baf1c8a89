"""Reading of studies on disk, finished or not; their outcomes in lines of text, and as MATLAB files."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import atomic_write, check_suffix, require_folder
from rattlebox._util.exceptions import DataError, RattleboxError, StoreError
from rattlebox._util.flags import type_flags
from rattlebox._util.owned_folder import DamagedError, Marker, damaged_files, read_marker
from rattlebox.model.errors import Hint
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.results.export import as_cells, as_column
from rattlebox.results.provenance import with_version
from rattlebox.studies.run.result_file import read_file
from rattlebox.studies.work.work import Blocks

if TYPE_CHECKING:
    import xarray
    import xarray as xr


FORMAT = 2
"""Version of the layout; stores with a higher version are rejected."""

KIND = "Rattlebox study"
"""Kind of folder in the marker of a study."""

MAP = "map"
"""Subfolder of a store for the result of the study, if it differs from the runs."""

PROGRESS = "progress"
"""Subfolder of a store with the lock and the state of a study that is not finished."""

WHOLE = "finished"
"""Only output of a study without runs, which is computed as a whole."""

_DAMAGE_HINT = "a copy of it, or remove it and give its command again"


def open_study(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open a study on disk, finished or not.

    Parameters
    ----------
    path
        Folder given with `store=` or `rattlebox sweep -o`, or a netCDF file of a result, such as one of `Branch.save`.

    Returns
    -------
    xarray.Dataset
        Result of the study, read from disk when values are accessed. Before the study has finished: its runs, in which
        missing variants are NaN, or the smallest number of an integer variable; of a branch its points so far.

    Raises
    ------
    StoreError
        If there is no study, or it is damaged.
    """
    if Path(path).is_file() or Path(path).suffix == ".nc":
        return read_file(path)
    if has_map(path):
        return _open_map(Path(path) / MAP)
    if (partial := partial_file(path)).is_file():
        try:
            return read_file(partial)
        except DataError as error:
            raise StoreError(error.complaint, "the command that started the study, which begins again") from None
    with report_damage(path):
        marker = study_marker(path)
        return open_runs(Path(path), marker).assign_attrs(marker.about.get("added", {}))


def partial_file(path: str | os.PathLike[str]) -> Path:
    """Return the file in a store that holds the result so far of a study without runs."""
    return Path(path) / PROGRESS / "so_far.nc"


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
    is_whole: bool
    """Whether the study has no runs."""

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
        outputs = marker.about["manifest"]["outputs"]
        (name, *_) = outputs
        files = [Path(path) / chunks.key(name, block) for block in np.flatnonzero(finished).tolist()]
        last = max((file.stat().st_mtime for file in files), default=0.0)
        return Progress(chunks.blocks, finished, last, list(outputs) == [WHOLE])


# ---- markers


def check_marker(path: str | os.PathLike[str]) -> Marker | None:
    """Return the marker of a study, complete or not; None if there is none."""
    marker = read_marker(Path(path))
    if marker and marker.name not in (KIND, ""):
        raise StoreError(f"{path} is not a study, but a {marker.name}", "another folder")
    if marker and marker.about.get("format", 0) > FORMAT:
        raise StoreError(f"{path} was written by a later version of Rattlebox", "update Rattlebox")
    return marker


def started_with(path: str | os.PathLike[str]) -> str:
    """Return the words that name the version which began a study, "" if it is the present one."""
    marker = check_marker(path)
    return with_version(marker.version) if marker else ""


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
            f"the command that started the study{with_version(marker.version)}, which repairs it and computes only the "
            "missing blocks",
        )
    with report_damage(path):
        store = _intact_only()(LocalStore(path, read_only=True), Chunks(path, marker))
        data: xr.Dataset = xr.open_zarr(store, chunks=None)
        runs: xr.Dataset = type_flags(data[list(marker.about["manifest"]["outputs"])])
        return runs


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
        result: xr.Dataset = type_flags(data[data.attrs.pop("variables")])
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

        def _with_store(self, store: object) -> Any:
            return type(self)(store, self._chunks)

        async def get(self, key: str, prototype: Any, byte_range: Any = None) -> Any:
            block = self._chunks.block_of(key)
            if block is None:
                return await super().get(key, prototype, byte_range)
            if not self._intact.get(block):
                self._intact[block] = self._chunks.is_intact(block)
            return await super().get(key, prototype, byte_range) if self._intact[block] else None

    return IntactOnly


# ---- outcomes


_CHUNK_BYTES = 2**26


def status_lines(study: xr.Dataset) -> list[str]:
    """Return lines with the statuses of the runs of a study, the reason of a refusal, and the warnings."""
    lines = str(study.attrs.get("answer", "")).splitlines()
    if counts := status_counts(study):
        statuses = ", ".join(f"{count:,} {name}" for name, count in counts.items())
        lines.append(f"{sum(counts.values()):,} variants: {statuses}")
    if "refused" in study.attrs:
        lines.append(f"refused, for example with {study.attrs['refused']}")
    given = study.attrs.get("warnings", [])  # of a design; a single one is read as a text
    if "reason" in study and given:
        lines += [given] if isinstance(given, str) else list(given)
    none = "front" in study.sizes and not study.sizes["front"] and bool(given)  # whose warning has the reasons
    if not none and "reason" in study and (refused := [str(reason) for reason in study.reason.values if reason]):
        first = refused[0].replace("\n", "\n  ")
        lines.append(f"{len(refused):,} of {study.sizes['trial']:,} trials are not feasible, for example: {first}")
    lines += [
        str(study.attrs[name]) for name in ("order", "at_end") if name in study.attrs
    ]  # of the trials of a design
    return [*lines, *warning_lines(study)]


def study_remarks(study: xr.Dataset) -> xr.DataArray:
    """Return in words what limits the result of each run of a study: exceeded validity limits, or why it did not finish.

    Parameters
    ----------
    study
        Dataset from `rb.sweep`, `rb.open_study` or another study with `status` or `warnings`.

    Returns
    -------
    xarray.DataArray
        Text for each run, parts separated by "; "; "" for a run without remarks. Over the axes of `status` and `warnings`;
        a single "" for a study without them.

    Examples
    --------
    >>> import rattlebox as rb
    >>> study = rb.sweep(rb.reference_case(duration=0.1), {"damper.gap": ["0.2 mm", "0.4 mm"]}, "peak")
    >>> rb.study_remarks(study).values.tolist()
    ['', '']
    """
    import xarray

    found = xarray.DataArray("").astype(object)
    if "status" in study and "flag_meanings" in study.status.attrs:
        names = dict(enumerate(study.status.attrs["flag_meanings"].split()))
        words = {number: name.replace("_", " ") for number, name in names.items() if name != "finished"}
        found = _joined(found, study.status, lambda value: [words[value]] if value in words else [])
    if "warnings" in study and "flag_masks" in study.warnings.attrs:
        attrs = study.warnings.attrs
        masks = [int(mask) for mask in np.atleast_1d(attrs["flag_masks"])]
        flags = dict(zip(masks, attrs["flag_meanings"].split(), strict=True))
        found = _joined(
            found,
            study.warnings,
            lambda value: [WARNINGS.get(name, name) for mask, name in flags.items() if value > 0 and value & mask],
        )
    return found


def _joined(found: xr.DataArray, codes: xr.DataArray, words: Callable[[int], list[str]]) -> xr.DataArray:
    """Add the words of codes to texts, over the dimensions of both; codes of missing variants have none."""
    import xarray

    numbers = np.where(np.isfinite(codes.values), codes.values, -1).astype(int)
    texts = {value: "; ".join(words(value)) for value in np.unique(numbers).tolist()}
    added = codes.copy(data=np.array([texts[value] for value in numbers.ravel().tolist()], object).reshape(codes.shape))
    first, second = xarray.broadcast(found, added)
    joined = ["; ".join(filter(None, pair)) for pair in zip(first.values.ravel(), second.values.ravel(), strict=True)]
    result = second.copy(data=np.array(joined, object).reshape(second.shape))
    result.attrs = {"long_name": "remarks on the runs"}
    return result


def status_counts(study: xr.Dataset) -> dict[str, int]:
    """Count the runs of a study by their status."""
    if "status" not in study:
        return {}
    names = study.status.attrs.get("flag_meanings", "").split()
    numbers, counts = np.unique(np.concatenate([computed(chunk) for chunk in chunks(study.status)]), return_counts=True)
    return {
        names[number] if number < len(names) else f"status {number}": int(count)
        for number, count in zip(numbers, counts, strict=True)
    }


def warning_lines(study: xr.Dataset) -> list[str]:
    """Return the warnings of a study: a stop by the budget, measures without an interval, exceeded validity limits."""
    lines = [f"warning: {study.attrs['stopped']}"] if "stopped" in study.attrs else []
    lines += [f"warning: {study.attrs[name]}" for name in ("too_short", "unsettled") if name in study.attrs]
    if isinstance(noted := study.attrs.get("warnings"), str) and "reason" not in study:
        lines += [f"warning: {line}" for line in noted.splitlines()]
    if "flagged" in study.attrs:
        lines.append(f"warning: the best designs exceed validity limits: {study.attrs['flagged']}")
    if "warnings" not in study or "flag_masks" not in study.warnings.attrs:
        return lines
    attrs = study.warnings.attrs
    flags = np.concatenate([computed(chunk) for chunk in chunks(study.warnings)])
    counts = [np.count_nonzero(flags & mask) for mask in attrs["flag_masks"]]
    names = [WARNINGS.get(name, name) for name in attrs["flag_meanings"].split()]
    return lines + [
        f"warning: {count:,} of {flags.size:,} results with {name}"
        for count, name in zip(counts, names, strict=True)
        if count
    ]


def chunks(values: xr.DataArray) -> Iterator[np.ndarray[Any, Any]]:
    """Read a variable in chunks that fit in memory."""
    if not values.ndim:
        yield values.values.reshape(1)
        return
    rows = max(1, _CHUNK_BYTES * len(values) // max(1, values.nbytes))
    for start in range(0, len(values), rows):
        yield values[start : start + rows].values


def computed(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return the values that are computed and finite, (n,)."""
    if values.dtype.kind == "f":
        valid = np.isfinite(values)
    else:
        valid = values != (np.iinfo(values.dtype).min if values.dtype.kind == "i" else None)
    return values[valid]  # type: ignore[no-any-return]


# ---- MATLAB files


def to_mat(study: xarray.Dataset, path: str | os.PathLike[str]) -> Path:
    """Write the result of a study to a MATLAB file (version 5, up to 2 GB per variable).

    Characters that MATLAB does not allow in names become underscores: the axis `damper.gap` is `study.damper_gap`. Arrays
    keep the order of their dimensions; vectors are columns; texts are cells.

    Parameters
    ----------
    study
        Result of a study, or any dataset of xarray.
    path
        File to write, .mat.

    Returns
    -------
    Path
        The file, with the structs `study` (variables and axes), `dims` (names of the dimensions of each, in order), `units`
        and `info` (attributes of the study as text).

    Raises
    ------
    CaseError
        If something else than a dataset is given.
    DataError
        If the file cannot be written, or its name is that of another kind of file.
    ResourceError
        If no space is left on the disk.

    Examples
    --------
    >>> import rattlebox as rb
    >>> study = rb.sweep(rb.reference_case(duration=0.1), {"damper.gap": ["0.2 mm", "0.4 mm"]}, "peak")
    >>> rb.to_mat(study, "study.mat").name
    'study.mat'
    """
    import xarray
    from scipy.io import savemat

    if not isinstance(study, xarray.Dataset):
        raise Hint(f"the result of a study is needed, not {study!r:.60}", "rb.sweep(...); a run has its own run.to_mat")
    path = Path(path)
    check_suffix(path, ".mat")
    require_folder(path)
    content: dict[str, dict[str, Any]] = {"study": {}, "dims": {}, "units": {}, "info": {}}
    for name, variable in study.variables.items():
        field, values = _field(name), variable.values
        content["study"][field] = as_cells(values.ravel()) if values.dtype.kind in "OUS" else as_column(values)
        content["dims"][field] = as_cells(map(_field, variable.dims))
        content["units"][field] = str(variable.attrs.get("units", ""))
    content["info"] = {_field(name): _text(value) for name, value in study.attrs.items()}
    with atomic_write(path, "make room and write the file again") as name:
        savemat(name, content, long_field_names=True, appendmat=False)
    return path


def _field(name: object) -> str:
    """Return a name that MATLAB allows."""
    field = re.sub(r"\W", "_", str(name), flags=re.ASCII)
    return field if field[:1].isalpha() else f"x{field}"


def _text(value: object) -> Any:
    """Return an attribute as text, and a list of texts as cells."""
    return as_cells(value) if isinstance(value, (list, tuple)) else str(value)
