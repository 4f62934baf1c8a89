"""Packed cases and states of steppers that were changed without a wrong hash, and functions of FMI with wrong pointers."""

from __future__ import annotations

import ctypes
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core

HEADER = 40
"""Bytes before the content of a packed case; its hash is in the last eight."""

STATE_HEADER = 24
"""Bytes before the content of a state: hash of the case, hash of the content, length."""


def fnv(content: bytes) -> bytes:
    """Return the FNV-1a hash."""
    value = 14695981039346656037
    for byte in content:
        value = (value ^ byte) * 1099511628211 & (2**64 - 1)
    return struct.pack("<Q", value)


def with_hash(content: bytes, head: bytes, at: int) -> bytes:
    """Return a header with the hash of the content at a place, and the content."""
    return head[:at] + fnv(content) + head[at + 8 :] + content


def systems() -> dict[str, rb.Stepper]:
    """Steppers with contacts of all kinds."""
    sphere = rb.Sphere(radius="8 mm", material="steel")
    beam = rb.SDOF(mass="1 kg", frequency="12 Hz", damping_ratio=0.01, velocity="0.2 m/s")
    motion = rb.Harmonic(amplitude="1 mm", frequency="30 Hz")

    def bed(contact: Any, friction: Any, rolling: Any = None, softening: float = 1.0) -> rb.ParticleDamper:
        return rb.ParticleDamper(
            particles=[
                rb.Particles(material="steel", diameter="4 mm", count=9),
                rb.Particles(name="fine", material="steel", diameter="3 mm", count=5),
            ],
            cavity=rb.Cylinder(diameter="15 mm", length="16 mm", axis="z"),
            contact=contact,
            friction=friction,
            rolling=rolling,
            packing=rb.Settled(seed=2),
            softening=softening,
        )

    table = rb.Tabulated(speeds=[0.1, 1.0], values=[0.9, 0.6])
    return {
        "row": rb.Stepper(
            rb.ImpactDamper(ball=[sphere] * 2, gap="1 mm", contact=rb.Tsuji(restitution=table), velocity="0.4 m/s")
        ),
        "hard": rb.Stepper(
            rb.ImpactDamper(ball=[sphere] * 3, gap="1 mm", contact=rb.Tsuji(restitution=0.7), gravity="9.81 m/s^2"),
            method=rb.Newton(),
        ),
        "structure": rb.Stepper(
            rb.Case(
                structure=beam,
                dampers=[
                    rb.ImpactDamper(ball=sphere, gap="1 mm", contact=rb.Thornton(yield_pressure="1 GPa")),
                    rb.ImpactDamper(ball=sphere, gap="2 mm", contact=rb.Linear(stiffness="1 MN/m", restitution=0.5)),
                ],
                load=rb.Harmonic(amplitude="1 N", frequency="3 Hz"),
                duration="1 s",
            )
        ),
        "bed": rb.Stepper(bed(rb.Tsuji(restitution=0.7), 0.3, 0.1, 500.0), motion=motion),
        "yielding bed": rb.Stepper(bed(rb.Thornton(yield_pressure="100 MPa"), 0.2, None, 100.0), motion=motion),
    }


def changed(content: bytes, random: np.random.Generator) -> bytes:
    """Return the content with a flipped bit, or with one or two words that hold other numbers."""
    made = bytearray(content)
    if random.random() < 0.4:
        made[random.integers(len(made))] ^= 1 << int(random.integers(8))
        return bytes(made)
    words = [struct.pack("<q", value) for value in (-1, 0, 1, 7, 2**31, 2**32 + 1, 2**62, -(2**63))]
    words += [struct.pack("<d", value) for value in (np.nan, np.inf, -np.inf, 1e300, -1e9, 1e-310, -1.0)]
    for _ in range(random.integers(1, 3)):
        place = 8 * int(random.integers(len(made) // 8))
        made[place : place + 8] = words[random.integers(len(words))]
    return bytes(made)


def used(core: _core.Stepper) -> None:
    """Advance, save, restore and advance."""
    for k in range(4):
        core.advance(6e-4, 20 * np.cos(k + np.arange(core.inputs)))
        core.outputs(), core.force, core.moment, core.largest_overlap
    core.restore(core.save())
    core.advance(1e-4, np.zeros(core.inputs))


def run_made(name: str, count: int, seed: int) -> tuple[int, int, int, int]:
    """Use changed cases and restore changed states; return the numbers of refused and accepted cases and states."""
    random = np.random.default_rng(seed)
    stepper = systems()[name]
    packed, core = stepper.packed, stepper._core
    used(core)
    good = core.save()
    done = [0, 0, 0, 0]
    for _ in range(count):
        case = with_hash(changed(packed[HEADER:], random), packed[:HEADER], HEADER - 8)
        state = with_hash(changed(good[STATE_HEADER:], random), good[:STATE_HEADER], 8)
        for first, act in (
            (0, lambda case=case: used(_core.Stepper(case))),
            (2, lambda state=state: core.restore(state)),
        ):
            try:
                act()
                if first == 2:
                    used(core)
                done[first + 1] += 1
            except ValueError:
                done[first] += 1
        core.restore(good)
        assert core.save() == good
    return tuple(done)


@pytest.mark.parametrize("count", [40, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["row", "hard", "structure", "bed", "yielding bed"])
def test_made_cases_and_states_do_not_crash(name: str, count: int) -> None:
    """A changed case or state with a right hash is refused or runs, and the state before it can be restored.

    The checks of indices were in the 3-D engine only, and no test changed a packed case or a state under a right hash.
    """
    done = subprocess.run(
        [sys.executable, "-c", f"import test_made_cases as t; print(*t.run_made({name!r}, {count}, {count}))"],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=500,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    refused_cases, cases, refused_states, states = map(int, done.stdout.split())
    assert refused_cases + cases == refused_states + states == count
    assert min(refused_cases, refused_states) > count / 10


def replaced(packed: bytes, word: bytes, by: bytes) -> bytes:
    """Return a packed case with another word in the place of the only word that equals the first one."""
    content = packed[HEADER:]
    places = [k for k in range(0, len(content), 8) if content[k : k + 8] == word]
    assert len(places) == 1
    return with_hash(content[: places[0]] + by + content[places[0] + 8 :], packed[:HEADER], HEADER - 8)


@pytest.mark.parametrize("limit", [0, -5, -(2**62)])
def test_settings_that_no_case_has_are_refused_at_once(limit: int) -> None:
    """A packed case with no events, or a tolerance or a gap that is not possible, is refused when it is read."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="8 mm", material="steel"), gap="1.25 mm", contact=rb.Tsuji(restitution=0.6)
    )
    packed = rb.Stepper(ball, method=rb.EventDriven(max_events=4321, tolerance=3e-11)).packed
    number = lambda value: struct.pack("<d", value)  # noqa: E731
    wrong = [replaced(packed, struct.pack("<q", 4321), struct.pack("<q", limit))]
    wrong += [replaced(packed, number(3e-11), number(value)) for value in (1e-300, 0.0, -1.0, float("nan"))]
    wrong += [replaced(packed, number(2.5e-3), number(value)) for value in (-1e-3, float("inf"), 1e-320)]
    for case in wrong:
        with pytest.raises(ValueError, match="damaged"):
            _core.Stepper(case)


# ---- functions of FMI


def library(folder: Path, fmi: int) -> tuple[ctypes.CDLL, bytes]:
    """Return the library of an FMU of a ball, and the address of its resources."""
    import fmpy

    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="8 mm", material="steel"), gap="2 mm", contact=rb.Tsuji(restitution=0.6)
    )
    unzipped = Path(fmpy.extract(str(rb.to_fmu(ball, folder / "ball.fmu", fmi=fmi)), str(folder / "unzipped")))
    (file,) = (unzipped / "binaries").rglob("*.so")
    lib = ctypes.CDLL(str(file))
    for name in ("fmi2Instantiate", "fmi3InstantiateCoSimulation"):
        getattr(lib, name).restype = ctypes.c_void_p
    resources = unzipped / "resources"
    return lib, (resources.as_uri() if fmi == 2 else str(resources)).encode()


class Component:
    """An instance, whose functions are called by their names without the version."""

    def __init__(self, folder: Path, fmi: int) -> None:
        self.lib, resources = library(folder, fmi)
        self.fmi = fmi
        if fmi == 2:
            self.handle = self.lib.fmi2Instantiate(b"ball", 1, b"", resources, None, 0, 0)
        else:
            none = ctypes.c_void_p()
            self.handle = self.lib.fmi3InstantiateCoSimulation(
                b"ball", b"", resources, 0, 0, 0, 0, none, ctypes.c_size_t(0), none, none, none
            )
        assert self.handle

    def call(self, name: str, *arguments: Any, handle: Any = ...) -> int:
        """Call a function with the instance, or with another pointer."""
        name = name.replace("FMUstate", "FMUState") if self.fmi == 3 else name
        owner = ctypes.c_void_p(self.handle if handle is ... else handle)
        return int(getattr(self.lib, f"fmi{self.fmi}{name}")(owner, *arguments))

    def begin(self) -> None:
        """Pass the initialization."""
        zero = ctypes.c_double(0.0)
        if self.fmi == 2:
            assert self.call("SetupExperiment", 0, zero, zero, 0, zero) == 0
            assert self.call("EnterInitializationMode") == 0
        else:
            assert self.call("EnterInitializationMode", 0, zero, zero, 0, zero) == 0
        assert self.call("ExitInitializationMode") == 0

    def step(self, time: float, *, outputs: bool = True, handle: Any = ...) -> int:
        """Make a step of 1 ms."""
        at, length = ctypes.c_double(time), ctypes.c_double(1e-3)
        if self.fmi == 2:
            return self.call("DoStep", at, length, 1, handle=handle)
        flags = [ctypes.byref(ctypes.c_bool()) for _ in range(3)] + [ctypes.byref(ctypes.c_double())]
        return self.call("DoStep", at, length, 1, *(flags if outputs else [None] * 4), handle=handle)


@pytest.mark.parametrize("fmi", [2, 3])
def test_wrong_pointers_are_errors(fmi: int, tmp_path: Path) -> None:
    """NULL, a state that was freed, and an instance that was freed return an error from every function that reads them.

    FMPy, by which all FMUs were tested, never passes such pointers.
    """
    one = Component(tmp_path, fmi)
    one.begin()
    numbers = "Real" if fmi == 2 else "Float64"
    more = () if fmi == 2 else (ctypes.c_size_t(1),)
    reference, value, size = ctypes.c_uint(0), ctypes.c_double(), ctypes.c_size_t()
    single, none = ctypes.c_size_t(1), ctypes.c_void_p()
    state = ctypes.c_void_p()
    serialize = {2: "DeSerializeFMUstate", 3: "DeserializeFMUstate"}[fmi]
    error = 3
    assert one.call("GetFMUstate", None) == error
    assert one.call("GetFMUstate", ctypes.byref(state)) == 0
    assert one.call("SerializedFMUstateSize", state, None) == error
    assert one.call("SerializedFMUstateSize", none, ctypes.byref(size)) == error
    assert one.call("SerializedFMUstateSize", state, ctypes.byref(size)) == 0
    assert one.call("SerializeFMUstate", state, None, size) == error
    buffer = ctypes.create_string_buffer(size.value)
    assert one.call("SerializeFMUstate", none, buffer, size) == error
    assert one.call("SerializeFMUstate", state, buffer, size) == 0
    assert one.call(serialize, None, size, ctypes.byref(none)) == error
    assert one.call(serialize, buffer, size, None) == error
    assert one.call("SetFMUstate", none) == error
    assert one.call("SetFMUstate", ctypes.c_void_p(one.handle)) == error  # not a state
    for given in ((None, single, ctypes.byref(value)), (ctypes.byref(reference), single, None)):
        assert one.call(f"Get{numbers}", *given, *more) == error
        assert one.call(f"Set{numbers}", *given, *more) == error
    assert one.call(f"Get{numbers}", None, ctypes.c_size_t(0), None, *more) == 0
    assert one.step(0.0, outputs=False) == 0
    copy = ctypes.c_void_p(state.value)
    assert one.call("FreeFMUstate", ctypes.byref(state)) == 0
    assert not state
    assert one.call("FreeFMUstate", ctypes.byref(state)) == 0  # NULL, which the standard allows
    assert one.call("FreeFMUstate", None) == 0
    assert one.call("SetFMUstate", copy) == error
    assert one.call("FreeFMUstate", ctypes.byref(copy)) == error
    assert one.step(1e-3) == 0
    for name in ("Terminate", "Reset"):
        assert one.call(name, handle=None) == error
    free = getattr(one.lib, f"fmi{fmi}FreeInstance")
    for _ in range(2):
        free(ctypes.c_void_p(one.handle))
    free(None)
    assert one.step(2e-3) == error


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_step_after_terminate(fmi: int, tmp_path: Path) -> None:
    """After `terminate` a step is refused; outputs can be read, and a state or a reset begins again."""
    one = Component(tmp_path, fmi)
    one.begin()
    assert one.step(0.0) == 0
    state = ctypes.c_void_p()
    assert one.call("GetFMUstate", ctypes.byref(state)) == 0
    assert one.call("Terminate") == 0
    assert one.step(1e-3) == 3
    assert one.call("ExitInitializationMode") == 3
    time, more = ctypes.c_double(), () if fmi == 2 else (ctypes.c_size_t(1),)
    read = ("Real" if fmi == 2 else "Float64", ctypes.byref(ctypes.c_uint(0)), ctypes.c_size_t(1), ctypes.byref(time))
    assert one.call(f"Get{read[0]}", *read[1:], *more) == 0
    assert time.value == pytest.approx(1e-3)
    assert one.call("SetFMUstate", state) == 0
    assert one.step(1e-3) == 0
    assert one.call("Terminate") == 0
    assert one.call("Reset") == 0
    one.begin()
    assert one.step(0.0) == 0
    getattr(one.lib, f"fmi{fmi}FreeInstance")(ctypes.c_void_p(one.handle))


# ---- the C interface


def test_null_pointers_of_the_c_interface_are_errors() -> None:
    """NULL in place of a component, of inputs or of a state returns an error."""
    lib = ctypes.CDLL(str(rb.component_library()))
    lib.rattlebox_create.restype = lib.rattlebox_save.restype = ctypes.c_void_p
    packed = systems()["row"].packed
    assert lib.rattlebox_create(None, ctypes.c_size_t(100)) is None
    handle = ctypes.c_void_p(lib.rattlebox_create(packed, ctypes.c_size_t(len(packed))))
    length, size = ctypes.c_double(1e-3), ctypes.c_size_t()
    for owner in (handle, None):
        assert lib.rattlebox_advance(owner, length, None) == 1
        assert lib.rattlebox_advance_to_velocity(owner, length, None) == 1
        assert lib.rattlebox_set_gravity(owner, None) == 1
        assert lib.rattlebox_restore(owner, None, size) == 1
        assert lib.rattlebox_save(owner, None) is None
    assert lib.rattlebox_advance(handle, length, ctypes.byref(ctypes.c_double(1.0))) == 0
    lib.rattlebox_free(handle)
