"""The steps of docs/developing/add_a_law.md, carried out on a copy of the sources, which is then built and run."""

from __future__ import annotations

import ast
import json
import math
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import cmake
import ninja
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .test_docs import section

ROOT = Path(__file__).parents[2]
COMPILER = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++") or shutil.which("clang++")
FLAGS = ["-std=c++20", "-Wall", "-Wextra", "-Wno-psabi", "-Werror"]
RADIUS, DENSITY, YOUNG, POISSON, SPEED = 5e-3, 7800.0, 210e9, 0.3, 1.3
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C++ compiler")


def steps() -> list[tuple[str, str, str, str]]:
    """Return the steps of the page: file, what the step says about it, language and block."""
    page = (ROOT / "docs" / "developing" / "add_a_law.md").read_text(encoding="utf-8")
    return re.findall(r"^\*\*\d\. `(\S+)`\*\*(.*?)\n\n```(\w+)\n(.*?)^```", page, re.MULTILINE | re.DOTALL)


def carry_out(folder: Path) -> None:
    """Carry out all steps in a copy of the sources."""
    for file, text, language, block in steps():
        path = folder / file
        if language == "cpp":
            assert not path.exists()
            path.write_text(block, encoding="utf-8")
            continue
        content = path.read_text(encoding="utf-8")
        if language == "diff":
            lines = block.splitlines(keepends=True)
            before = "".join(line[1:] for line in lines if line[0] in " -")
            after = "".join(line[1:] for line in lines if line[0] in " +")
        else:
            (anchor,) = re.findall(r"above `([^`]+)`", text)
            before, after = f"\n{anchor}", f"\n{block}\n\n{anchor}"
        assert content.count(before) == 1, (file, before)
        path.write_text(content.replace(before, after), encoding="utf-8")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the sources to which the page's steps were applied."""
    if any((ROOT / file).exists() for file, _, language, _ in steps() if language == "cpp"):
        pytest.skip("this tree already has the laws of the page")
    folder = tmp_path_factory.mktemp("copy")
    for name in ("core", "src"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.so", "*.pyd", "__pycache__"))
    shutil.copytree(ROOT / "docs" / "reference" / "case", folder / "docs" / "reference" / "case")
    shutil.copy(ROOT / "CMakeLists.txt", folder)
    carry_out(folder)
    return folder


def compiled(folder: Path, program: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Compile a program against the headers of a copy."""
    (folder / "main.cpp").write_text(program, encoding="utf-8")
    command = [str(COMPILER), *FLAGS, "-I", str(folder / "core"), "main.cpp", *options]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("block", [block for _, _, language, block in steps() if language == "python"])
def test_the_classes_of_the_page_are_documented_as_laws_must_be(block: str) -> None:
    """A law by the page has the notes and the source that other tests demand; only its numbers had been tested."""
    (law,) = [node for node in ast.parse(block).body if isinstance(node, ast.ClassDef)]
    text = ast.get_docstring(law) or ""
    assert re.search(r"\S [=+<] \S", section(text, "Notes"))
    assert re.search(r"doi:10\.\d{4,}/\S|ISBN \d", section(text, "References"))


@needs_compiler
def test_the_laws_of_the_page_compile(copy: Path) -> None:
    """The table accepts all three laws; the normal law gives its formula for one number and in SIMD registers."""
    program = """
    #include <cstdio>
    #include "contact/laws.hpp"
    using namespace rattlebox;
    int main() {
        RestitutionLaw restitution;
        restitution.set(ViscoelasticRestitution{0.25, 0.95});
        TangentialLaw::each([]<class Law>(int) { std::printf("%s ", Law::name); });
        const HuntCrossley law{1e9, 0.01, 0.1};
        const Depth<Group> d = depth_from_overlap(Group::all(1e-4));
        const Coefficients<real> k = law.coefficients(law.damping(1), 1);
        const Coefficients<Group> many{Group::all(k.stiffness), Group::all(k.second)};
        alignas(64) real lanes[group];
        pack<group>(lanes) = law.force(many, d, Group::all(0.7)).total;
        std::printf("%.17g %.17g %.17g", rebound(restitution, 2.0).e,
                    law.force(k, depth_from_overlap(1e-4), 0.7).total, lanes[group - 1]);
    }"""
    done = compiled(copy, program, "-o", "main")
    assert done.returncode == 0, done.stderr
    *names, e, one, many = subprocess.run([copy / "main"], capture_output=True, text=True, check=True).stdout.split()
    assert "hertz_ratio" in names
    assert float(e) == pytest.approx(1 - 0.25 * 2**0.2, rel=1e-14)
    assert float(one) == float(many) == pytest.approx(1e9 * 1e-6 * (1 + 1.5 * 0.1 * 0.7), rel=1e-14)


@needs_compiler
@pytest.mark.parametrize(
    ("file", "part", "concept"),
    [
        ("normal/hunt_crossley.hpp", "stored(", "DashpotLaw"),
        ("normal/hunt_crossley.hpp", "contact_time(", "CompleteNormalLaw"),
        ("normal/thornton.hpp", "unloaded_from(", "YieldingLaw"),
        ("tangential/hertz_ratio.hpp", "dashpot(", "CompleteTangentialLaw"),
        ("restitution/viscoelastic.hpp", "limit(", "CompleteRestitutionLaw"),
    ],
)
def test_an_incomplete_law_does_not_compile(copy: Path, tmp_path: Path, file: str, part: str, concept: str) -> None:
    """A law without one of its functions is a compile error that names the concept, the law and the file of the concept."""
    shutil.copytree(copy / "core", tmp_path / "core")
    header = tmp_path / "core" / "contact" / file
    text = header.read_text(encoding="utf-8")
    assert part in text
    header.write_text(text.replace(part, f"other_{part}"), encoding="utf-8")
    done = compiled(tmp_path, '#include "contact/laws.hpp"\n', "-fsyntax-only")
    assert done.returncode != 0
    (law,) = re.findall(r"^struct (\w+) \{\n    real", text, re.MULTILINE)
    errors = [line for line in done.stderr.splitlines() if "error" in line and concept in line]
    assert errors and "complete.hpp" in errors[0]
    assert law in done.stderr


RUN = """
import json
import rattlebox as rb

radius, density, young, poisson, speed = {numbers}
steel = rb.Material(name="plain steel", density=density, young=young, poisson=poisson)
law = rb.HuntCrossley(loss=0.2)
balls = {{
    "impact": dict(ball=rb.Sphere(radius=radius, material=steel), gap="1 mm", velocity=speed, wall=steel, contact=law),
    "particle": dict(
        particles=rb.Particles(material=steel, radius=radius, count=1), cavity=rb.Box(size=("12 mm",) * 3), wall=steel,
        packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]), gravity=(0, 0, 0), contact=law),
}}


def run(kind, **changes):
    part = rb.ImpactDamper if kind == "impact" else rb.ParticleDamper
    options = dict(method=rb.Dem(fraction=0.005)) if kind == "particle" else {{}}
    case = rb.Case(structure=rb.Fixed(), damper=part(**balls[kind] | changes), duration=2e-3 / speed, **options)
    run = rb.simulate(rb.Case.from_toml(case.to_toml()))
    assert run.ok, run.status
    return run


def particle(**changes):
    return run("particle", **changes).arrays.particles.velocity[0].tolist()


spring = rb.HertzRatio(coefficient=0.3, ratio=2 * (1 - poisson) / (2 - poisson))
pair = rb.contact_pairs(rb.Case(structure=rb.Fixed(), damper=rb.ImpactDamper(**balls["impact"]), duration=1.0), 0)[0]
hard = rb.Case(structure=rb.Fixed(), damper=rb.ImpactDamper(**balls["impact"]), duration=2e-3 / speed, method=rb.Newton())
sweep = rb.sweep(
    rb.Case(structure=rb.SDOF(mass="1 kg", stiffness="10 kN/m"), damper=rb.ImpactDamper(**balls["impact"]),
            duration="20 ms"),
    {{"damper.contact.loss": [0.0, 0.3]}}, ["impact_share"])
print(json.dumps({{
    "impact": float(run("impact").impacts.separation_speed[0]),
    "hard": float(rb.simulate(hard).impacts.separation_speed[0]),
    "straight": particle(velocity=(speed, 0, 0)),
    "soft": particle(velocity=(speed, 0, 0), softening=30.0),
    "mindlin": particle(velocity=(speed, 0.5, 0), friction=0.3, rolling=0.01),
    "ratio": particle(velocity=(speed, 0.5, 0), friction=spring, rolling=0.01),
    "sliding": particle(velocity=(speed, 0.5, 0), friction=0.02),
    "restitution": rb.restitution_curve(rb.Viscoelastic(loss=0.25, maximum=0.95), pair, [1e-6, 0.1, 1.0, 32.0]).tolist(),
    "shares": sweep.impact_share.values.tolist(),
}}))
"""


def rebound(mass: float, stiffness: float, loss: float) -> tuple[float, float]:
    """Return separation speed and impulse of Hunt and Crossley's equation, integrated by SciPy."""

    def ends(_: float, y: Any) -> float:
        return float(y[0])

    ends.terminal, ends.direction = True, -1.0  # type: ignore[attr-defined]

    def motion(_: float, y: Any) -> list[float]:
        force = stiffness * max(y[0], 0.0) ** 1.5 * (1 + 1.5 * loss * y[1])
        return [y[1], -force / mass]

    result = solve_ivp(motion, (0, 1), [0, SPEED], "DOP853", events=ends, rtol=1e-11, atol=1e-16, max_step=1e-5)
    after = -float(result.y_events[0][-1][1])
    return after, mass * (SPEED + after)


@needs_compiler
@pytest.mark.slow  # compiles the whole core
def test_the_laws_of_the_page_run_in_both_engines(copy: Path) -> None:
    """Built for one instruction set, they rebound as in SciPy's integration of their equations, also with friction."""
    level = "v1" if sys.platform != "darwin" and os.uname().machine in ("x86_64", "amd64") else "native"
    build = [
        *("-S", ".", "-B", "build", "-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={Path(ninja.BIN_DIR) / 'ninja'}"),
        *(f"-DPython_EXECUTABLE={sys.executable}", f"-DRATTLEBOX_LEVELS={level}", "-DRATTLEBOX_OPTIMIZATION=-O0"),
    ]
    program = str(Path(cmake.CMAKE_BIN_DIR) / "cmake")
    for command in ([program, *build], [program, "--build", "build"]):
        done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    for library in (copy / "build").glob("_core_*"):
        shutil.copy(library, copy / "src" / "rattlebox" / "core")

    script = RUN.format(numbers=(RADIUS, DENSITY, YOUNG, POISSON, SPEED))
    # Without `site` (-S), an editable install of the package cannot come before the copy.
    folders = [str(copy / "src"), *{sysconfig.get_path(kind) for kind in ("purelib", "platlib")}]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders), "RATTLEBOX_SIMD": level}
    done = subprocess.run(
        [sys.executable, "-S", "-c", script], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)

    mass = 4 / 3 * math.pi * RADIUS**3 * DENSITY
    stiffness = 4 / 3 * (YOUNG / (2 * (1 - POISSON**2))) * math.sqrt(RADIUS)
    after, impulse = rebound(mass, stiffness, 0.2)
    assert after < 0.9 * SPEED
    assert result["impact"] == pytest.approx(after, rel=1e-8)
    assert result["hard"] == pytest.approx(after, rel=1e-3)
    assert result["straight"] == pytest.approx([-after, 0, 0], rel=1e-3)
    assert result["soft"] == pytest.approx([-after, 0, 0], rel=1e-3)
    # A sphere that slides all the time loses friction times the normal impulse.
    assert result["sliding"][0] == pytest.approx(-after, rel=1e-3)
    assert 0.5 - result["sliding"][1] == pytest.approx(0.02 * impulse / mass, rel=1e-2)
    # Mindlin's stiffness has this ratio for two bodies of one material.
    assert 0 < result["ratio"][1] < 0.475
    assert result["ratio"] == pytest.approx(result["mindlin"], rel=1e-9)
    np.testing.assert_allclose(result["restitution"][1:], 1 - 0.25 * np.power([0.1, 1.0, 32.0], 0.2), rtol=1e-14)
    assert result["restitution"][0] == 0.95
    elastic, lossy = result["shares"]
    assert abs(elastic) < 1e-6 < lossy


def test_the_engines_refuse_unknown_laws() -> None:
    """A law that the core does not have is refused by its name."""
    from rattlebox.core import _core

    with pytest.raises(ValueError, match="hunt_crossley"):
        _core.normal_law("hunt_crossley", {"stiffness": 1.0, "mass": 1.0})
    with pytest.raises(ValueError, match="hertz_ratio"):
        _core.tangential_law("hertz_ratio", {"friction": 0.3})
