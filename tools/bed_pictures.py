"""Draws the pictures of beds of the pages and of the gallery: `python tools/bed_pictures.py [NAME ...]`.

docs/_static/beds/NAME.jpg is the picture of the card of examples/NAME.py (see docs/cards.toml), or a picture of a page. The
cases are those of the examples.
"""

from __future__ import annotations

import io
import os
import runpy
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image, ImageChops

import rattlebox as rb

ROOT = Path(__file__).resolve().parents[1]
BEDS = ROOT / "docs" / "_static" / "beds"


def example(name: str) -> dict[str, Any]:
    """Return the names that a script of examples/ defines."""
    with TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)
        sys.path.insert(0, str(ROOT / "examples" / "validation"))
        try:
            (path,) = (ROOT / "examples").rglob(f"{name}.py")
            return runpy.run_path(str(path))
        finally:
            os.chdir(before)
            del sys.path[0]
            plt.close("all")


def portrait(case: rb.Case, **options: Any) -> Image.Image:
    """Return a picture of the particles at the end of a run, without a colour bar and empty margins."""
    run = rb.simulate(case, progress=False)
    figure = rb.plot_particles(run, renderer="plain", size="column", **options)
    for axes in figure.axes[1:]:
        axes.remove()
    for axes in figure.axes:
        scale = [line for line in axes.lines if line.get_solid_capstyle() == "butt"]  # edges have other ends
        for each in (*axes.texts, *scale):
            each.remove()
        for place in ("left", "center", "right"):
            axes.set_title("", loc=place)
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=300)
    plt.close(figure)
    picture = Image.open(buffer).convert("RGB")
    box = ImageChops.difference(picture, Image.new("RGB", picture.size, "white")).getbbox()
    return picture.crop(box)


def save(name: str, picture: Image.Image, width: int) -> None:
    """Write a picture of this width [pixels]."""
    BEDS.mkdir(exist_ok=True)
    size = (width, round(width * picture.height / picture.width))
    picture.resize(size, Image.Resampling.LANCZOS).save(BEDS / f"{name}.jpg", quality=88, optimize=True)
    print(f"{name}: {size[0]} x {size[1]}, {(BEDS / f'{name}.jpg').stat().st_size / 1e3:.0f} kB")


def side_by_side(cases: Mapping[str, rb.Case], **options: Any) -> Image.Image:
    """Return pictures of several cases with their names below, at one scale."""
    pictures = {name: portrait(case, **options) for name, case in cases.items()}
    widths = [picture.width for picture in pictures.values()]
    figure, panels = plt.subplots(
        1, len(cases), figsize=(2.3 * len(cases), 2.9), width_ratios=widths, layout="constrained"
    )
    for panel, (name, picture) in zip(np.atleast_1d(panels), pictures.items(), strict=True):
        panel.imshow(picture, interpolation="lanczos")
        panel.set_axis_off()
        panel.text(0.5, -0.03, name, transform=panel.transAxes, ha="center", va="top", fontsize=11)
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=170)
    plt.close(figure)
    return Image.open(buffer).convert("RGB")


def regimes() -> dict[str, rb.Case]:
    """Return the four regimes at moments that show them."""
    names = example("regimes")
    box, one_g, best, hertz = names["box"], names["ONE_G"], names["BEST"], names["HERTZ"]
    earth, space = names["EARTH"], names["SPACE"]

    def after(cycles: float, amplitude: float, gravity: Any) -> rb.Case:
        return box(amplitude, gravity, duration=cycles / hertz)

    return {
        "locked\n0.7 g": after(10.25, 0.7 * one_g, earth),
        "bouncing\n2.2 g": after(10.4, 2.2 * one_g, earth),
        "gas\n0.3 L/π, no gravity": after(10.25, 0.3 * best, space),
        "collect and collide\nL/π, no gravity": after(10.5, best, space),
    }


def box_at_work() -> rb.Case:
    """Return the case of the page on particle dampers, hit harder, 30 ms later."""
    return rb.Case(
        structure=rb.SDOF(mass="2 kg", stiffness="80 kN/m", damping_ratio=0.002, velocity="0.8 m/s"),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="6 mm", count=80),
            cavity=rb.Box(size=("40 mm", "40 mm", "30 mm")),
            contact=rb.Tsuji(restitution=0.9),
            friction=0.2,
            packing=rb.Settled(seed=1),
            softening=50,
        ),
        duration="0.03 s",
        output=rb.Output(rate="2 kHz"),
    )


def beds_of_fills() -> dict[str, rb.Case]:
    """Return the beds of examples/fills.py at rest."""
    cylinder = example("fills")["cylinder"]
    still = {"structure": rb.Fixed(), "duration": "1 ms"}
    return {
        "poured, 90 %": rb.Case(damper=cylinder(0.9, rb.Settled(seed=1)), **still),
        "shaken down, 90 %": rb.Case(damper=cylinder(0.9, rb.Compacted(seed=1)), **still),
        "shaken down, full": rb.Case(damper=cylinder(1, rb.Compacted(seed=1)), **still),
    }


def bar() -> rb.Case:
    """Return the fullest bar after a blow."""
    case = example("boring_bar")["bar"](0.4)
    return case.replaced({"structure.velocity": 0.3, "duration": 0.02})


def only(name: str, variable: str, **changes: Any) -> rb.Case:
    """Return a case of a script with other values."""
    return example(name)[variable].replaced(changes)


def panel() -> rb.Case:
    """Return the box of the satellite panel in random vibration."""
    names = example("panel")
    run = {**names["run"], "base": rb.Random("gevs_acceptance", "0.2 s", seed=1), "duration": "0.2 s"}
    return rb.Case(structure=names["panel"], damper=names["damper"], **run)


def building() -> rb.Case:
    """Return the sixteen balls of the building when they move most."""
    names = example("building")
    return rb.Case(**{**names["common"], "duration": "6 s"}, damper=names["balls"])


def two_hundred() -> rb.Case:
    """Return the two hundred balls of the case file after the blow."""
    return rb.Case.from_file(ROOT / "examples" / "steel_balls_in_a_box.toml").replaced({"duration": 0.06})


PICTURES: dict[str, Callable[[], tuple[Image.Image, int]]] = {
    "regimes": lambda: (portrait(list(regimes().values())[3], colour="speed"), 640),
    "four_regimes": lambda: (side_by_side(regimes(), colour="none"), 1300),
    "boring_bar": lambda: (portrait(bar()), 640),
    "panel": lambda: (portrait(panel()), 640),
    "building": lambda: (portrait(building(), view=(-60.0, 35.0)), 640),
    "fills": lambda: (portrait(beds_of_fills()["shaken down, 90 %"], colour="none"), 640),
    "three_fills": lambda: (side_by_side(beds_of_fills(), colour="none"), 1100),
    "shaken_box": lambda: (portrait(only("shaken_box", "BOX", duration=0.215)), 640),
    "two_case_files": lambda: (portrait(two_hundred()), 640),
    "box_at_work": lambda: (portrait(box_at_work()), 640),
}


def main() -> None:
    """Draw the pictures, or those that are named."""
    for name in sys.argv[1:] or PICTURES:
        save(name, *PICTURES[name]())


if __name__ == "__main__":
    main()
