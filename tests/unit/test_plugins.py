"""Kinds that other packages add: the prism of docs/developing/extending.md as an installed package."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "developing" / "extending.md"
CASE = """
duration = "50 ms"
structure = { kind = "sdof", mass = "1 kg", frequency = "20 Hz", velocity = "0.5 m/s" }
[damper]
kind = "particle"
particles = { material = "steel", diameter = "5 mm", count = 30 }
cavity = { kind = "prism", side = "50 mm", length = "35 mm" }
contact = { kind = "tsuji", restitution = 0.7 }
softening = 100
"""


@pytest.fixture(scope="module")
def plugin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder in which the module of the page is installed with its entry point."""
    folder = tmp_path_factory.mktemp("plugin")
    text = PAGE.read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (entry,) = re.findall(r"```toml\n\[project\.entry-points\.\"(\S+)\"\]\n(.*?)```", text, re.DOTALL)
    package = folder / "my_package"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "prism.py").write_text(code, encoding="utf-8")
    info = folder / "my_package-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my_package\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{entry[0]}]\n{entry[1].replace(chr(34), '')}")
    (folder / "case.toml").write_text(CASE)
    return folder


def program(folder: Path, code: str) -> subprocess.CompletedProcess[str]:
    """Run a program in which the plug-in is installed."""
    environment = os.environ | {"PYTHONPATH": str(folder)}
    command = [sys.executable, "-W", "error", "-c", code]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_a_cavity_of_another_package_runs_and_is_shown(plugin: Path) -> None:
    """Run, drawing, picture, report, snapshots and browser show a prism, by its own words and edges, and none a sphere.

    An unknown cavity was once drawn and exported as a sphere; no test had added a kind.
    """
    result = program(
        plugin,
        """
import numpy as np, rattlebox as rb
from rattlebox.app import views
case = rb.Case.from_file("case.toml")
run = rb.simulate(case, progress=False)
assert run.status == "finished", run.status
cavity = case.particle_dampers[0].cavity
assert (cavity.depth(run.particles.position.values) > 0).all()
assert abs(cavity.volume - np.sqrt(3) / 4 * 0.05**2 * 0.035) < 1e-12 * 0.05**3, cavity.volume
figure = rb.plot_case(case)
words = " ".join(text.get_text() for axes in figure.axes for text in axes.texts)
assert "triangular prism, 50 mm wide, 35 mm long" in words and "sphere" not in words, words
assert "43.3 mm" in words, words  # its height
run.plot.particles().savefig("picture.png")
rb.write_report(run, "report.html")
report = open("report.html").read()
assert "triangular prism" in report
edges = views._cavities(case)[0]
assert len(edges["sharp"]) == 9 * 6 and not edges["smooth"]
assert rb.Case.from_toml(case.to_toml()) == case
assert case.replaced({"damper.cavity.side": "52 mm"}).particle_dampers[0].cavity.side == 0.052
""",
    )
    assert result.returncode == 0, result.stderr


def test_messages_list_kinds_of_other_packages(plugin: Path) -> None:
    """An unknown kind is refused with the kinds of plug-ins among the allowed ones."""
    result = program(
        plugin,
        "import rattlebox as rb; text = open('case.toml').read().replace('\"prism\"', '\"prizm\"')\n"
        "try: rb.Case.from_toml(text)\n"
        "except rb.CaseError as error: print(error)",
    )
    assert "did you mean 'prism'?" in result.stdout, (result.stdout, result.stderr)


def test_a_class_that_lacks_a_method_is_refused_at_import() -> None:
    """A new kind that lacks a method is refused when it is defined, with the names of the missing methods."""
    from rattlebox.model.cavities import PlaneCavity, Walls

    with pytest.raises(TypeError, match=r"Cone must define words, as each Cavity does"):

        class Cone(PlaneCavity):
            kind: str = "cone"

            def walls(self) -> Walls:
                """Return no walls."""
                raise AssertionError


def test_a_kind_has_one_class() -> None:
    """A second class of a kind is refused when it is defined."""
    from rattlebox.model.restitutions import Coefficients, Restitution

    with pytest.raises(TypeError, match=r"the kind 'constant' of Restitution is that of"):

        class Other(Restitution):
            kind: str = "constant"

            def coefficients(self, pair: object) -> Coefficients:
                """Return nothing."""
                raise AssertionError


def test_a_plugin_that_fails_is_named(plugin: Path) -> None:
    """A plug-in that cannot be imported stops the first case with its name and that of its package."""
    (plugin / "my_package" / "prism.py").rename(plugin / "my_package" / "away.py")
    try:
        result = program(
            plugin,
            "import rattlebox as rb\ntry: rb.Case.from_file('case.toml')\nexcept rb.RattleboxError as error: print(error)",
        )
    finally:
        (plugin / "my_package" / "away.py").rename(plugin / "my_package" / "prism.py")
    assert "the plug-in prism of the package my_package cannot be imported" in result.stdout, result.stderr


def test_a_kind_may_be_defined_after_the_first_case(tmp_path: Path) -> None:
    """A class that a notebook defines after it has run a case is accepted by the next case."""
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "case.toml").write_text(CASE)
    first = "import rattlebox as rb\nrb.reference_case()\n"
    last = "\nassert rb.Case.from_file('case.toml').dampers[0].cavity.words() == Prism(side=0.05, length=0.035).words()"
    result = program(tmp_path, first + code + last)
    assert result.returncode == 0, result.stderr
