"""FMUs in the co-simulation masters ECOS (ecospy) and libcosim (libcosimpy), which set inputs of the start of a step."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

import rattlebox as rb

STEPS, STEP = 240, 1e-3  # [s]

ECOS = """
import sys
from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
mass, ball, input_time, steps, step = *sys.argv[1:3], *map(float, sys.argv[3:])
EcosLib.set_log_level("warn")
with EcosSimulationStructure() as system:
    system.add_model("mass", mass)
    system.add_model("ball", ball)
    system.make_real_connection("mass::velocity_mass", "ball::velocity")
    system.make_real_connection("ball::force", "mass::load_1")
    system.add_parameter_set("set", {"mass::input_time": int(input_time), "ball::input_time": int(input_time)})
    with EcosSimulation(structure=system, step_size=step) as simulation:
        simulation.init(parameter_set="set")
        simulation.step(int(steps))
        print("result", simulation.get_integer("ball::input_time"), repr(simulation.get_real("mass::displacement_mass")))
        simulation.terminate()
"""

LIBCOSIM = """
import sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
mass, ball, input_time, steps, step = *sys.argv[1:3], *map(float, sys.argv[3:])
nanosecond = 1e-9
execution = CosimExecution.from_step_size(round(step / nanosecond))
slaves = [CosimLocalSlave(fmu_path=mass, instance_name="mass"), CosimLocalSlave(fmu_path=ball, instance_name="ball")]
m, b = (execution.add_local_slave(slave) for slave in slaves)
names = {k: {each.name.decode(): each.reference for each in execution.slave_variables(k)} for k in (m, b)}
for k in (m, b):
    execution.integer_initial_value(k, names[k]["input_time"], int(input_time))
execution.connect_real_variables(m, names[m]["velocity_mass"], b, names[b]["velocity"])
execution.connect_real_variables(b, names[b]["force"], m, names[m]["load_1"])
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.simulate_until(target_time=round(steps * step / nanosecond))
(given,) = observer.last_integer_values(b, [names[b]["input_time"]])
(displacement,) = observer.last_real_values(m, [names[m]["displacement_mass"]])
print("result", given, repr(displacement))
"""

# The module, the program, the versions of FMI that it imports, and the largest relative deviation from FMPy: libcosim counts
# time in nanoseconds.
IMPORTERS = {"ECOS": ("ecospy", ECOS, (2, 3), 0.0), "libcosim": ("libcosimpy", LIBCOSIM, (2,), 1e-9)}
CASES = [(name, fmi, order) for name, each in IMPORTERS.items() for fmi in each[2] for order in (1, 2)]


def mass() -> rb.Case:
    """A displaced mass on a spring, with a load for the force of the damper."""
    return rb.Case(
        structure=rb.SDOF(mass="1.3 kg", frequency="9 Hz", displacement="6 mm"),
        load=rb.Harmonic(amplitude="0 N", frequency="1 Hz"),
        duration="1 s",
    )


def ball() -> rb.ImpactDamper:
    """A ball in a cavity."""
    return rb.ImpactDamper(
        ball=rb.Sphere(diameter="22 mm", material="steel"), gap="2.5 mm", contact=rb.Tsuji(restitution=0.65)
    )


def in_fmpy(files: list[Path], input_time: int, folder: Path) -> float:
    """Return the displacement of the mass after the same exchange in FMPy: both get the values of the start of a step."""
    units, references = [], []
    for number, file in enumerate(files):
        description = fmpy.read_model_description(str(file))
        references.append({variable.name: variable.valueReference for variable in description.modelVariables})
        unit = FMU2Slave(
            guid=description.guid,
            unzipDirectory=fmpy.extract(str(file), str(folder / str(number))),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=str(number),
        )
        unit.instantiate()
        unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        unit.setInteger([references[-1]["input_time"]], [input_time])
        unit.exitInitializationMode()
        units.append(unit)
    (m, b), (of_m, of_b) = units, references
    for k in range(STEPS):
        (force,), (velocity,) = b.getReal([of_b["force"]]), m.getReal([of_m["velocity_mass"]])
        m.setReal([of_m["load_1"]], [force])
        b.setReal([of_b["velocity"]], [velocity])
        for unit in units:
            unit.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
    (displacement,) = m.getReal([of_m["displacement_mass"]])
    for unit in units:
        unit.terminate()
        unit.freeInstance()
    return float(displacement)


@pytest.mark.parametrize(("name", "fmi", "input_time"), CASES)
def test_a_coupling_gives_the_numbers_of_fmpy(name: str, fmi: int, input_time: int, tmp_path: Path) -> None:
    """Masters that cannot set enumerations set `input_time`; only FMPy was run before, which can set both."""
    module, program, _, largest = IMPORTERS[name]
    pytest.importorskip(module, exc_type=ImportError)
    try:
        importlib.import_module(f"{module}.lib" if module == "ecospy" else f"{module}._internal")
    except OSError as error:  # a library of the system is missing, for ECOS libtbb.so.12
        pytest.skip(f"{name} cannot be loaded: {error}")
    files = [rb.to_fmu(mass(), tmp_path / "mass.fmu", fmi=fmi)]  # type: ignore[arg-type]
    files.append(rb.to_fmu(ball(), tmp_path / "ball.fmu", fmi=fmi, structure_mass="1.3 kg"))  # type: ignore[arg-type]
    arguments = [*map(str, files), str(input_time), str(STEPS), str(STEP)]
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, timeout=60, check=True
    )
    given, displacement = next(line for line in done.stdout.splitlines() if line.startswith("result")).split()[1:]
    assert int(given.strip("[]")) == input_time
    twos = [
        rb.to_fmu(mass(), tmp_path / "mass2.fmu", fmi=2),
        rb.to_fmu(ball(), tmp_path / "b.fmu", fmi=2, structure_mass="1.3 kg"),
    ]
    expected = in_fmpy(twos, input_time, tmp_path)
    np.testing.assert_allclose(float(displacement), expected, rtol=largest, atol=0)
