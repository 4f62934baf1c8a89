"""Runs an installed rattlebox: a case with each instruction set, the command line and an FMU.

Command: python smoke.py FOLDER, with steel_ball.toml in the folder; results are written there.
"""

import ctypes
import json
import os
import platform
import subprocess
import sys
import zipfile
from pathlib import Path

import rattlebox as rb
from rattlebox.core.choose import choice, supported

FIRST_SPEED = 0.1566058315137885  # approach speed of the first impact of the steel ball, m/s


def print_first_speed(case: Path) -> None:
    """Print the instruction set, the status of the run of a case, and the speed of its first impact."""
    run = rb.simulate(rb.Case.from_file(case), progress=False)
    print(json.dumps([choice()[0], run.status, float(run.impacts.approach_speed[0])]))


def check_installation(folder: Path) -> None:
    """Run the case with each instruction set, the command line and an FMU."""
    case = folder / "steel_ball.toml"
    assert Path(rb.__file__).is_relative_to(sys.prefix), rb.__file__
    for level in supported():
        command = [sys.executable, "-I", __file__, folder, level]
        environment = {**os.environ, "RATTLEBOX_SIMD": level}
        printed = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
        used, status, speed = json.loads(printed)
        assert (used, status) == (level, "finished")
        assert abs(speed / FIRST_SPEED - 1) < 1e-12, speed
    command = [Path(sys.executable).with_name("rattlebox"), "run", case, "-o", folder / "out", "--no-figures"]
    subprocess.run(command, check=True, capture_output=True)
    assert (folder / "out" / "run.nc").is_file()
    if platform.system() == "Linux" and platform.machine() == "x86_64":
        command = [Path(sys.executable).with_name("rattlebox"), "fmu", case, "--alone", "-o", folder / "ball.fmu"]
        subprocess.run(command, check=True, capture_output=True)
        with zipfile.ZipFile(folder / "ball.fmu") as fmu:
            (binary,) = (name for name in fmu.namelist() if name.endswith("x86_64-linux/ball.so"))
            library = ctypes.CDLL(fmu.extract(binary, folder / "fmu"))
        library.fmi3GetVersion.restype = ctypes.c_char_p
        assert library.fmi3GetVersion() == b"3.0"
        ctypes.CDLL(str(rb.component_library()))
    assert (rb.include_dir() / "rattlebox.h").is_file()
    assert (rb.include_dir() / "dem" / "simulation.hpp").is_file()
    print(f"instruction sets {', '.join(supported())}; a run, an FMU and the headers work")


if __name__ == "__main__":
    if len(sys.argv) > 2:  # in a process of its own, with one instruction set
        print_first_speed(Path(sys.argv[1]) / "steel_ball.toml")
    else:
        check_installation(Path(sys.argv[1]))
