"""Ctrl-C while a program of a user computes: it ends soon, whatever computes.

No test saw that some calls went on for up to 45 s, and that a design lost the signal while it predicted its time: Ctrl-C was
tested for studies and single runs only.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.ctrl_c import CtrlC
from support.waiting import wait_for

import rattlebox as rb

LONGEST = 2.0
"""Processor time of the process from the signal to its end [s], for each of two threads."""

PREAMBLE = """
import warnings
import numpy as np
import rattlebox as rb
warnings.simplefilter("ignore")
beam = rb.SDOF(mass="3 kg", frequency="25 Hz", damping_ratio="0.01 %")
ball = rb.ImpactDamper(
    ball=rb.Sphere(radius="4 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.75)
)
grains = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter="3 mm", count=300),
    cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
    contact=rb.Tsuji(restitution=0.7),
    friction=0.3,
    softening=200,
)
tremor = rb.Harmonic(amplitude="20 m/s^2", frequency="40 Hz", direction="z")
shaken = rb.Case(structure=rb.Shaker(motion=tremor), damper=grains, duration="60 s")
"""

PROGRAMS = {
    "damping curve of a ball": """
case = rb.Case(structure=beam, damper=ball, duration="900 s")
print("computing", flush=True)
rb.damping_curve(case, ["0.1 mm", "0.2 mm"], packings=300, progress=False)
""",
    "damping curve of particles": """
case = rb.Case(structure=beam, damper=grains, duration="60 s")
print("computing", flush=True)
rb.damping_curve(case, ["0.2 mm", "0.4 mm"], way="shaking", packings=9, progress=False)
""",
    "design": """
case = rb.Case(structure=beam, damper=grains, duration="60 s")
print("computing", flush=True)
rb.design(
    case, {"damper.friction": [0.2, 0.3, 0.4]}, {"damping_ratio": "max"}, amplitudes=["0.3 mm", "0.5 mm"],
    way="shaking", packings=3, progress=False,
)
""",
    "loss map": """
print("computing", flush=True)
rb.loss_map(shaken, ["10 m/s^2", "30 m/s^2"], [30.0, 50.0], progress=False)
""",
    "step of a stepper": """
stepper = rb.Stepper(grains, motion=tremor)
print("computing", flush=True)
stepper.advance(3600.0, acceleration=(0.0, 0.0, 2.0))
""",
    "processes": """
load = rb.Harmonic(amplitude="3 N", frequency="25 Hz")
case = rb.Case(structure=beam, damper=ball, load=load, duration="2000 s")
if __name__ == "__main__":
    print("computing", flush=True)
    rb.sweep(case, {"damper.gap": rb.linspace("0.1 mm", "1 mm", 400)}, "rms", backend="processes", workers=2)
""",
    "analysis of a long record": """
time = np.arange(3_000_017) / 2e4
values = np.exp(-0.05 * time) * np.cos(2 * np.pi * 60 * time)
print("computing", flush=True)
while True:
    rb.analysis.damping_ratio(time, values)
""",
}


QUICK = ("damping curve of particles", "design")
"""Programs that are not tested elsewhere in a shorter time."""


def used(group: int) -> float:
    """Return the processor time of the members of a process group so far [s]."""
    ticks = 0
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = file.read_text().rsplit(")", 1)[1].split()
        except OSError:  # it has ended
            continue
        if int(words[2]) == group:
            ticks += int(words[11]) + int(words[12])
    return ticks / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processor times are read from /proc")
@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in PROGRAMS]
)
def test_ctrl_c_ends_a_program(name: str, tmp_path: Path) -> None:
    """A program ends soon after Ctrl-C, by KeyboardInterrupt or as a stopped study, and leaves no process."""
    file = tmp_path / "program.py"
    file.write_text(PREAMBLE + PROGRAMS[name])
    with subprocess.Popen(
        [sys.executable, str(file)],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline() == "computing\n", process.stderr.read()
        before = used(process.pid)
        enough = 4.0 if name == "processes" else 0.7  # processes import the package first
        while used(process.pid) < before + enough:
            assert process.poll() is None
            time.sleep(0.02)
        before = used(process.pid)
        os.killpg(process.pid, signal.SIGINT)
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == -signal.SIGINT or "Stopped: stopped" in errors, errors
    assert usage.ru_utime + usage.ru_stime - before < 2 * LONGEST
    wait_for(lambda: not is_group(process.pid), 10)


def is_group(number: int) -> bool:
    """Return whether a process group has members."""
    try:
        os.killpg(number, 0)
    except ProcessLookupError:
        return False
    return True


def test_ctrl_c_ends_all_runs_of_a_list() -> None:
    """Ctrl-C ends the run of particles in progress, and those after it, which would each have needed a Ctrl-C."""
    grains = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=40),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.7),
        softening=200,
        packing=rb.Lattice(),
    )
    case = rb.Case(structure=rb.SDOF(mass="1 kg", frequency="30 Hz", velocity=0.3), damper=grains, duration="600 s")
    with CtrlC(1.0) as ctrl_c:
        runs = rb.simulate_many([case] * 3, progress=False)
    assert [run.status for run in runs] == ["interrupted"] * 3
    assert ctrl_c.elapsed() < 5
