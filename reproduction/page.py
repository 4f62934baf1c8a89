"""Page of the report, rendered from the computed figures."""

from __future__ import annotations

import platform
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from math import sqrt
from pathlib import Path
from typing import Any, NamedTuple, get_args

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from .files import Files
from .judge import CLAIMS, MARKS, RESAMPLES, Claim, Verdict, best_fit, fit, place, row
from .models import COLOURS, SHORT

GENERATOR = '<meta name="generator" content="Rattlebox">'  # Mark by which pages of this program are recognised
PAPER = "Energy Dissipation in Particle-based Impact Damper Systems: Investigation based on Elasto-plastic impact model"
FIRST = "figure_01"  # Figure that opens the page, with the system
_GROUPS = {"Figures of the paper": r"\d", "Interpretations, ensembles and gap": "R", "Extensions": "A"}


class Table(NamedTuple):
    """CSV file; its path is relative to the page."""

    path: str
    rows: int
    columns: tuple[tuple[str, str, str], ...]  # Name, unit and meaning of each


@dataclass(frozen=True)
class FigureFiles:
    """Figure that was computed, drawn and written."""

    number: str
    title: str
    name: str
    caption: str
    claims: tuple[Claim, ...]
    lessons: tuple[str, ...]
    film: str
    picture: str
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


@cache
def templates() -> Environment:
    """Return the templates of the page."""
    loader = FileSystemLoader(Path(__file__).with_name("templates"))
    spaces: dict[str, Any] = {"trim_blocks": True, "lstrip_blocks": True}
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, **spaces)
    environment.filters["typeset"] = typeset
    return environment


def render(
    figures: Sequence[FigureFiles], *, table: str, missing: Sequence[str] = (), cores: int, workers: int, seconds: float
) -> str:
    """Return the page as self-contained HTML."""
    from rattlebox import EventDriven, __version__

    pairs = sorted(((claim, figure) for figure in figures for claim in figure.claims), key=lambda x: place(x[0].where))
    claims = [claim for claim, _ in pairs]
    anchors = {number: one for one in figures for number in (one.number, *one.number.split(", "))}
    rows = [(row(claim), anchors.get(claim.see, figure)) for claim, figure in pairs]
    counts = Counter(each.verdict for each, _ in rows)
    return (
        templates()
        .get_template("report.html")
        .render(
            generator=Markup(GENERATOR),
            title="A particle damper, reproduced and judged",
            paper=PAPER,
            figures=figures,
            missing=missing,
            table=table,
            groups=[
                (heading, [f for f in figures if re.match(first, f.number) and f.name != FIRST])
                for heading, first in _GROUPS.items()
            ],
            first=[f for f in figures if f.name == FIRST],
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
            resamples=RESAMPLES,
            **{name: CLAIMS[name] for name in ("rule", "provenance", "equations", "readings", "misprints")},
            system=system(),
            version=__version__,
            platform=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
            created=datetime.now(UTC).isoformat(" ", timespec="minutes")[:16],
            cores=cores,
            workers=workers,
            tolerance=EventDriven().tolerance,
            seconds=seconds,
        )
    )


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
    """Return text such as "V_c is 4e-09 m/s" or "N/m^1.5" as HTML; units stay with their number."""
    html = str(escape(text))
    for pattern, printed in _TYPESET:
        html = re.sub(pattern, printed, html)
    return Markup(html)


def system() -> list[tuple[str, str, str, str]]:
    """Return name, symbol, value and unit of the parameters of the paper's system."""
    from rattlebox import HalfSine, JacksonGreen, contact_pairs, restitution_of_alpha

    from .system import ALPHA, DAMPING, GAP, MASS, PULSE, RADIUS, STIFFNESS, paper_case

    case = paper_case()
    pair, pulse = contact_pairs(case, 0)[0], case.loads[0]
    ball = pair.above
    assert ball.material is not None and isinstance(pulse, HalfSine)
    steel, rigid = JacksonGreen(), JacksonGreen(wall="rigid")
    values = {
        "mass": MASS,
        "stiffness": STIFFNESS / 1e3,
        "damping": DAMPING,
        "ratio": 100 * DAMPING / (2 * sqrt(STIFFNESS * MASS)),
        "flight": sqrt(STIFFNESS / MASS),
        "riding": sqrt(STIFFNESS / (MASS + ball.mass)),
        "radius": 1e3 * RADIUS,
        "ball": ball.mass,
        "share": 100 * ball.mass / MASS,
        "gap": 1e3 * GAP,
        "young": ball.material.young / 1e9,
        "poisson": ball.material.poisson,
        "yield_stress": (ball.material.yield_stress or 0) / 1e6,
        "density": ball.material.density,
        "hertz": pair.hertz_stiffness / 1e9,
        "alpha": ALPHA,
        "restitution": restitution_of_alpha(ALPHA, "zero_overlap"),
        "steel": steel.critical_speed(pair),
        "rigid": rigid.critical_speed(pair),
        "load": pulse.amplitude,
        "pulse": 1e3 * PULSE,
    }
    return [(name, symbol, form.format_map(values), unit) for name, symbol, form, unit in CLAIMS["parameters"]]
