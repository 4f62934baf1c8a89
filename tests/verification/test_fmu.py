"""FMUs in FMPy: valid, equal to steppers, coupled, rewound, and with errors instead of wrong numbers."""

from __future__ import annotations

import ctypes
import errno
import gc
import shutil
import subprocess
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import rattlebox as rb

VERSIONS = (2, 3)
SPRING = (2 * np.pi * 10) ** 2  # N/m, of a mass of 1 kg


def ball(**changes: Any) -> rb.ImpactDamper:
    """A ball with room to fly."""
    given = {"ball": rb.Sphere(radius="10 mm", material="steel"), "gap": "3 mm", "contact": rb.Tsuji(restitution=0.6)}
    return rb.ImpactDamper(**{**given, **changes})


def box(softening: float = 1e3) -> rb.ParticleDamper:
    """A box of balls with friction."""
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=50),
        cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.75),
        softening=softening,
    )


def structure(**changes: Any) -> rb.Case:
    """A mass on a spring with a ball under a load."""
    given: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="10 Hz"),
        "damper": ball(),
        "load": rb.HalfSine(amplitude="20 N", duration="20 ms"),
        "duration": "0.3 s",
    }
    return rb.Case(**{**given, **changes})


SYSTEMS = {"ball": ball, "box": box, "structure": structure, "structure with box": lambda: structure(damper=box())}


class Unit:
    """An FMU in FMPy, with the same functions for both versions."""

    def __init__(self, file: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(file))
        self.reference = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        kind = FMU2Slave if self.description.fmiVersion == "2.0" else FMU3Slave
        self.is_2 = kind is FMU2Slave
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(file), str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.fmu.instantiate(loggingOn=True)

    def initialize(self, **values: float) -> None:
        """Pass the initialization; `values` are set before its end."""
        if self.is_2:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        self.set(**values)
        self.fmu.exitInitializationMode()

    def set(self, **values: float) -> None:
        """Set variables by name."""
        for name, value in values.items():
            reference = [self.reference[name]]
            if name == "input_time":
                (self.fmu.setInteger if self.is_2 else self.fmu.setInt32)(reference, [int(value)])
            else:
                (self.fmu.setReal if self.is_2 else self.fmu.setFloat64)(reference, [value])

    def get(self, *names: str) -> list[float]:
        """Return variables by name."""
        return list((self.fmu.getReal if self.is_2 else self.fmu.getFloat64)([self.reference[name] for name in names]))

    def step(self, time: float, length: float, **inputs: float) -> None:
        """Set inputs and make a step."""
        self.set(**inputs)
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def save(self) -> Any:
        """Return a state."""
        return self.fmu.getFMUState() if not self.is_2 else self.fmu.getFMUstate()

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        (self.fmu.setFMUstate if self.is_2 else self.fmu.setFMUState)(state)

    def forget(self, state: Any) -> None:
        """Free a state."""
        (self.fmu.freeFMUstate if self.is_2 else self.fmu.freeFMUState)(state)


@contextmanager
def unit(folder: Path, system: Any, fmi: int, **options: Any) -> Iterator[Unit]:
    """Write an FMU and load it."""
    folder.mkdir(exist_ok=True)
    made = Unit(rb.to_fmu(system, folder / "damper.fmu", fmi=fmi, **options), folder / "unzipped")
    yield made
    made.fmu.freeInstance()


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_fmpy_finds_no_fault(name: str, fmi: int, tmp_path: Path) -> None:
    """The description is valid, and the binary is found and simulated by FMPy as it is."""
    file = rb.to_fmu(SYSTEMS[name](), tmp_path / "damper.fmu", fmi=fmi)
    assert validate_fmu(str(file)) == []
    result = fmpy.simulate_fmu(str(file), stop_time=0.01, step_size=1e-3, output_interval=1e-3)
    assert result["time"][-1] == pytest.approx(0.01)
    assert np.isfinite(result["stored"]).all()


def test_the_binary_needs_libc_and_libm_only(tmp_path: Path) -> None:
    """The shared library in the FMU depends on nothing else."""
    fmpy.extract(str(rb.to_fmu(ball(), tmp_path / "damper.fmu")), str(tmp_path / "x"))
    (library,) = (tmp_path / "x").rglob("*.so")
    listed = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout.split("\n")
    names = {line.split()[0].split("/")[-1].split(".")[0] for line in listed if line.strip()}
    assert names <= {
        "linux-vdso",
        "libm",
        "libc",
        "ld-linux-x86-64",
        "libpthread",
        "libdl",
    }  # glibc below 2.34 has five parts


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("by", ["velocity", "acceleration"])
def test_inputs_of_the_end_give_the_steps_of_a_stepper(by: str, fmi: int, tmp_path: Path) -> None:
    """With the inputs of the end of each step, an FMU has the forces and energies of a stepper, to the last bit."""
    stepper, h, work = rb.Stepper(ball(), velocity=0.4), 1e-3, 0.0
    if by == "acceleration":
        stepper = rb.Stepper(ball(), velocity=0.0)
    with unit(tmp_path, ball(), fmi, input=by) as own:
        first = before = 0.4 if by == "velocity" else 40.0
        own.initialize(**{by: first})
        for k in range(100):
            value = first * np.cos(60 * (k + 1) * h)
            own.step(k * h, h, **{by: value})
            given = value if by == "velocity" else value - 0.5 * (value - before)
            result = stepper.advance(stepper.time + h, **{by: given})
            work, before = work + result.work, value
            assert own.get("force", "stored") == pytest.approx([result.force, result.stored], rel=1e-9, abs=1e-12)
        assert own.get("work")[0] == pytest.approx(work)
        assert any(own.get("loss"))


@pytest.mark.parametrize("input_time", [1, 2])
@pytest.mark.parametrize("by", ["velocity", "acceleration"])
def test_both_input_times_have_second_order(by: str, input_time: int, tmp_path: Path) -> None:
    """Inputs of the start and of the end of each step both approach the shaken run with the square of the step."""
    rate, top = 2 * np.pi * 20, 2e-3
    motion = rb.Harmonic(amplitude=f"{top} m", frequency="20 Hz")
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=ball(gap="2 mm"), duration="0.09 s")
    loss = float(rb.simulate(case, progress=False).impacts["energy_lost"].sum())
    damper = ball(gap="2 mm", velocity=top * rate if by == "velocity" else 0.0)
    value = {
        "velocity": lambda t: top * rate * np.cos(rate * t),
        "acceleration": lambda t: -top * rate**2 * np.sin(rate * t),
    }[by]
    with unit(tmp_path, damper, 3, input=by) as own:
        start, errors = own.save(), []
        for steps in (900, 3600):
            own.restore(start)
            own.initialize(input_time=input_time, **{by: value(0.0)})
            for k in range(steps):
                h = 0.09 / steps
                own.step(k * h, h, **{by: value((k if input_time == 1 else k + 1) * h)})
            errors.append(abs(own.get("loss")[0] / loss - 1))
        own.forget(start)
    assert errors[1] < errors[0] / 8
    assert errors[1] < 2e-4


@pytest.mark.parametrize("input_time", [1, 2])
def test_loads_of_a_structure_have_second_order(input_time: int, tmp_path: Path) -> None:
    """Loads of the start and of the end of each step approach the run in second order; only dampers alone were tested."""
    load = rb.Harmonic(amplitude="20 N", frequency="7 Hz")
    case = structure(load=load, damper=ball(gap="1 m"))
    expected = float(rb.simulate(case, progress=False).motion.displacement.values[-1].item())
    errors = []
    for steps in (300, 1200):
        with unit(tmp_path / f"{steps}", case, 3) as own:
            own.initialize(input_time=input_time)
            h = 0.3 / steps
            for k in range(steps):
                time = (k if input_time == 1 else k + 1) * h
                own.step(k * h, h, load_1=20 * np.sin(2 * np.pi * 7 * time))
            errors.append(abs(own.get("displacement_mass")[0] / expected - 1))
    assert errors[1] < errors[0] / 12
    assert errors[1] < 1e-3


@pytest.mark.parametrize("fmi", VERSIONS)
def test_coupled_to_a_mass_on_a_spring_it_approaches_the_whole_run(fmi: int, tmp_path: Path) -> None:
    """Two FMUs, a mass on a spring and a ball, exchange velocity and force and approach the coupled run."""
    displaced = rb.SDOF(mass="1 kg", frequency="10 Hz", displacement="5 mm")
    whole = rb.simulate(structure(structure=displaced, damper=ball(), load=[]), progress=False)
    assert whole.impacts.sizes["impact"] >= 4
    host = rb.Case(
        structure=displaced,
        load=rb.Harmonic(amplitude="0 N", frequency="1 Hz"),
        duration="1 s",
        dampers=(),
    )
    errors = []
    for steps in (6000, 24000):
        with (
            unit(tmp_path / f"{steps}a", host, fmi) as mass,
            unit(tmp_path / f"{steps}b", ball(), fmi, structure_mass="1 kg") as own,
        ):
            mass.initialize(input_time=2)
            own.initialize()
            h = 0.3 / steps
            for k in range(steps):
                mass.step(k * h, h, load_1=own.get("force")[0])
                own.step(k * h, h, velocity=mass.get("velocity_mass")[0])
            (x,) = mass.get("displacement_mass")
            errors.append(abs(x - float(whole.motion.displacement.values[-1].item())))
    assert errors[1] < 1.5e-5
    assert errors[1] < errors[0]


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_rewound_steps_have_the_same_bits(name: str, fmi: int, tmp_path: Path) -> None:
    """After going back to a state, also through its bytes, the outputs repeat to the last bit."""
    with unit(tmp_path, SYSTEMS[name](), fmi) as own:
        own.initialize()
        inputs = [v.name for v in own.description.modelVariables if v.causality == "input"]
        outputs = [v.name for v in own.description.modelVariables if v.causality == "output"]

        def go(first: int, steps: int) -> list[list[float]]:
            seen = []
            for k in range(first, first + steps):
                own.step(k * 1e-3, 1e-3, **{name: 0.5 * np.sin(0.5 * k + i) for i, name in enumerate(inputs)})
                seen.append(own.get(*outputs))
            return seen

        go(0, 30)
        state = own.save()
        expected = go(30, 20)
        own.restore(state)
        assert go(30, 20) == expected
        if own.is_2:
            data = own.fmu.serializeFMUstate(state)
            other = own.fmu.deSerializeFMUstate(data, ctypes.c_void_p())
        else:
            data = own.fmu.serializeFMUState(state)
            other = own.fmu.deserializeFMUState(data)
        own.restore(other)
        assert go(30, 20) == expected
        own.forget(state)
        own.forget(other)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_parameters_change_the_case(fmi: int, tmp_path: Path) -> None:
    """Restitution holds before the first step and is refused after it; gravity can be changed between steps."""
    damper = ball(velocity="0.5 m/s")
    with unit(tmp_path, damper, fmi) as own:
        own.initialize(restitution=0.9)
        assert own.get("restitution") == [0.9]
        impulse = 0.0
        for k in range(100):
            own.step(k * 1e-4, 1e-4, velocity=0.0)
            impulse += own.get("force")[0] * 1e-4
        assert impulse == pytest.approx(float(damper.masses[0]) * 0.5 * 1.9, rel=1e-6)
        with pytest.raises(Exception, match="failed"):
            own.set(restitution=0.5)
    with unit(tmp_path / "b", ball(), fmi) as own:
        own.initialize()
        own.step(0.0, 1e-3, velocity=0.0)
        own.set(gravity=9.81)
        for k in range(1, 2000):
            own.step(k * 1e-3, 1e-3, velocity=0.0)
        assert own.get("force")[0] == pytest.approx(9.81 * float(damper.masses[0]), rel=1e-6)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_bad_values_return_an_error_and_a_message(fmi: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """NaN, steps that are negative or not in order, and unknown variables return an error; the logger gets the reason."""
    with unit(tmp_path, ball(), fmi) as own:
        own.initialize()
        own.step(0.0, 1e-3, velocity=0.1)
        for act, reason in (
            (lambda: own.set(velocity=float("nan")), "a value is not finite"),
            (lambda: own.set(gravity=float("inf")), "a value is not finite"),
            (lambda: own.set(input_time=3), "input_time is 1 (start) or 2 (end)"),
            (lambda: own.set(restitution=0.5), "fixed after the initialization"),
            (lambda: own.step(1e-3, -1e-3), "longer than zero"),
            (lambda: own.step(1e-3, float("nan")), "longer than zero, and finite"),
            (lambda: own.step(0.0, 1e-3), "does not begin where the last one ended"),
            (lambda: (own.fmu.getReal if own.is_2 else own.fmu.getFloat64)([12345]), "no such variable"),
        ):
            capsys.readouterr()
            with pytest.raises(Exception, match="failed"):
                act()
            assert reason in capsys.readouterr().out
        own.step(1e-3, 1e-3, velocity=0.1)
        assert np.isfinite(own.get("force")[0])


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(
    ("system", "gentle", "hard", "reason"),
    [
        (ball, 0.1, 40.0, "overlaps in"),
        (
            lambda: ball(contact=rb.Tsuji(restitution=rb.Tabulated(speeds=[0.1, 1], values=[0.9, 0.6]))),
            0.2,
            3.0,
            "table of restitution",
        ),
        (lambda: box(softening=10), 0.05, 20.0, "fewer than 20 steps"),
    ],
    ids=["deep overlap", "table", "few steps"],
)
def test_contacts_beyond_the_model_are_reported_once(
    system: Any, gentle: float, hard: float, reason: str, fmi: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The importer's log gets one warning when contacts leave the range of the model, and none before."""
    with unit(tmp_path, system(), fmi) as own:
        velocity = "velocity" if "velocity" in own.reference else "velocity_z"
        own.initialize(**{velocity: -gentle})
        for k in range(120):
            sign = 1 if k // 20 % 2 else -1
            if k == 60:
                assert "warning" not in capsys.readouterr().out.lower()
            own.step(k * 1e-3, 1e-3, **{velocity: sign * (gentle if k < 60 else hard)})
        lines = [line for line in capsys.readouterr().out.splitlines() if reason in line]
        assert len(lines) == 1 and "warning" in lines[0].lower()
        assert np.isfinite(own.get("stored")[0])


class MallocInfo(ctypes.Structure):
    """The structure `mallinfo2` of the C library."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in [
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "fordblks",
            "keepcost",
        ]
    ]


def allocated_bytes() -> int:
    """Return the number of bytes that `malloc` has given out and that were not freed."""
    function = ctypes.CDLL(None).mallinfo2
    function.restype = MallocInfo
    info = function()
    return int(info.uordblks + info.hblkhd)


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallinfo2"), reason="the C library has no mallinfo2")
@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("instances", [250, pytest.param(1000, marks=pytest.mark.slow)])
def test_instances_leak_nothing(fmi: int, instances: int, tmp_path: Path) -> None:
    """Instances one after the other, and as many states, leave no allocated memory behind: less than 200 bytes each.

    The objects of FMPy refer to each other, so that only the garbage collector frees them, which it rarely does in a process
    with many older objects: 40 to 90 kB an instance of the resident memory are theirs.
    """
    file = rb.to_fmu(ball(), tmp_path / "damper.fmu", fmi=fmi)
    folder = fmpy.extract(str(file), str(tmp_path / "x"))
    description = fmpy.read_model_description(str(file))
    kind = FMU2Slave if fmi == 2 else FMU3Slave

    def use(count: int) -> int:
        for _ in range(count):
            own = kind(guid=description.guid, unzipDirectory=folder, modelIdentifier="damper", instanceName="a")
            own.instantiate()
            if fmi == 2:
                own.setupExperiment()
            own.enterInitializationMode()
            own.exitInitializationMode()
            own.doStep(currentCommunicationPoint=0.0, communicationStepSize=1e-3)
            state = own.getFMUstate() if fmi == 2 else own.getFMUState()
            (own.freeFMUstate if fmi == 2 else own.freeFMUState)(state)
            (own.fmi2FreeInstance if fmi == 2 else own.fmi3FreeInstance)(own.component)
        gc.collect()
        return allocated_bytes()

    use(50)
    # Other parts of the process may take memory at any time; a leak is seen in every part of the loop.
    sizes = [use(instances // 5) for _ in range(6)]
    assert min(np.diff(sizes)) < 200 * instances / 5


def test_a_missing_resource_is_an_error(tmp_path: Path) -> None:
    """An FMU whose packed case is damaged cannot be instantiated."""
    file = rb.to_fmu(ball(), tmp_path / "damper.fmu")
    folder = Path(fmpy.extract(str(file), str(tmp_path / "x")))
    description = fmpy.read_model_description(str(file))
    case = folder / "resources" / "case.bin"
    whole = case.read_bytes()
    for content in (b"", whole[:60], whole[:50] + b"\1" + whole[51:]):
        case.write_bytes(content)
        own = FMU3Slave(guid=description.guid, unzipDirectory=str(folder), modelIdentifier="damper", instanceName="a")
        with pytest.raises(Exception, match="nstantiate"):
            own.instantiate()
    shutil.rmtree(folder)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_libraries_for_other_systems_are_added_on_request(
    fmi: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The binaries are in the folders of the FMI standard, and the page of the FMU states that they were never run."""
    files = {system: tmp_path / f"other.{end}" for system, end in (("aarch64-linux", "so"), ("x86_64-windows", "dll"))}
    for file in files.values():
        file.write_bytes(b"library")
    monkeypatch.setattr("rattlebox.engines.fmu.other_libraries", lambda: files)
    file = rb.to_fmu(ball(), tmp_path / "damper.fmu", fmi=fmi, other_systems=True)
    assert validate_fmu(str(file)) == []
    with zipfile.ZipFile(file) as content:
        binaries = {name for name in content.namelist() if name.startswith("binaries")}
        page = content.read("documentation/index.html").decode()
    folders = ("linux64/damper.so", "win64/damper.dll") if fmi == 2 else (
        "x86_64-linux/damper.so", "aarch64-linux/damper.so", "x86_64-windows/damper.dll"
    )  # fmt: skip
    assert binaries == {f"binaries/{name}" for name in folders}
    assert "compiled, never run: " in page


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"fmi": 1}, "fmi"),
        ({"input": "force"}, "input"),
        ({"path": "damper.zip"}, ".fmu"),
        ({"system": "two"}, "damper"),
    ],
)
def test_wrong_options_are_refused(options: dict[str, Any], named: str, tmp_path: Path) -> None:
    """Options outside their range raise an error that names them."""
    two = structure(damper=[ball(), ball()]) if "system" in options else None
    options = {key: value for key, value in options.items() if key != "system"}
    path = tmp_path / options.pop("path", "damper.fmu")
    with pytest.raises(rb.CaseError, match=named):
        rb.to_fmu(two or ball(), path, alone=None if two is None else True, **options)


def test_a_missing_folder_is_not_created(tmp_path: Path) -> None:
    """An FMU in a folder that does not exist is refused, and no folder is created."""
    with pytest.raises(rb.DataError, match="no folder"):
        rb.to_fmu(ball(), tmp_path / "missing" / "damper.fmu")
    assert list(tmp_path.iterdir()) == []


def test_an_fmu_that_cannot_be_written_leaves_the_earlier_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk and a folder of the same name end with an error of the package, and nothing is left or lost."""
    file = tmp_path / "damper.fmu"
    rb.to_fmu(ball(), file)
    before = file.read_bytes()

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(rb.ResourceError, match="no space is left"):
        rb.to_fmu(ball(), file, fmi=2)
    monkeypatch.undo()
    assert file.read_bytes() == before and [each.name for each in tmp_path.iterdir()] == ["damper.fmu"]
    (tmp_path / "folder.fmu").mkdir()
    for path in (tmp_path / "folder.fmu", file / "damper.fmu"):
        with pytest.raises(rb.DataError, match=f"{path.name}"):
            rb.to_fmu(ball(), path)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_variables_that_every_importer_can_set(fmi: int, tmp_path: Path) -> None:
    """The time of the inputs is an integer, units stand in declared types, and descriptions name load and point.

    FMPy sets enumerations, too, so that no test saw that other importers leave them at their start values.
    """
    structure = rb.Modal(frequencies=[5.0, 31.0], damping_ratio=0.01, shapes={"tip": [0.5, 0.1], "mid": [0.2, -0.4]})
    loads = [
        rb.Harmonic(amplitude="2 N", frequency="5 Hz", point="tip"),
        rb.HalfSine(amplitude="1 N", duration="2 ms", point="mid"),
    ]
    case = rb.Case(
        structure=structure,
        loads=loads,
        dampers=[rb.reference_case().dampers[0].model_copy(update={"point": "tip"})],
        duration=0.1,
    )
    path = rb.to_fmu(case, tmp_path / "a.fmu", fmi=fmi)  # type: ignore[arg-type]
    description = fmpy.read_model_description(str(path), validate=True)
    variables = {variable.name: variable for variable in description.modelVariables}
    assert variables["input_time"].type == ("Integer" if fmi == 2 else "Int32")
    assert [variables[f"load_{k}"].description for k in (1, 2)] == [
        "load, in place of the harmonic at tip",
        "load, in place of the half sine at mid",
    ]
    for variable in description.modelVariables:
        assert variable.unit is None
        if variable.declaredType is not None:
            assert variable.declaredType.unit == variable.declaredType.name
    assert variables["displacement_tip"].declaredType.unit == "m"
    with unit(tmp_path, case, fmi) as own:
        own.initialize(input_time=1)
        own.step(0.0, 1e-3)
        own.fmu.terminate()
        with pytest.raises(Exception, match="fmi"):
            own.step(1e-3, 1e-3)
