"""`rattlebox demo`: a struck structure without and with a steel ball in a cavity."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rattlebox
from rattlebox._util.narrow import instance
from rattlebox._util.own_files import claim, list_files
from rattlebox._util.owned_folder import digest_of
from rattlebox.cli.folder import make_folder
from rattlebox.cli.terminal import terminal
from rattlebox.model.case import Case
from rattlebox.model.contacts import Tsuji
from rattlebox.model.dampers import ImpactDamper, Sphere
from rattlebox.model.shocks import HalfSine
from rattlebox.model.structures import SDOF
from rattlebox.plots.gain import plot_gain
from rattlebox.results.run import Run
from rattlebox.results.summary import Comparison
from rattlebox.studies.kinds.sweep import compare

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BARE, DAMPED = "without damper", "with the ball"
UNTIL = 2.0
"""Last time of the figure [s]."""


def demo_cases() -> dict[str, Case]:
    """Return a structure that a pulse hits, without and with a steel ball in a cavity."""
    common: dict[str, Any] = {
        "structure": SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
        "load": HalfSine(amplitude="5 kN", duration="1 ms"),
        "duration": "5 s",
    }
    ball = Sphere(radius="33.17 mm", material="steel")
    damper = ImpactDamper(balls=(ball,), gap="2 mm", contact=Tsuji(restitution=0.6))
    return {BARE: Case(**common), DAMPED: Case(**common, dampers=(damper,))}


def gain(result: Comparison) -> str:
    """Return in one sentence, without its full stop, what the ball gains."""
    before, after = (f"{float(result.values[name]['settling_time[mass]']):.2g} s" for name in (BARE, DAMPED))
    case = result.runs[DAMPED].case
    share = 100 * float(case.impact_dampers[0].masses.sum()) / instance(case.structure, SDOF).mass
    return f"A loose steel ball of {share:.0f} % of the mass stops the structure in {after} instead of {before}"


def runs_of(result: Comparison) -> dict[str, Run]:
    """Return the runs of the comparison."""
    return {name: instance(result.runs[name], Run) for name in (BARE, DAMPED)}


def figure(result: Comparison) -> Figure:
    """Return the figure of the comparison."""
    text = "20 kg on a spring, struck once by 5 kN for 1 ms. Eight moments of the first oscillation, motion magnified:"
    runs = runs_of(result)
    return plot_gain(runs[BARE], runs[DAMPED], gain(result), text, until=UNTIL)


def run_demo(out: Path) -> None:
    """Simulate both cases, print the comparison and the gain, and write the figure and the netCDF and case files."""
    cases = demo_cases()
    stems = {name: name.replace(" ", "_") for name in cases}
    files = [*(f"{stem}.{suffix}" for stem in stems.values() for suffix in ("nc", "toml")), "demo.png"]
    make_folder(out)
    console = terminal()
    with claim(out / file for file in files):
        result = compare(cases)
        console.print(result)
        share = 100 * float(result.values[DAMPED]["share_normal"])
        console.print(f"{gain(result)}; {share:.0f} % of the energy is lost in impacts.", soft_wrap=True)
        list_files(out, rattlebox.__version__, dict.fromkeys(files, ""))
        for name, run in runs_of(result).items():
            run.save(out / f"{stems[name]}.nc")
            cases[name].to_file(out / f"{stems[name]}.toml")
        figure(result).savefig(out / "demo.png")
        list_files(out, rattlebox.__version__, {file: digest_of(out / file) for file in files})
    console.print(f"written to {out}: demo.png, and a netCDF and a case file of each run", soft_wrap=True)
