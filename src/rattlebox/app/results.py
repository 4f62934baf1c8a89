"""The results in the folder of the page: names, downloads and comparison."""

from __future__ import annotations

import io
import re
import tempfile
import zipfile
from pathlib import Path

import rattlebox as rb

from .draft import python_script

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

MAP_FORMATS = {"csv": "CSV table", "nc": "netCDF", "png": "figure", "html": "report", "py": "Python script"}
"""Titles of the downloads of a map by suffix."""


def new_name(folder: Path, kind: str) -> str:
    """Return a name of a result that is not in the folder yet: "run-001", "map-001"."""
    taken = {path.name.partition(".")[0] for path in folder.iterdir()}
    return next(name for number in range(1, 100_000) if (name := f"{kind}-{number:03d}") not in taken)


def runs(folder: Path) -> list[str]:
    """Return the names of the runs in the folder, the newest first."""
    return _names(folder, ".nc")


def maps(folder: Path) -> list[str]:
    """Return the names of the maps in the folder, the newest first."""
    return [name for name in _names(folder, ".zarr") if not name.endswith(".bare")]


def _names(folder: Path, suffix: str) -> list[str]:
    found = [path for path in folder.iterdir() if path.suffix == suffix]
    return [path.stem for path in sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)]


def inside(folder: Path, name: str, suffix: str) -> Path:
    """Return the file of a result in the folder.

    Raises
    ------
    DataError
        If the name is not one of a result in the folder.
    """
    path = folder / f"{name}{suffix}"
    if not re.fullmatch(r"[\w-]{1,80}(\.bare)?", name) or not path.resolve().is_relative_to(folder.resolve()):
        raise rb.DataError(f"{name!r} is not the name of a result", "letters, digits and -")
    if not path.exists():
        raise rb.DataError(f"{path} does not exist; it may have been removed")
    return path


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
    with tempfile.TemporaryDirectory() as place:
        target = Path(place) / f"{name}.{suffix}"
        if suffix == "csv":
            files = run.to_csv(place)
            packed = io.BytesIO()
            with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
                for file in files:
                    archive.write(file, f"{name}/{file.name}")
            return packed.getvalue()
        if suffix == "mat":
            run.to_mat(target)
        elif suffix == "png":
            run.plot.motion().savefig(target, dpi=200)
        elif suffix == "html":
            run.report(target)
        else:
            raise rb.DataError(f"{suffix!r} is not a kind of file", ", ".join(FORMATS))
        return target.read_bytes()


def download_map(folder: Path, name: str, suffix: str, script: str) -> bytes:
    """Return the content of a file for a map; `suffix` is one of `MAP_FORMATS`, `script` computes the map."""
    if suffix == "py":
        return script.encode()
    study = rb.open_study(inside(folder, name, ".zarr")).load()
    if suffix == "csv":
        return bytes(study.to_dataframe().to_csv().encode())
    with tempfile.TemporaryDirectory() as place:
        target = Path(place) / f"{name}.{suffix}"
        if suffix == "nc":
            study.to_netcdf(target)
        elif suffix == "png":
            measure = next(str(each) for each in study.data_vars if each not in ("status", "warnings"))
            rb.plot_map(study, measure).savefig(target, dpi=200)
        elif suffix == "html":
            rb.write_report(study, target)
        else:
            raise rb.DataError(f"{suffix!r} is not a kind of file", ", ".join(MAP_FORMATS))
        return target.read_bytes()
