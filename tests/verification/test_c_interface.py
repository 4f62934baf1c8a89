"""The C interface, from C and by its functions, against steppers in Python."""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.cli.component import write_packed

ROOT = Path(__file__).parents[2]


def ball() -> rb.ImpactDamper:
    """A ball in a cavity."""
    return rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="3 mm", contact=rb.Tsuji(restitution=0.6)
    )


def library() -> ctypes.CDLL:
    """The shared library, with the types of its functions."""
    found = ctypes.CDLL(str(rb.component_library()))
    found.rattlebox_create.restype = ctypes.c_void_p
    found.rattlebox_error.restype = ctypes.c_char_p
    found.rattlebox_save.restype = ctypes.c_void_p
    for name in ("time", "work", "loss", "stored", "restitution", "friction"):
        getattr(found, f"rattlebox_{name}").restype = ctypes.c_double
    return found


def test_the_c_example_approaches_the_whole_run(tmp_path: Path) -> None:
    """The example compiles as C without a warning, and runs the case that it names as `simulate` does."""
    compiler = [shutil.which("cc")] if shutil.which("cc") else [sys.executable, "-m", "ziglang", "cc"]
    case = ROOT / "examples" / "steel_ball_jackson_green.toml"
    assert f"rattlebox pack {case.name} --alone" in (ROOT / "examples" / "component.c").read_text()
    write_packed(case, tmp_path / "ball.bin", alone=True)
    subprocess.run(
        [*compiler, "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{rb.include_dir()}",
         ROOT / "examples" / "component.c", rb.component_library(), "-lm", "-o", "component",
         f"-Wl,-rpath,{rb.component_library().parent}"],
        cwd=tmp_path, check=True,
    )  # fmt: skip
    done = subprocess.run(["./component", "ball.bin"], cwd=tmp_path, capture_output=True, text=True, check=True)
    amplitude, loss = (1e-3 * float(word) for word in done.stdout.replace(",", "").split() if word[0].isdigit())
    structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m", velocity="0.15 m/s")
    damper = rb.Case.from_file(case).dampers[0]
    run = rb.simulate(rb.Case(structure=structure, damper=damper, duration="50 ms"), progress=False)
    last = run.motion.isel(time=-1)
    expected = math.hypot(float(last.displacement.item()), float(last.velocity.item()) * math.sqrt(20 / 80e3))
    assert run.impacts.sizes["impact"] == 7
    assert amplitude == pytest.approx(expected, rel=1e-3)
    assert loss == pytest.approx(float(run.impacts.energy_lost.sum()), rel=0.015)
    failed = subprocess.run(["./component"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert failed.returncode == 1


def test_errors_are_texts() -> None:
    """Bytes that are no packed case, and steps and states that are not possible, return an error and its text."""
    lib, packed = library(), rb.Stepper(ball()).packed
    for wrong in (b"", b"no", packed[:-8], packed[:60] + bytes([packed[60] ^ 1]) + packed[61:]):
        assert lib.rattlebox_create(wrong, ctypes.c_size_t(len(wrong))) is None
        assert lib.rattlebox_error(None)
    handle = ctypes.c_void_p(lib.rattlebox_create(packed, ctypes.c_size_t(len(packed))))
    number = ctypes.c_double
    for length, value in ((-1e-3, 0.0), (float("nan"), 0.0), (1e-3, float("inf"))):
        assert lib.rattlebox_advance(handle, number(length), ctypes.byref(number(value))) == 1
        assert lib.rattlebox_error(handle)
    assert lib.rattlebox_restore(handle, b"nothing", ctypes.c_size_t(7)) == 1
    assert lib.rattlebox_choose(handle, number(1.5), number(float("nan")), None) == 1
    assert lib.rattlebox_choose(handle, number(0.5), number(float("nan")), None) == 0
    assert lib.rattlebox_restitution(handle) == 0.5
    assert math.isnan(lib.rattlebox_friction(handle))
    assert lib.rattlebox_advance(handle, number(1e-3), ctypes.byref(number(1.0))) == 0
    assert lib.rattlebox_time(handle) == 1e-3
    assert lib.rattlebox_choose(handle, number(0.7), number(float("nan")), None) == 1
    lib.rattlebox_free(handle)


def test_saved_states_continue(tmp_path: Path) -> None:
    """A state that is saved and restored through the C interface repeats the steps to the last bit."""
    lib, packed = library(), rb.Stepper(ball()).packed
    handle = ctypes.c_void_p(lib.rattlebox_create(packed, ctypes.c_size_t(len(packed))))

    def go() -> list[float]:
        force, seen = (ctypes.c_double * 3)(), []
        for k in range(60):
            velocity = ctypes.c_double(0.6 * math.cos(0.3 * k))
            assert lib.rattlebox_advance_to_velocity(handle, ctypes.c_double(1e-3), ctypes.byref(velocity)) == 0
            lib.rattlebox_force(handle, 0, force)
            seen += [force[0], lib.rattlebox_stored(handle), lib.rattlebox_loss(handle)]
        return seen

    go()
    size = ctypes.c_size_t()
    state = ctypes.string_at(lib.rattlebox_save(handle, ctypes.byref(size)), size.value)
    expected = go()
    assert any(expected[::3])
    assert lib.rattlebox_restore(handle, state, size) == 0
    assert go() == expected
    lib.rattlebox_free(handle)
