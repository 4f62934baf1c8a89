"""The subcommands `fmu` and `pack`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import rattlebox as rb
from rattlebox.engines.fmu import fmu_and_notes


def write_fmu(case: Path, out: Path | None, fmi: Any, by: Any, alone: bool, other_systems: bool) -> None:
    """Write a case file as an FMU and print its name; see `rattlebox.to_fmu`."""
    content = rb.Case.from_file(case)
    file, notes = fmu_and_notes(
        content,
        out or Path(f"{case.stem}.fmu"),
        fmi=fmi,
        input=by,
        alone=alone or None,
        other_systems=other_systems,
    )
    others = "; libraries for other systems were never run" if other_systems else ""
    print(f"{file}: FMI {fmi}.0 for co-simulation on Linux x86-64{others}", *notes, sep="\n  ")


def write_packed(case: Path, out: Path | None, alone: bool) -> None:
    """Write a case file as a packed case, for `rattlebox.h`."""
    stepper = rb.Stepper(rb.Case.from_file(case), alone=alone or None)
    file = out or Path(f"{case.stem}.bin")
    file.write_bytes(stepper.packed)
    print(f"{file}: inputs {', '.join(stepper.inputs)}", *stepper.notes, sep="\n  ")
