"""Results of studies in MATLAB files; netCDF is written by xarray."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rattlebox._util.atomic_io import atomic_write, check_suffix, require_folder
from rattlebox.model.errors import Hint
from rattlebox.results.export import as_cells, as_column

if TYPE_CHECKING:
    import xarray


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


def _text(value: Any) -> Any:
    """Return an attribute as text, and a list of texts as cells."""
    return as_cells(value) if isinstance(value, (list, tuple)) else str(value)
