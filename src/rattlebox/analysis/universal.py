"""Response functions, spectra and modes as universal files (UFF)."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.write.universal import (
    COHERENCE,
    DENSITY,
    GENERAL,
    RESPONSE_FUNCTION,
    TRANSMISSIBILITY,
    Function,
    Node,
    function_set,
    modes_sets,
    universal_nodes,
    write_universal,
)
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.modes import ModalModel
from rattlebox.model.space import unit_vector
from rattlebox.results.export import nodes_of
from rattlebox.results.run import Run

from .measured import ratio_of_units

if TYPE_CHECKING:
    import xarray

_WHAT = "a run, a dataset over frequency, several of them by name, a structure or a case"


def to_uff(
    source: Any,
    path: str | os.PathLike[str],
    *,
    nodes: Mapping[str, int | str] | None = None,
    positions: Mapping[str, Sequence[float]] | None = None,
    direction: str = "z",
) -> Path:
    """Write a universal file (UFF), which programs for experimental modal analysis read.

    Parameters
    ----------
    source
        A result over frequency (`rb.frequency_response`, `rattlebox.analysis.transfer_function` and others), or a dict of
        them by name: a set 58b for each function. A structure or a case: a set 55 for each mode. A run: see `Run.to_uff`.
    path
        File to write (.uff, .unv). A file that Rattlebox did not write, or that has changed since, is not replaced.
    nodes
        Nodes of the points of a structure, or of functions by name: `{"tip": "21 z"}`, or `{"tip": 21}` for a point in 3-D;
        default 1, 2, ... in their order.
    positions
        Positions of points of a structure [m]; they are written as set 2411.
    direction
        Direction of points of a structure that move along one line and have none in `nodes`.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CaseError
        If the source is something else, or a point does not exist.
    DataError
        If the file cannot be written or must not be replaced, or a result has no function of the frequency.
    ResourceError
        If no space is left on the disk.

    Warns
    -----
    UserWarning
        If the damping couples modes: only its diagonal is written.

    Notes
    -----
    The response function of a frequency response is H = A exp(i phi) / L with the amplitude A and the phase phi of the first
    harmonic and the amplitude L of the load; with a damper it holds for this L only. Frequencies without a value are left
    out. Values of functions are doubles and read back to the last bit; evenly spaced frequencies are stored as start and
    step with about eight digits, and modes, which are normalised to 1 kg, with at least seven.

    Examples
    --------
    >>> import rattlebox as rb
    >>> rb.to_uff(rb.SDOF(mass="2 kg", frequency="12 Hz", damping_ratio=0.01), "modes.uff").name
    'modes.uff'
    """
    file, numbers = Path(path), universal_nodes(nodes)
    if isinstance(source, Run):
        return source.to_uff(file, nodes=nodes)
    model = source.modes if isinstance(source, Case) else source.modes() if hasattr(source, "modes") else None
    if isinstance(model, ModalModel):
        return write_universal(file, _modes(model, numbers, positions or {}, direction))
    results = source if isinstance(source, Mapping) and not hasattr(source, "data_vars") else {"": source}
    if not all(hasattr(each, "coords") for each in results.values()):
        raise Hint(f"{source!r:.60} cannot be written to a universal file", _WHAT)
    functions = [f for name, each in results.items() for f in _functions(str(name), each, numbers)]
    if not functions:
        raise DataError(f"{file}: the result has no function of the frequency", _WHAT)
    return write_universal(file, [function_set(each) for each in functions])


def _functions(name: str, result: Any, nodes: Mapping[str, Node]) -> Iterator[Function]:
    """Yield the functions of frequency in a dataset or an array."""
    data = result.to_dataset(name=result.name or "function") if not hasattr(result, "data_vars") else result
    if {"amplitude", "phase"} <= set(data.data_vars) and {"level", "frequency"} <= set(data.coords):
        ratio = data.amplitude * np.exp(1j * data.phase) / data.level
        units = data.amplitude.attrs.get("units", ""), data.level.attrs.get("units", "")
        for label, x, values in _rows(ratio):
            yield _function(
                _joined(name, "response", label), RESPONSE_FUNCTION, x, values, units, nodes.get(name, (0, 0))
            )
        return
    for key, variable in data.data_vars.items():
        if variable.dims[-1:] != ("frequency",) or variable.dtype.kind not in "fc":
            continue
        unit = str(variable.attrs.get("units", ""))
        kind, units = GENERAL, (unit, "")
        if variable.dtype.kind == "c":
            kind, units = RESPONSE_FUNCTION, ratio_of_units(unit) or (unit, "")
            kind = TRANSMISSIBILITY if unit == "1" else kind
        elif str(key).startswith("coherence"):
            kind = COHERENCE
        elif unit.endswith("/Hz"):
            kind = DENSITY
        for label, x, values in _rows(variable):
            yield _function(_joined(name, str(key), label), kind, x, values, units, nodes.get(name, (0, 0)))


def _rows(variable: xarray.DataArray) -> Iterator[tuple[str, Any, Any]]:
    """Yield label, frequencies and values of each function, without values that are not finite."""
    moved = variable.transpose(..., "frequency")
    x = np.asarray(moved.frequency.values, dtype=float)
    for index in product(*(range(size) for size in moved.shape[:-1])):
        values = np.asarray(moved.values[index])
        known = np.isfinite(values)
        words = [_word(moved, str(dim), k) for dim, k in zip(moved.dims[:-1], index, strict=True)]
        if known.sum() >= 2:
            yield " ".join(words), x[known], values[known]


def _word(variable: xarray.DataArray, dim: str, k: int) -> str:
    if dim not in variable.coords:
        return f"{dim} {k}"
    value, unit = variable[dim].values[k], variable[dim].attrs.get("units", "")
    return f"{value:.6g} {unit}".strip() if isinstance(value, (float, np.floating)) else str(value)


def _joined(*words: str) -> str:
    return " ".join(word for word in words if word)


def _function(name: str, kind: int, x: Any, values: Any, units: tuple[str, str], node: Node) -> Function:
    return Function(name, kind, x, "Hz", values, *units, response=node)


def _modes(
    model: ModalModel, nodes: Mapping[str, Node], positions: Mapping[str, Sequence[float]], direction: str
) -> list[bytes]:
    """Return the sets of the modes of a structure."""
    numbers = nodes_of(model.shapes, nodes)
    for name in positions:
        model.point(name)
    if not model.decay.size:
        raise Hint("the structure has no modes", "a structure that moves")
    omega = np.sqrt(model.stiffness)
    with np.errstate(divide="ignore", invalid="ignore"):
        damping = np.where(omega > 0, model.decay / omega, 0.0)
    if (model.coupling is not None and np.any(model.coupling)) or np.any(model.decay[omega == 0]):
        warnings.warn("the damping couples modes, or acts on rigid ones: only damping ratios are written", stacklevel=3)
    shapes: dict[int, Any] = {}
    for point, (node, axis) in numbers.items():
        if point in model.spatial:
            shape = model.shapes[point]
        else:
            along = np.sign(axis) * np.eye(3)[abs(axis) - 1] if axis else unit_vector(direction)
            shape = np.multiply.outer(model.shapes[point], along)
        shapes[node] = shapes.get(node, 0.0) + shape  # points of one node along several axes
    places = {numbers[point][0]: place for point, place in positions.items()}
    return modes_sets(omega / (2 * np.pi), damping, shapes, places)
