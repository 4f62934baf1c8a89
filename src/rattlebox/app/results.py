"""Results in the folder of the page: names and downloads."""

from __future__ import annotations

import io
import json
import os
import re
import tempfile
import tomllib
import zipfile
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from errno import EEXIST
from functools import lru_cache
from pathlib import Path

import xarray as xr

import rattlebox as rb

from .draft import FAILURES, MOST_CHARACTERS, python_script

FORMATS = {
    "nc": "netCDF",
    "csv": "CSV tables (zip)",
    "mat": "MATLAB",
    "toml": "case file",
    "py": "Python script",
    "png": "figure of the motion",
    "html": "report",
    "vtkhdf": "ParaView",
}
"""Titles of the downloads of a run by suffix."""

DATA_FILES = (".csv", ".txt", ".dat", ".at2", ".mat", ".npz")
"""Suffixes of the files of data that can be added to the folder."""

MAP_FORMATS = {"csv": "CSV table", "nc": "netCDF", "png": "figure", "html": "report", "py": "Python script"}
"""Titles of the downloads of a map by suffix."""


def new_name(folder: Path, kind: str, text: str = "") -> str:
    """Take a name of a result that is not in the folder yet, "run-001" or "map-001", also if others do so at the same time.

    A run is reserved by the file of its case, "run-001.toml", a map by its folder, "map-001.zarr".
    """
    taken = {path.name.partition(".")[0] for path in folder.iterdir()}
    for number in range(1, 100_000):
        name = f"{kind}-{number:03d}"
        if name in taken:
            continue
        with suppress(FileExistsError):
            if kind == "map":
                (folder / f"{name}.zarr").mkdir()
            else:
                (folder / f"{name}.toml").open("x").close()
                with suppress(OSError, UnicodeError):  # on a full disk the name is enough
                    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
            return name
    raise rb.DataError(f"{folder} has 99,999 results of one kind", "another folder")


def release_name(folder: Path, name: str, text: str) -> None:
    """Give the name of a run back unless there is a result of it, or a state from which it resumes."""
    file = folder / f"{name}.toml"
    with suppress(OSError, UnicodeError):
        has_result = any((folder / f"{name}{suffix}").exists() for suffix in (".nc", ".checkpoint"))
        if not has_result and file.read_text(encoding="utf-8") in ("", text):
            file.unlink()


def save_run(run: rb.Run, folder: Path, name: str) -> str:
    """Write a run, with another name if somebody has taken its name meanwhile; return the name."""
    while True:
        try:
            run.save(folder / f"{name}.nc", replace=False)
        except rb.DataError as error:
            if error.errno != EEXIST:
                raise
        else:
            return name
        # Somebody has taken the name since the run began: case and snapshots follow to the next free one.
        before, name = name, new_name(folder, "run")
        for suffix in (".toml", ".vtkhdf"):
            with suppress(FileNotFoundError):
                (folder / f"{before}{suffix}").replace(folder / f"{name}{suffix}")


def typed_text(folder: Path, name: str, case_toml: str) -> str:
    """Return the text of the case of a run as the user wrote it, with its units, if it is still of the same case."""
    with suppress(*FAILURES):
        text = inside(folder, name, ".toml").read_text(encoding="utf-8")
        if len(text) <= MOST_CHARACTERS and rb.Case.from_toml(text, folder=folder) == rb.Case.from_toml(case_toml):
            return text
    return case_toml


def runs(folder: Path) -> list[str]:
    """Return the names of the runs in the folder, the newest first."""
    return _names(folder, ".nc")


@lru_cache(maxsize=500)
def name_of_case(path: Path, changed: float) -> str:
    """Return the name that the case of a run has; "" if it has none, or the file, changed at a time, cannot be read."""
    try:
        with xr.open_dataset(path) as stored:
            return str(tomllib.loads(str(stored["case"].item())).get("name", ""))[:80]
    except Exception:  # of any library, for a file of others
        return ""


def paused_runs(folder: Path) -> list[str]:
    """Return the names of the particle runs with a checkpoint in the folder, the newest first."""
    return [name for name in _names(folder, ".checkpoint") if (folder / f"{name}.vtkhdf").exists()]


def paused_case(folder: Path, name: str) -> str:
    """Return the case file of a particle run that has a checkpoint."""
    return typed_text(folder, name, str(rb.Snapshots(inside(folder, name, ".vtkhdf")).case_toml))


def maps(folder: Path) -> list[str]:
    """Return the names of the maps in the folder, the newest first."""
    return [name for name in _names(folder, ".zarr") if not name.endswith(".bare")]


def case_files(folder: Path) -> list[str]:
    """Return the names of the case files in the folder, without those of results."""
    results = {*_names(folder, ".nc"), *_names(folder, ".checkpoint")}
    return sorted(f"{name}.toml" for name in _names(folder, ".toml") if name not in results)


def _names(folder: Path, suffix: str) -> list[str]:
    """Return the names of the results with a suffix, the newest first; pipes, links to nowhere and the like are none."""
    results = []
    for path in folder.iterdir():
        with suppress(OSError):
            if path.suffix == suffix and _is_name(path.stem) and _is_result(path):
                results.append((path.stat().st_mtime, path.stem))
    return [name for _, name in sorted(results, reverse=True)]


def _is_result(path: Path) -> bool:
    return (path / "rattlebox.json").is_file() if path.suffix == ".zarr" else path.is_file()


def _is_name(name: str) -> bool:
    return name.isprintable() and re.fullmatch(r"[\w-][^/\\]{0,80}", name) is not None


def inside(folder: Path, name: str, suffix: str) -> Path:
    """Return the file of a result in the folder."""
    path = folder / f"{name}{suffix}"
    if not _is_name(name) or not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        raise rb.DataError(f"{name!r} is not the name of a result", "letters, digits and -")
    if not _is_result(path):
        raise rb.DataError(f"{path} does not exist; it may have been removed", "another result, or run the case again")
    return path


def store_file(folder: Path, name: str, content: bytes) -> None:
    """Write a file of data to the folder."""
    if not re.fullmatch(r"[\w-][\w .-]{0,80}", name) or not name.lower().endswith(DATA_FILES):
        raise rb.DataError(f"{name!r} is not the name of a data file", f"a name that ends in {', '.join(DATA_FILES)}")
    path = folder / name
    try:
        file = path.open("xb")
    except FileExistsError:
        raise rb.DataError(f"{name} is in the folder already", "another name, or remove the old file") from None
    try:
        with file:
            file.write(content)
    except OSError:
        path.unlink()  # part of a record would look like a short one
        raise


def download(folder: Path, name: str, suffix: str) -> bytes:
    """Return the content of a file for a run; `suffix` is one of `FORMATS`."""
    stored = inside(folder, name, ".nc")
    if suffix in ("nc", "vtkhdf"):
        return inside(folder, name, f".{suffix}").read_bytes()
    run = rb.load(stored)
    if suffix == "toml":
        return run.case.to_toml().encode()
    if suffix == "py":
        return python_script(run.case.to_toml()).encode()
    if suffix == "csv":
        return _zipped(run, name)
    write: dict[str, Callable[[Path], object]] = {
        "mat": run.to_mat,
        "png": lambda file: run.plot.motion().savefig(file, dpi=200),
        "html": run.report,
    }
    return _written(f"{name}.{suffix}", write, FORMATS)


def _zipped(run: rb.Run, name: str) -> bytes:
    """Return the tables of a run in an archive."""
    content = io.BytesIO()
    with tempfile.TemporaryDirectory() as scratch, zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in run.to_csv(scratch):
            archive.write(file, f"{name}/{file.name}")
    return content.getvalue()


def _written(name: str, write: Mapping[str, Callable[[Path], object]], formats: Iterable[str]) -> bytes:
    """Return the content of a file that one of the functions, by suffix, writes."""
    suffix = name.rpartition(".")[2]
    if suffix not in write:
        raise rb.DataError(f"{suffix!r} is not a kind of file", ", ".join(formats))
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / name
        write[suffix](file)
        return file.read_bytes()


def stored_map(folder: Path, name: str) -> tuple[xr.Dataset, str]:
    """Return the study of a map and the name of the drawn variable: its measure, or the ratio to that without damper."""
    store = inside(folder, name, ".zarr")
    study = rb.open_study(store).load()
    kind = str(study.attrs.get("study", "sweep"))
    if kind != "sweep" or "measures" not in study.attrs:
        raise rb.DataError(
            f"{store} is a study of the kind {kind}; this page shows sweeps over one or two numbers",
            f"'rattlebox plot {store.name}' or 'rattlebox report {store.name}' in the folder",
        )
    measure = json.loads(study.attrs["measures"])[0]
    without = store.with_suffix(".bare.zarr")
    if not without.exists():
        return study, measure
    ratio = study[measure] / rb.open_study(without).load()[measure].squeeze(drop=True)
    label = f"{study[measure].attrs.get('long_name', measure)} / without damper"
    ratio.attrs = {"long_name": label, "units": "1"}
    return study.assign({f"{measure}_ratio": ratio}), f"{measure}_ratio"


def map_script(study: xr.Dataset, drawn: str) -> str:
    """Return a Python script that computes a map as the page draws it."""
    measure = json.loads(study.attrs["measures"])[0]
    axes = {str(dim): study[dim].values.tolist() for dim in study[measure].dims}
    lines = [f"axes = {axes!r}", f"study = rb.sweep(case, axes, {measure!r})"]
    if drawn != measure:
        lines += [
            'others = {path: values for path, values in axes.items() if not path.startswith("damper")}',
            "without = case.without_dampers()",
            f'bare = rb.sweep(without, others or {{"duration": [case.duration]}}, {measure!r})',
            f"study[{drawn!r}] = study[{measure!r}] / bare[{measure!r}].squeeze(drop=True)",
        ]
    lines += [f"print(study[{drawn!r}].to_series())", f'rb.plot_map(study, {drawn!r}).savefig("map.png")', ""]
    return python_script(study.attrs["case"], "\n".join(lines))


def download_map(folder: Path, name: str, suffix: str) -> bytes:
    """Return the content of a file for a map; `suffix` is one of `MAP_FORMATS`."""
    study, drawn = stored_map(folder, name)
    if suffix == "py":
        return map_script(study, drawn).encode()
    if suffix == "csv":
        # The words of the flags stand beside each row, since a table has no legend.
        words = rb.study_remarks(study).rename("remarks")
        return bytes(study.assign(remarks=words).to_dataframe().to_csv().encode())
    write: dict[str, Callable[[Path], object]] = {
        "nc": study.to_netcdf,
        "png": lambda file: rb.plot_map(study, drawn).savefig(file, dpi=200),
        "html": lambda file: rb.write_report(study, file),
    }
    return _written(f"{name}.{suffix}", write, MAP_FORMATS)
