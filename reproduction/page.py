"""Page of the report, rendered from the computed figures."""

from __future__ import annotations

import platform
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from math import sqrt
from pathlib import Path
from typing import NamedTuple, get_args

from markupsafe import Markup, escape

from .judge import RESAMPLES, RULE, Claim, Verdict, fit
from .matrix import MARKS, best_fit, place, row
from .models import COLOURS, SHORT
from .reading import EQUATIONS, INTERPRETATIONS, MISPRINTS, PROVENANCE
from .runs import Files

GENERATOR = '<meta name="generator" content="Rattlebox">'  # Mark by which pages of this program are recognised
PAPER = "Energy Dissipation in Particle-based Impact Damper Systems: Investigation based on Elasto-plastic impact model"


FIRST = "figure_01"  # Figure that opens the page, with the system


class Column(NamedTuple):
    """Name, unit and description of a column of a table."""

    name: str
    units: str
    meaning: str


@dataclass(frozen=True)
class Table:
    """CSV file; its path is relative to the page."""

    path: str
    rows: int
    columns: tuple[Column, ...]


@dataclass(frozen=True)
class FigureFiles:
    """Figure that was computed, drawn and written; paths are relative to the page."""

    number: str
    title: str
    name: str
    caption: str
    claims: tuple[Claim, ...]
    lessons: tuple[str, ...]
    film: str
    picture: str
    svg: str
    png: str
    tables: tuple[Table, ...]
    cases: Mapping[str, Files]
    computing: float
    drawing: float

    @property
    def label(self) -> str:
        """Name of the figure on the page."""
        return f"{'Figures' if ',' in self.number else 'Figure'} {self.number}"

    @property
    def further(self) -> int:
        """Number of runs in study files."""
        return sum(files.runs for files in self.cases.values())


def render(
    figures: Sequence[FigureFiles],
    *,
    table: str,
    missing: Sequence[str] = (),
    cores: int,
    workers: int,
    seconds: float,
) -> str:
    """Return the page as self-contained HTML."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    from rattlebox import EventDriven, __version__

    pairs = sorted(((claim, figure) for figure in figures for claim in figure.claims), key=lambda x: place(x[0].where))
    claims = [claim for claim, _ in pairs]
    anchors = {number: one for one in figures for number in (one.number, *_parts(one.number))}
    rows = [(row(claim), anchors.get(claim.see, figure)) for claim, figure in pairs]
    counts = Counter(each.verdict for each, _ in rows)
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).with_name("templates")),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["typeset"] = typeset
    return environment.get_template("report.html").render(
        generator=Markup(GENERATOR),
        title="A particle damper, reproduced and judged",
        paper=PAPER,
        figures=figures,
        missing=missing,
        table=table,
        groups=(
            (
                "Figures of the paper",
                [figure for figure in figures if figure.number[0].isdigit() and figure.name != FIRST],
            ),
            ("Interpretations, ensembles and gap", [f for f in figures if f.number.startswith("R")]),
            ("Extensions", [figure for figure in figures if figure.number.startswith("A")]),
        ),
        first=[figure for figure in figures if figure.name == FIRST],
        rows=rows,
        unprinted=sum(each.verdict == "reproduced" and not each.claim.printed for each, _ in rows),
        reproduced=counts["reproduced"],
        counts=[(verdict, counts[verdict]) for verdict in get_args(Verdict) if counts[verdict]],
        lessons=[lesson for figure in figures for lesson in figure.lessons],
        film="".join(figure.film for figure in figures),
        fits=[(SHORT[wall], order, found) for (wall, order), found in fit(claims).items()],
        best=best_fit(claims),
        marks=MARKS,
        models=[(SHORT[model], colour) for model, colour in COLOURS.items()],
        rule=RULE,
        resamples=RESAMPLES,
        provenance=PROVENANCE,
        equations=EQUATIONS,
        interpretations=INTERPRETATIONS,
        misprints=MISPRINTS,
        system=system(),
        version=__version__,
        platform=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        created=datetime.now(UTC).isoformat(" ", timespec="minutes")[:16],
        cores=cores,
        workers=workers,
        tolerance=EventDriven().tolerance,
        seconds=seconds,
    )


def _parts(number: str) -> list[str]:
    """Return the single numbers of a figure, such as "7d" and "7e" for "7d, 7e"."""
    return number.split(", ")


def _power(found: re.Match[str]) -> str:
    """Return 4e+02 as 400 and 4e-09 as a power of ten."""
    exponent = int(found[2])
    return f"{float(found[0]):g}" if 0 <= exponent <= 3 else f"{found[1]} × 10<sup>{exponent}</sup>"


_TYPESET: tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...] = (
    (r"(\d+(?:\.\d+)?)e([+-]?\d+)\b", _power),
    (r"\b(\w)_(\w+)\b", r"\1<sub>\2</sub>"),
    (r"\^(-?[\d.]*\d)", r"<sup>\1</sup>"),
    (r"\bsqrt\b", "√"),
    (r"\blog10\b", "log<sub>10</sub>"),
    (r"(?<![\w)])-(?=[\dα-ω])", "−"),
    (r"\*\*(.+?)\*\*", r"<strong>\1</strong>"),
    (r"(?<=\d) (?=(?:%|[kmµ]?[NsmJ]|m/s|rad/s)(?!\w))", "\N{NO-BREAK SPACE}"),
)


def typeset(text: str) -> Markup:
    """Return text as HTML with typeset powers of ten, subscripts, exponents, minus signs and units that stay with a number.

    Parameters
    ----------
    text
        Text such as "V_c is 4e-09 m/s" or "N/m^1.5".
    """
    html = str(escape(text))
    for pattern, printed in _TYPESET:
        html = re.sub(pattern, printed, html)
    return Markup(html)


class Quantity(NamedTuple):
    """Row of the table of parameters."""

    name: str
    symbol: str
    value: str
    unit: str


def system() -> tuple[Quantity, ...]:
    """Return the parameters of the paper's system."""
    from rattlebox import HalfSine, JacksonGreen, contact_pairs, restitution_of_alpha

    from .reference import ALPHA, DAMPING, GAP, MASS, PULSE, RADIUS, STIFFNESS, paper_case

    case = paper_case()
    pair, pulse = contact_pairs(case, 0)[0], case.loads[0]
    ball = pair.above
    assert ball.material is not None and isinstance(pulse, HalfSine)
    steel, rigid = JacksonGreen(), JacksonGreen(wall="rigid")
    together = MASS + ball.mass
    return (
        Quantity("Mass of the structure", "M", f"{MASS:g}", "kg"),
        Quantity("Stiffness", "K", f"{STIFFNESS / 1e3:g}", "kN/m"),
        Quantity("Viscous damping", "C", f"{DAMPING:g}", "N s/m"),
        Quantity("Damping ratio", "C / 2√(KM)", f"{100 * DAMPING / (2 * sqrt(STIFFNESS * MASS)):.4f}", "%"),
        Quantity("Natural frequency, ball in flight", "√(K/M)", f"{sqrt(STIFFNESS / MASS):.4f}", "rad/s"),
        Quantity("Natural frequency, ball riding along", "√(K/(M+m))", f"{sqrt(STIFFNESS / together):.4f}", "rad/s"),
        Quantity("Radius of the ball", "R", f"{1e3 * RADIUS:g}", "mm"),
        Quantity("Mass of the ball", "m", f"{ball.mass:.6f}", "kg"),
        Quantity("Mass ratio", "m/M", f"{100 * ball.mass / MASS:.4f}", "%"),
        Quantity("Clearance on each side of the centred ball", "d_0", f"{1e3 * GAP:g}", "mm"),
        Quantity("Young's modulus of steel", "E", f"{ball.material.young / 1e9:g}", "GPa"),
        Quantity("Poisson's ratio", "ν", f"{ball.material.poisson:g}", ""),
        Quantity("Yield stress", "S_y", f"{(ball.material.yield_stress or 0) / 1e6:g}", "MPa"),
        Quantity("Density", "ρ", f"{ball.material.density:g}", "kg/m³"),
        Quantity("Hertz stiffness, ball on steel wall", "A", f"{pair.hertz_stiffness / 1e9:.5f}", "GN/m^1.5"),
        Quantity("Damping coefficient of the constant model", "α", f"{ALPHA:g}", ""),
        Quantity("Its restitution", "e", f"{restitution_of_alpha(ALPHA, 'zero_overlap'):.6f}", ""),
        Quantity("Speed of first yield, steel wall", "V_c", f"{steel.critical_speed(pair):.5f}", "m/s"),
        Quantity("Speed of first yield, rigid wall", "V_c", f"{rigid.critical_speed(pair):.5f}", "m/s"),
        Quantity("Amplitude of the pulse", "F_0", f"{pulse.amplitude:g}", "N"),
        Quantity("Duration of the pulse", "t_f", f"{1e3 * PULSE:g}", "ms"),
    )
