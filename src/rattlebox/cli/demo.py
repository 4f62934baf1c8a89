"""`rattlebox demo`: one steel ball, two restitution models side by side."""

from __future__ import annotations

from pathlib import Path

from rattlebox.cli.folder import make_folder
from rattlebox.cli.terminal import terminal
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.case import Case
from rattlebox.model.contacts import Tsuji
from rattlebox.model.dampers import ImpactDamper, Sphere
from rattlebox.model.restitutions import JacksonGreen
from rattlebox.model.signals import HalfSine
from rattlebox.model.structures import SDOF
from rattlebox.plots.compare import plot_comparison as draw
from rattlebox.results.summary import compare


def demo_case(contact: Tsuji) -> Case:
    """Return the single-ball case: 1.2 kg of steel on 20 kg, hit by 5 kN for 1 ms."""
    return Case(
        structure=SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
        dampers=(ImpactDamper(balls=(Sphere(radius="33.17 mm", material="steel"),), gap="0.4 mm", contact=contact),),
        loads=(HalfSine(amplitude="5 kN", duration="1 ms"),),
        duration="5 s",
    )


def run_demo(out: Path) -> None:
    """Run both models, print the comparison, write the figure and the netCDF and case files.

    Parameters
    ----------
    out
        Folder, made if needed.
    """
    cases = {
        "constant alpha": demo_case(Tsuji(alpha=0.006313, ending="zero_overlap")),
        "Jackson-Green": demo_case(Tsuji(restitution=JacksonGreen(), ending="zero_overlap")),
    }
    make_folder(out)
    runs = dict(zip(cases, simulate_many(list(cases.values())), strict=True))
    console = terminal()
    console.print(compare(runs))
    for name, run in runs.items():
        stem = name.lower().replace(" ", "_").replace("-", "_")
        run.save(out / f"{stem}.nc")
        cases[name].to_file(out / f"{stem}.toml")
    draw(runs).savefig(out / "demo.png")
    console.print(f"written to {out}: demo.png, and a netCDF and a case file of each model", soft_wrap=True)
