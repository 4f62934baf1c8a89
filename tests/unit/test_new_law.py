"""A contact law of another package: `rattlebox new-law`, compiled against the installed headers, run in both engines."""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rattlebox as rb

from .test_add_a_law import DENSITY, POISSON, RADIUS, SPEED, YOUNG, rebound

NAME = "quarry"  # no law of Rattlebox
COMPILER = shutil.which(os.environ.get("CXX", "c++")) or "g++"  # the project itself needs one: its absence is a failure


def run(folder: Path, *command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a program."""
    return subprocess.run(
        command, cwd=folder, env=os.environ | environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the package that the command writes, installed in its folder `site`."""
    folder = tmp_path_factory.mktemp("law")
    written = run(folder, sys.executable, "-m", "rattlebox.cli", "new-law", NAME)
    assert written.returncode == 0, written.stderr
    assert "pip install --no-build-isolation" in written.stdout
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index"]
    done = run(folder, *command, "--target", "site", f"./{NAME}")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


RUN = """
import json
import numpy as np
import rattlebox as rb

radius, density, young, poisson, speed = {numbers}
steel = dict(name="plain steel", density=density, young=young, poisson=poisson)
law = dict(kind="quarry", loss=0.2)
balls = {{
    "impact": dict(kind="impact", ball=dict(radius=radius, material=steel), gap="1 mm", velocity=speed, wall=steel,
        contact=law),
    "particle": dict(kind="particle", particles=dict(material=steel, radius=radius, count=1),
        cavity=dict(kind="box", size=("12 mm",) * 3), wall=steel,
        packing=dict(kind="positions", positions=[(0.0, 0.0, 0.0)]), gravity=(0, 0, 0), contact=law),
}}


def simulate(kind, structure=rb.Fixed(), method=None, duration=2e-3 / speed, **changes):
    method = method or (rb.Dem(fraction=0.005) if kind == "particle" else rb.EventDriven())
    case = rb.Case(structure=structure, damper=balls[kind] | changes, duration=duration, method=method)
    run = rb.simulate(rb.Case.from_toml(case.to_toml()), progress=False)
    assert run.ok, run.status
    return run


def particle(**changes):
    return simulate("particle", **changes).arrays.particles.velocity[0].tolist()


case = rb.Case(structure=rb.SDOF(mass="1 kg", stiffness="10 kN/m"), damper=balls["impact"], duration="20 ms")
sweep = rb.sweep(case, {{"damper.contact.loss": [0.0, 0.3]}}, ["impact_share"], progress=False)
bed = dict(particles=dict(material=steel, radius="2 mm", count=40), cavity=dict(kind="box", size=("20 mm",) * 3),
    packing=dict(kind="lattice"), gravity=(0, 0, -9.81), softening=50)
moving = rb.SDOF(mass="0.5 kg", frequency="30 Hz", velocity="1 m/s")
from quarry import Quarry
own = simulate("particle", moving, rb.Dem(), 0.02, **bed)
same = simulate("particle", moving, rb.Dem(), 0.02, **bed | dict(contact=rb.PowerLaw(
    damping_exponent=1.5, damping=0.0)))
elastic = simulate("particle", moving, rb.Dem(), 0.02, **bed | dict(contact=Quarry(loss=0.0)))
try: rb.Stepper(case)
except rb.CaseError as error: refused = str(error)
print(json.dumps({{
    "impact": float(simulate("impact").impacts.separation_speed[0]),
    "hard": float(simulate("impact", method=rb.Newton()).impacts.separation_speed[0]),
    "straight": particle(velocity=(speed, 0, 0)),
    "soft": particle(velocity=(speed, 0, 0), softening=30.0),
    "sliding": particle(velocity=(speed, 0.5, 0), friction=0.02),
    "shares": sweep.impact_share.values.tolist(),
    "residual": [abs(each.summary().values["energy_residual"]) for each in (own, elastic)],
    "end": [each.motion.displacement.values[-1].tolist() for each in (elastic, same)],
    "refused": refused,
}}))
"""


def test_a_law_of_another_package_runs_in_both_engines(folder: Path) -> None:
    """It rebounds as SciPy's integration of its equation says, in 1-D and 3-D, with friction, softening and in a sweep."""
    script = RUN.format(numbers=(RADIUS, DENSITY, YOUNG, POISSON, SPEED))
    done = run(folder, sys.executable, "-c", script, PYTHONPATH=str(folder / "site"))
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    mass = 4 / 3 * math.pi * RADIUS**3 * DENSITY
    after, impulse = rebound(mass, 4 / 3 * (YOUNG / (2 * (1 - POISSON**2))) * math.sqrt(RADIUS), 0.2)
    assert result["impact"] == pytest.approx(after, rel=1e-8)
    assert result["hard"] == pytest.approx(after, rel=1e-3)
    assert result["straight"] == pytest.approx([-after, 0, 0], rel=1e-3)
    assert result["soft"] == pytest.approx([-after, 0, 0], rel=1e-3)
    assert 0.5 - result["sliding"][1] == pytest.approx(0.02 * impulse / mass, rel=1e-2)
    elastic, lossy = result["shares"]
    assert abs(elastic) < 1e-6 < lossy
    assert max(result["residual"]) < 1e-3
    # Without loss, the law is the Hertz contact that PowerLaw computes in the core.
    assert result["end"][0] == pytest.approx(result["end"][1], rel=1e-6)
    assert "a contact law of another package cannot be in a packed case" in result["refused"]


def test_a_case_file_and_the_command_line_take_the_law(folder: Path) -> None:
    """A case file with the kind of the new law runs in the command line, and a wrong field is refused."""
    case = """
duration = "50 ms"
structure = { kind = "sdof", mass = "1 kg", frequency = "20 Hz", velocity = "0.5 m/s" }
damper = { kind = "impact", ball = { diameter = "20 mm", material = "steel" }, wall = "steel", gap = "1 mm", \
contact = { kind = "quarry", loss = 0.2 } }
"""
    (folder / "case.toml").write_text(case)
    site = str(folder / "site")
    done = run(folder, sys.executable, "-m", "rattlebox.cli", "run", "case.toml", "--no-figures", PYTHONPATH=site)
    assert done.returncode == 0, done.stderr
    (folder / "wrong.toml").write_text(case.replace("loss = 0.2", "lost = 0.2"))
    done = run(folder, sys.executable, "-m", "rattlebox.cli", "run", "wrong.toml", PYTHONPATH=site)
    assert done.returncode == 2 and "did you mean 'loss'?" in done.stderr, done.stderr


SWEEP = """
import rattlebox as rb

case = rb.Case.from_file("case.toml")
rb.sweep(case, {"damper.gap": ["1 mm", "2 mm"]}, ["impact_share"], store="changed.zarr", progress=False)
"""


def test_a_store_is_not_resumed_with_a_changed_law(folder: Path) -> None:
    """A study refuses to go on after the module or the library of a law of another package has changed.

    The case file says the same in both: no test saw that results of two laws could stand in one store.
    """
    site = folder / "site"
    done = run(folder, sys.executable, "-c", SWEEP, PYTHONPATH=str(site))
    assert done.returncode == 0, done.stderr
    done = run(folder, sys.executable, "-c", SWEEP, PYTHONPATH=str(site))
    assert done.returncode == 0, done.stderr
    changed = shutil.copytree(site, folder / "changed")
    (library,) = changed.glob(f"{NAME}/law.so")
    with library.open("ab") as file:
        file.write(b"\0")
    done = run(folder, sys.executable, "-c", SWEEP, PYTHONPATH=str(changed))
    assert done.returncode != 0 and f"code.{NAME}" in done.stderr, done.stderr


@pytest.mark.parametrize(
    ("part", "instead", "message"),
    [
        ("T stored(", "T other_stored(", "a law without history lacks a part that DashpotLaw lists"),
        ("contact_time(real", "other_time(real", "a normal law lacks a part that CompleteNormalLaw lists"),
        ("static constexpr real zero_overlap = 1;", "real zero_overlap = 1;", "must be static constexpr"),
    ],
)
def test_an_incomplete_law_does_not_compile(folder: Path, part: str, instead: str, message: str) -> None:
    """The concepts of the core check the laws of other packages, with the same messages."""
    text = (folder / NAME / NAME / "law.cpp").read_text("utf-8")
    assert part in text
    (folder / "broken.cpp").write_text(text.replace(part, instead))
    command = [COMPILER, "-std=c++20", "-fsyntax-only", "-I", str(rb.include_dir()), "broken.cpp"]
    done = run(folder, *command)
    assert done.returncode != 0 and message in done.stderr, done.stderr


def test_wrong_names_folders_and_libraries_are_refused(tmp_path: Path) -> None:
    """A name that Python cannot import or a law has, a folder in use and a file that is no law are refused with advice."""
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "file").touch()
    for arguments, text in (
        (["My-Law"], "small letters, digits and _"),
        (["tsuji"], "there is a contact law 'tsuji' already"),
        (["fresh", "-o", "used"], "used exists"),
    ):
        done = run(tmp_path, sys.executable, "-m", "rattlebox.cli", "new-law", *arguments)
        assert done.returncode == 2 and text in done.stderr and "try: " in done.stderr, done.stderr
    with pytest.raises(rb.DataError, match="is not a library with a contact law"):
        rb.load_law(tmp_path / "used" / "file")
    with pytest.raises(rb.DataError, match="is not a library with a contact law"):
        rb.load_law(rb.component_library())
