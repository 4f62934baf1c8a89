"""Write docs/validation/verification_table.md: exact and computed values and their differences, one line per comparison.

python benchmarks/verification_table.py [target]
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from support import dem_lines, impact_lines, study_lines  # noqa: E402

TITLES = {
    "1": "A ball against a fixed wall",
    "2": "Jackson and Green's restitution in a fixed cavity",
    "3": "Thornton's hysteretic contact",
    "4": "Impact damper with two impacts per cycle",
    "5": "Ball in a shaken cavity",
    "6": "Sticky load in a shaken cavity",
    "7": "Ball on a vibrating table, and chatter",
    "8": "Inelastic ball on a shaker",
    "9": "Impact oscillator",
    "dem": "Particle dampers (3-D)",
    "maps": "Maps of studies",
}
HEAD = """# Verification table

Exact values, values computed by Rattlebox and their relative difference. Each line is also a test;
`python benchmarks/verification_table.py` writes this page. The exact values come from closed formulas in
`tests/support/exact`.
"""


def escaped(text: str) -> str:
    """Return a text whose pipes do not end the cell of a table."""
    return text.replace("|", r"\|")


def table() -> str:
    """Return the page."""
    lines = [line for function in (*impact_lines.ALL, *dem_lines.ALL, *study_lines.ALL) for line in function()]
    parts = [HEAD]
    for item, title in TITLES.items():
        parts.append(f"\n## {title}\n\n| case | exact | computed | difference |\n|---|---:|---:|---:|\n")
        parts += [
            f"| {escaped(line.case)} | {line.exact:.12g} | {line.ours:.12g} | {line.difference:.1e} |\n"
            for line in lines
            if line.item == item
        ]
        if item == "dem":
            parts.append(
                "\nSteps are 1/2000 of a contact. Restitution, friction, plastic flow and one ball in one direction"
                " converge with the square of the step; restitution of contacts that end at zero overlap with its power"
                " 5/4 (Hertz) or 1 (linear). Balls that slip, roll or lie on a floor overlap with it, by some 0.03 % of"
                " the radius. The ball on a shaker keeps a tenth of its speed, and so a hundredth of the energy, at each"
                " impact."
                " Alumina is test 4 of Chung and Ooi, against an independent integration of the law. Their figure"
                " shows, at 5, 10, 15, 20 and 25 degrees, a tangential restitution of 0.948, 0.687, 0.624, 0.616 and"
                " 0.634: those of a spring without dashpot that keeps its stretch (0.948, 0.694, 0.627, 0.618, 0.637),"
                " read to 0.003 and 0.2 degrees. Such a spring generates energy where contacts are pressed together, up to"
                " 0.8 % in an impact; the spring used here generates none, and gives 0.855, 0.710, 0.631, 0.620 and 0.639."
                " From 30 degrees on, where contacts slide, all of them and the print agree.\n"
            )
        if item == "maps":
            parts.append(
                "\nA threshold is taken as the middle between two values: bifurcation diagrams step by 0.0005, frequency"
                " responses by 0.0002 (lower limits) or 0.0005. The maximum of the loss over the clearance is flat.\n"
            )
        if item == "4":
            orders = ", ".join(f"{impact_lines.soft_order(law):.3f} ({law})" for law in impact_lines.SOFT_DAMPERS)
            parts.append(
                "\nSoft contacts tend to hard impacts as the contact time goes to zero; measured order of the error"
                f" in the approach speed: {orders}.\n"
            )
    return "".join(parts)


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "validation" / "verification_table.md"
    target.write_text(table(), encoding="utf-8")
    print(f"wrote {target}")
