"""Draws the pictures of the README and of the home page: `python tools/front_page.py`.

docs/_static/demo.png is the figure of `rattlebox demo`; docs/_static/three_structures.svg is an animation of the same
structure without a ball, with a gap that is too narrow, and with the right gap.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np

import rattlebox as rb
from rattlebox.cli.demo import BARE, DAMPED, demo_cases, figure

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from reproduction.film import SLOWER, Row, film  # noqa: E402

STATIC = ROOT / "docs" / "_static"
NARROW = "0.2 mm"
SPAN, FRAMES = 1.6, 320
"""Time that the animation shows [s], and its number of positions."""
STYLE = """
text { font: 19px sans-serif; fill: #1a1a1a; }
.mark { fill: none; stroke: #6b6b6b; }
.structure { fill: #e3ecf3; stroke: #0b3d6b; }
.cavity { fill: #fff; stroke: #0b3d6b; }
.ball { fill: #d1742c; stroke: #1a1a1a; }
.empty { fill: none; stroke: #b3b3b3; }
.energy { fill: #0b3d6b; }
"""


def runs() -> dict[str, rb.Run]:
    """Return the runs of the animation by their names."""
    cases = demo_cases()
    narrow = cases[DAMPED].replaced({"damper.gap": NARROW})
    values = rb.compare({"no ball": cases[BARE], NARROW: narrow, "2 mm": cases[DAMPED]})
    return {
        f"{name if name == 'no ball' else f'gap {name}'}: "
        f"at rest after {values.values[name]['settling_time[mass]']:.2g} s": run
        for name, run in values.runs.items()
    }


def animation(shown: dict[str, rb.Run]) -> str:
    """Return the animation as a file of its own."""
    time = np.linspace(0, SPAN, FRAMES)

    def row(name: str, run: rb.Run) -> Row:
        arrays = run.arrays
        dampers = run.case.impact_dampers
        ball = arrays.relative_position[:, 0] if dampers else np.zeros(arrays.time.size)
        curves = arrays.displacement[:, 0], ball, run.ledger.total / run.ledger.work[-1]
        structure, place, energy = (np.interp(time, arrays.time, values) for values in curves)
        return Row(name, structure, place, energy, 0.5 * dampers[0].clearance if dampers else 0.0)

    text = film([row(name, run) for name, run in shown.items()], SPAN)
    head = re.sub(r'<svg id="film" ', '<svg xmlns="http://www.w3.org/2000/svg" ', text, count=1)
    note = f'<text x="510" y="288" style="font-size:15px">{SLOWER} times slower; motion magnified</text>'
    start = head.index(">") + 1
    end = head.rindex("</svg>")
    paper = '<rect width="100%" height="100%" fill="#fff"/>'
    return f"{head[:start]}<style>{STYLE}</style>{paper}{head[start:end]}{note}</svg>\n"


def main() -> None:
    """Write both pictures."""
    figure(rb.compare(demo_cases())).savefig(STATIC / "demo.png", dpi=200)
    (STATIC / "three_structures.svg").write_text(animation(runs()), encoding="utf-8")


if __name__ == "__main__":
    main()
