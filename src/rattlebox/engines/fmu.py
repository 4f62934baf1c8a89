"""Functional mock-up units (FMI 2.0 and 3.0, co-simulation) of dampers."""

from __future__ import annotations

import io
import math
import os
import re
import struct
import uuid
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import rattlebox
from rattlebox._util.atomic_io import atomic_write, require_folder
from rattlebox._util.own_files import seal
from rattlebox._util.templates import render
from rattlebox.core import _core
from rattlebox.core.component import component_library, other_libraries
from rattlebox.model.case import Case
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.errors import Hint
from rattlebox.model.methods import Method
from rattlebox.model.particle_damper import ParticleDamper
from rattlebox.model.signals import Signal
from rattlebox.model.units import Quantity
from rattlebox.prepare.component import PackedComponent, pack_component

from .run_notes import validity_limits
from .stepper import component_case

AXES = "xyz"
BASE_UNITS = {
    "s": {"s": 1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
}
"""Units of the variables, by SI base units."""

# First value references, as in core/stepper/fmu.hpp.
INPUT_TIME, GRAVITY, RESTITUTION, FRICTION, WORK, LOSS, STORED, INPUT = 1, 2, 5, 6, 7, 8, 9, 10
FORCE, MOMENT, DISPLACEMENT, VELOCITY = 100, 400, 1000, 2000
FMI_2_FOLDERS = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}
"""Folders of the systems that FMI 2 names."""

MOST_INPUTS, MOST_DAMPERS, MOST_OUTPUTS = 90, 100, 1000


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU."""

    name: str
    reference: int
    unit: str
    description: str
    causality: str = "output"
    variability: str = "continuous"
    start: float | None = None


def to_fmu(
    system: Case | ImpactDamper | ParticleDamper,
    path: str | os.PathLike[str],
    *,
    fmi: Literal[2, 3] = 3,
    input: Literal["velocity", "acceleration"] = "velocity",
    alone: bool | None = None,
    method: Method | None = None,
    motion: Signal | None = None,
    structure_mass: Quantity | None = None,
    other_systems: bool = False,
) -> Path:
    """Write a damper, or a structure with dampers, as an FMU for co-simulation on Linux x86-64.

    Parameters
    ----------
    system, alone, method, motion, structure_mass
        As for `Stepper`. A damper alone has the motion of its attachment as input and force and moment as outputs; a
        structure with dampers has loads as inputs and motions and forces as outputs.
    path
        File to write (.fmu). An existing file is replaced.
    fmi
        Version of FMI, 2 or 3.
    input
        Input of a damper alone: velocity or acceleration of the attachment.
    other_systems
        Whether the FMU also contains libraries for Windows x86-64 and macOS x86-64, and with FMI 3 for Linux arm64 and macOS
        arm64. These are compiled, but were never run.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CaseError
        If the case is not valid, its method has no stepper, or it has too many variables.
    DataError
        If the file cannot be written; an earlier one is then unchanged.
    ResourceError
        If this system has no binary of the core for FMUs, or the installation none for other systems; or if no space is
        left on the disk.

    Notes
    -----
    The FMU is self-contained: it needs neither Python nor Rattlebox. Its integer parameter `input_time` is the end of a
    communication step to which the inputs belong: 1 is the start, from which they are extrapolated linearly, 2 the end.
    Gravity can be changed between steps, restitution and friction before the initialization. The page
    documentation/index.html in the FMU lists the notes of the stepper (`Stepper.notes`). For the equations see `Stepper`.

    References
    ----------
    Modelica Association, Functional Mock-up Interface Specification, versions 2.0 (2014) and 3.0 (2022),
    https://fmi-standard.org.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.reference_case().dampers[0]
    >>> rb.to_fmu(damper, "damper.fmu", structure_mass="2.37 kg").name
    'damper.fmu'
    """
    options = {"alone": alone, "method": method, "motion": motion, "structure_mass": structure_mass}
    return fmu_and_notes(system, path, fmi=fmi, input=input, other_systems=other_systems, **options)[0]


def fmu_and_notes(
    system: Case | ImpactDamper | ParticleDamper,
    path: str | os.PathLike[str],
    *,
    fmi: int = 3,
    input: str = "velocity",
    other_systems: bool = False,
    **options: Any,
) -> tuple[Path, tuple[str, ...]]:
    """Write an FMU and return its file and the notes of its stepper; see `to_fmu`."""
    if fmi not in (2, 3):
        raise Hint(f"fmi = {fmi!r}: the versions are 2 and 3", "fmi=3")
    if input not in ("velocity", "acceleration"):
        raise Hint(f"input = {input!r}: an input is the velocity or the acceleration", 'input="velocity"')
    path = Path(path)
    if path.suffix != ".fmu":
        raise Hint(f"{path}: the name of an FMU must end with .fmu", f'"{path.with_suffix(".fmu")}"')
    require_folder(path)
    libraries = {"x86_64-linux": component_library(), **(other_libraries() if other_systems else {})}
    if fmi == 2:
        libraries = {FMI_2_FOLDERS[system]: file for system, file in libraries.items() if system in FMI_2_FOLDERS}
    case, alone = component_case(system, **options)
    packed = pack_component(case, alone=alone)
    model = re.sub(r"\W", "_", path.stem)
    token = str(uuid.uuid5(uuid.NAMESPACE_OID, packed.data.hex() + input))
    signals = () if alone else (*case.loads, *case.base_acceleration())
    stops = tuple(stop.name for stop in case.each_stop)
    variables = list(_variables(packed, input, tuple(map(_described, signals)), stops))
    words: dict[str, object] = {"name": model, "variables": variables, "version": rattlebox.__version__, "token": token}
    words |= {"base_units": BASE_UNITS, "input_time": INPUT_TIME, "notes": packed.notes, "systems": list(libraries)}
    content = {
        "modelDescription.xml": _filled(f"fmi{fmi}.xml", words),
        **{f"binaries/{folder}/{model}{file.suffix}": file.read_bytes() for folder, file in libraries.items()},
        "resources/case.bin": packed.data,
        # A structure is driven by means of its loads over a step, whatever drives a damper alone.
        "resources/input": (input if alone else "acceleration").encode(),
        "resources/limits": _limits(case, packed).encode(),
        "documentation/index.html": _filled("fmu.html", words),
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for entry, data in content.items():
            file.writestr(zipfile.ZipInfo(entry), data, zipfile.ZIP_DEFLATED)
    with atomic_write(path) as name:
        name.write_bytes(seal(archive.getvalue(), ".fmu"))
    return path, packed.notes


def _filled(template: str, words: Mapping[str, object]) -> bytes:
    """Return a file of the FMU from its template."""
    return f"{render('rattlebox.engines', template, **words)}\n".encode()


def _limits(case: Case, packed: PackedComponent) -> str:
    """Return the validity limits of the contacts, as `read_limits` in core/stepper/fmu.hpp reads them."""
    lines = ["# quantity, index, bits of the value (the same in every locale), text"]
    for limit in validity_limits(case, packed.prepared):
        bits = int.from_bytes(struct.pack("<d", limit.value), "little")
        lines.append(f"{limit.quantity} {limit.index} {bits} {limit.text}")
    return "\n".join([*lines, ""])


def _described(signal: Signal) -> str:
    """Return kind, point and direction of a load or motion, for those who connect it in another program."""
    words = signal.kind.replace("_", " ")
    if signal.point is not None:
        words += f" at {signal.point}"
    if signal.direction is not None:
        axis = signal.direction
        words += f" along {axis if isinstance(axis, str) else '(' + ', '.join(f'{x:g}' for x in axis) + ')'}"
    return words


def _variables(
    packed: PackedComponent, quantity: str, signals: tuple[str, ...], stops: tuple[str, ...] = ()
) -> Iterator[Variable]:
    """Yield the variables in their order in the file; `quantity` is the input of a damper alone."""
    if len(packed.inputs) > MOST_INPUTS or len(packed.dampers) > MOST_DAMPERS:
        raise Hint(f"an FMU has at most {MOST_INPUTS} inputs and {MOST_DAMPERS} dampers", "a smaller case")
    if len(packed.outputs) * packed.axes > MOST_OUTPUTS:
        raise Hint(f"an FMU has at most {MOST_OUTPUTS} displacements", "fewer points")
    stepper = _core.Stepper(packed.data)
    ends = [""] if packed.axes == 1 else [f"_{axis}" for axis in AXES]

    def each(name: str, reference: int, unit: str, description: str, **more: Any) -> Iterator[Variable]:
        for number, end in enumerate(ends):
            yield Variable(name + end, reference + number, unit, description, **more)

    # Parameters, then inputs, then outputs: importers show them in this order.
    for number, end in enumerate(ends):
        yield Variable(
            f"gravity{end}", GRAVITY + number, "m/s2", "gravity", "parameter", "tunable", float(stepper.gravity[number])
        )
    for name, reference in (("restitution", RESTITUTION), ("friction", FRICTION)):
        value = float(getattr(stepper, name))
        if not math.isnan(value):
            yield Variable(name, reference, "", f"{name} of all contacts", "parameter", "fixed", value)
    if packed.alone:
        unit = {"velocity": "m/s", "acceleration": "m/s2"}[quantity]
        yield from each(quantity, INPUT, unit, f"{quantity} of the attachment", causality="input", start=0.0)
    else:
        for number, name in enumerate(packed.inputs):
            unit = "m/s2" if name.startswith("base") else "N"
            description = "acceleration of the base" if unit == "m/s2" else "load"
            where = f", in place of the {signals[number]}" if number < len(signals) else ""
            yield Variable(name, INPUT + number, unit, f"{description}{where}", "input", start=0.0)
    for number, damper in enumerate(packed.dampers):
        label = "" if packed.alone else f"_{_plain(damper)}"
        text = "mean force with which the stop pushes" if damper in stops else "mean force on the structure"
        yield from each(f"force{label}", FORCE + 3 * number, "N", f"{text} in the last step")
        if packed.alone and packed.axes == 3:
            yield from each("moment", MOMENT, "N.m", "mean moment on the structure in the last step")
    for number, point in enumerate(packed.outputs):
        first = number * packed.axes
        yield from each(f"displacement_{_plain(point)}", DISPLACEMENT + first, "m", f"displacement of {point}")
        yield from each(f"velocity_{_plain(point)}", VELOCITY + first, "m/s", f"velocity of {point}")
    yield Variable("work", WORK, "J", "work done on the component since the start")
    yield Variable("loss", LOSS, "J", "energy lost since the start")
    yield Variable("stored", STORED, "J", "energy stored at the end of the last step")


def _plain(name: str) -> str:
    return re.sub(r"\W", "_", name)
