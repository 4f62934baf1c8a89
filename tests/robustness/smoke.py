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
FOLDER = Path(sys.argv[1])
CASE = FOLDER / "steel_ball.toml"

if len(sys.argv) > 2:  # in a process of its own, with one instruction set
    run = rb.simulate(rb.Case.from_file(CASE), progress=False)
    print(json.dumps([choice()[0], run.status, float(run.impacts.approach_speed[0])]))
    sys.exit()

assert Path(rb.__file__).is_relative_to(sys.prefix), rb.__file__
for level in supported():
    command = [sys.executable, "-I", __file__, FOLDER, level]
    environment = {**os.environ, "RATTLEBOX_SIMD": level}
    printed = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
    used, status, speed = json.loads(printed)
    assert (used, status) == (level, "finished")
    assert abs(speed / FIRST_SPEED - 1) < 1e-12, speed
command = [Path(sys.executable).with_name("rattlebox"), "run", CASE, "-o", FOLDER / "out", "--no-figures"]
subprocess.run(command, check=True, capture_output=True)
assert (FOLDER / "out" / "run.nc").is_file()
if platform.system() == "Linux" and platform.machine() == "x86_64":
    command = [Path(sys.executable).with_name("rattlebox"), "fmu", CASE, "--alone", "-o", FOLDER / "ball.fmu"]
    subprocess.run(command, check=True, capture_output=True)
    with zipfile.ZipFile(FOLDER / "ball.fmu") as fmu:
        (binary,) = (name for name in fmu.namelist() if name.endswith("x86_64-linux/ball.so"))
        library = ctypes.CDLL(fmu.extract(binary, FOLDER / "fmu"))
    library.fmi3GetVersion.restype = ctypes.c_char_p
    assert library.fmi3GetVersion() == b"3.0"
    ctypes.CDLL(str(rb.component_library()))
assert (rb.include_dir() / "rattlebox.h").is_file()
assert (rb.include_dir() / "dem" / "simulation.hpp").is_file()
print(f"instruction sets {', '.join(supported())}; a run, an FMU and the headers work")
