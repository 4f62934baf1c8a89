"""The subcommands `fmu` and `pack`."""

from __future__ import annotations

from pathlib import Path

import rattlebox as rb
from rattlebox._util.atomic_io import atomic_write, require_folder
from rattlebox._util.exceptions import DataError
from rattlebox.cli.output import output_file
from rattlebox.engines.fmu import fmu_and_notes


def write_fmu(case: Path, out: Path | None, fmi: int, by: str, alone: bool, other_systems: bool) -> None:
    """Write a case file as an FMU and print its name; see `rattlebox.to_fmu`."""
    content = rb.Case.from_file(case)
    with output_file(out, f"{case.stem}.fmu") as (file, note):
        _, notes = fmu_and_notes(content, file, fmi=fmi, input=by, alone=alone or None, other_systems=other_systems)
    others = "; libraries for other systems were never run" if other_systems else ""
    print(f"{file}: FMI {fmi}.0 for co-simulation on Linux x86-64{others}{note}", *notes, sep="\n  ")


def write_packed(case: Path, out: Path | None, alone: bool) -> None:
    """Write a case file as a packed case, for `rattlebox.h`."""
    default = f"{case.stem}.bin"
    if (file := out or Path(default)).exists() and file.samefile(case):
        raise DataError(f"-o {file}: this is the case file, which is not overwritten", f"-o {default}")
    require_folder(file)
    content = rb.Case.from_file(case)
    with output_file(out, default) as (file, note):
        stepper = rb.Stepper(content, alone=alone or None)
        with atomic_write(file) as name:
            name.write_bytes(stepper.packed)
    print(f"{file}: inputs {', '.join(stepper.inputs)}{note}", *stepper.notes, sep="\n  ")
