"""Figure A6: steady motions of the paper's system over the frequency of a load, stable and unstable, by continuation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from rattlebox import Branch, Case, CaseError, Newton, Orbit, continue_orbit, find_orbit
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import INK, StyledFigure, pen

from .contacts_per_cycle import AMPLITUDE
from .figure import Reproduction
from .files import simulate_many
from .harmonic import harmonic_case, resonance, riding
from .models import COLOURS, MODELS
from .system import GAP

RANGE = (3.0, 23.0)  # of the frequency of the load [Hz]
FREQUENCIES = np.arange(30, 231, 2) / 10  # of the runs [Hz]
SETTLING, COUNTED = 60.0, 15.0  # time left to settle, and least time counted afterwards [s]
PLACES = (0.0, 1.0)  # start of the ball in its cavity over the gap
SEEDS = 5  # motions are sought from the runs at each fifth frequency
MOST = 8  # contacts in a cycle of the motions that are followed
MANY = 6.0  # mean contacts in a cycle from which the ball chatters
LOWEST = 0.3e-3  # approach speed at the lower edge of the figure [m/s]
MODEL = "constant restitution"
MARKS = {"pitchfork": "D", "flip": "s", "fold": "o", "torus": "^", "grazing": "x", "impact lost": "x"}
"""Markers of the special points."""
MEANING = {
    "pitchfork": "symmetry lost",
    "flip": "period doubled",
    "fold": "fold",
    "torus": "torus",
    "grazing": "grazing",
    "impact lost": "grazing",
}


def _case(frequency: float, place: float = 1.0) -> Case:
    """Return the system with hard impacts, whose ball starts at a place of its cavity over the gap."""
    duration = (ceil(SETTLING * frequency) + ceil(COUNTED * frequency)) / frequency
    # The ball rides along at first, so that a start in the centre can lead to another motion than one at a wall.
    state = riding(AMPLITUDE, frequency, place * GAP)
    options: dict[str, Any] = {"method": Newton(), "duration": duration, "times": (0.0,)}
    return harmonic_case(MODELS[MODEL], amplitude=AMPLITUDE, frequency=frequency, state=state, **options)


def cases() -> Mapping[str, Case]:
    """Return a case above resonance."""
    return {"14 Hz": _case(14.0)}


def _orbits(runs: Sequence[Any]) -> list[Orbit]:
    """Return the periodic motions near the ends of runs."""
    found = []
    for run in runs:
        try:
            orbit = find_orbit(run.case, run, period=1)
        except CaseError:
            continue  # there is none near the end of this run
        if 0 < len(orbit.impacts) <= MOST and not orbit.sticks:
            found.append(orbit)
    return found


def _is_on(orbit: Orbit, branch: Branch) -> bool:
    """Return whether a branch passes the amplitude of a motion at its frequency, with as many impacts."""
    data = branch.data
    frequency, size = orbit.cycles / orbit.period, orbit.amplitudes["mass"]
    if int(data.attrs["cycles"]) != orbit.cycles:
        return False
    x, y = data.value.values, np.log(data.amplitude.values[:, 0])
    between = (x[:-1] - frequency) * (x[1:] - frequency) <= 0
    for k in np.flatnonzero(between):
        span = x[k + 1] - x[k]
        part = (frequency - x[k]) / span if span else 0.0
        if abs(y[k] + part * (y[k + 1] - y[k]) - np.log(size)) < 0.02 and len(orbit.impacts) in data.impacts[k : k + 2]:
            return True
    return False


def _branches(orbits: Sequence[Orbit]) -> list[Branch]:
    """Return the branches of motions, each once, and those that begin where motions lose their symmetry."""
    branches: list[Branch] = []
    for orbit in sorted(orbits, key=lambda each: (each.cycles, len(each.impacts))):
        if any(_is_on(orbit, branch) for branch in branches):
            continue
        branch = continue_orbit(orbit, "load.frequency", RANGE, progress=False)
        branches.append(branch)
        for point in branch.specials:
            if point.kind != "pitchfork":
                continue
            try:
                new = branch.switch(point, progress=False)
            except CaseError:
                continue  # it begins at a grazing, where no branch is followed
            if not any(_is_on(new.orbit(len(new) // 2), other) for other in branches):
                branches.append(new)
    return branches


def _table(branches: Sequence[Branch]) -> dict[str, Any]:
    """Return the points of all branches, one after the other."""

    def joined(name: str) -> NDArray[Any]:
        return np.concatenate([np.asarray(branch.data[name].values) for branch in branches])

    cycles = np.concatenate([np.full(len(branch), int(branch.data.attrs["cycles"])) for branch in branches])
    over, slowest = "point", joined("slowest_impact")
    return {
        "branch": (over, np.repeat(np.arange(len(branches)), [len(branch) for branch in branches])),
        "at": (over, joined("value")),
        "slowest": (over, slowest),
        "drawn": (over, np.maximum(slowest, LOWEST)),
        "contacts": (over, joined("impacts") / cycles),
        "repeats": (over, cycles),
        "stable": (over, joined("stable").astype(float)),
        "special": (over, joined("special").astype(str)),
        "located": (over, joined("located")),
    }


def data() -> xr.Dataset:
    """Count contacts of runs at all frequencies, and follow the periodic motions near them."""
    grid = [(float(frequency), place) for frequency in FREQUENCIES for place in PLACES]
    runs, means = simulate_many([_case(*point) for point in grid]), []
    for run, (frequency, _) in zip(runs, grid, strict=True):
        start = ceil(SETTLING * frequency) / frequency
        times, end = run.arrays.impacts.time, float(run.arrays.time[-1])
        means.append(np.mean(impacts_per_cycle(times, 1 / frequency, start=start, end=end)))
    seeds = [run for k, run in enumerate(runs) if k // len(PLACES) % SEEDS == 0]
    branches = _branches(_orbits(seeds))
    mean = np.reshape(means, (FREQUENCIES.size, len(PLACES)))
    return xr.Dataset(
        {
            **_table(branches),
            "mean": (("frequency", "place"), mean),
            "resonance": ((), resonance()),
            "amplitude": ((), AMPLITUDE),
            "gap": ((), GAP),
        },
        {"frequency": FREQUENCIES, "place": np.array(PLACES)},
    )


def _pieces(one: xr.Dataset) -> list[tuple[bool, slice]]:
    """Return the stretches of a branch that are stable or unstable, each with the point behind it."""
    stable = one.stable.values > 0
    edges = np.flatnonzero(np.diff(stable)) + 1
    ends = np.concatenate([[0], edges, [stable.size]])
    return [(bool(stable[a]), slice(int(a), int(b) + 1)) for a, b in pairwise(ends)]


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw speeds and numbers of contacts of all branches over the frequency."""
    top, bottom = figure.subplots(2, 1, sharex=True)
    colour = COLOURS[MODEL]
    for number in np.unique(data.branch):
        one = data.isel(point=data.branch.values == number)
        for stable, part in _pieces(one):
            line: dict[str, Any] = {"color": colour if stable else INK, "ls": "-" if stable else (0, (3, 1.5))}
            width = pen(1.2 if stable else 0.5)
            top.plot(one["at"][part], 1e3 * one["slowest"][part], lw=width, **line)
            bottom.plot(one["at"][part], one["contacts"][part], lw=width, **line)
    named = data.isel(point=data.special.values != "")
    for kind, mark in MARKS.items():
        some = named.isel(point=named.special.values == kind)
        if some.point.size:
            style: dict[str, Any] = {"ms": 3, "mew": 0.6, "clip_on": False, "color": INK, "mfc": "none"}
            top.plot(some.located, 1e3 * some["drawn"], mark, **style, label=MEANING[kind])
            bottom.plot(some.located, some["contacts"], mark, **style)
    bottom.plot(data.frequency, data["mean"], ".", color="0.55", ms=2.5, zorder=0)
    bottom.axhspan(MANY, float(data["mean"].max()) + 1, color="0.93", zorder=-1, lw=0)
    bottom.text(RANGE[1] - 0.2, MANY + 0.3, "chatter", ha="right", va="bottom")
    top.plot([], [], color=colour, lw=pen(1.2), label="stable")
    top.plot([], [], color=INK, lw=pen(0.5), ls=(0, (3, 1.5)), label="unstable")
    bottom.plot([], [], ".", color="0.55", ms=2.5, label="runs, mean of 15 s")
    handles, labels = top.get_legend_handles_labels()
    more, words = bottom.get_legend_handles_labels()
    unique = dict(zip([*labels, *words], [*handles, *more], strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside upper left", ncols=4)
    top.set_yscale("log")
    top.set_ylim(bottom=1e3 * LOWEST)
    top.set_ylabel("Speed of the slowest impact (mm/s)")
    bottom.set_ylabel("Contacts in a cycle (uneven scale)")
    bottom.set_yscale("function", functions=(lambda y: np.sqrt(np.maximum(y, 0)), lambda y: y**2))
    bottom.set_yticks([0, 1, 2, 4, 8, 12, 16, 20, 24])
    bottom.set_ylim(0, float(data["mean"].max()) + 1)
    bottom.set_xlabel("Frequency of the load (Hz)")
    bottom.set_xlim(*RANGE)
    top.set_title("Periodic motions", loc="left")
    bottom.set_title("Contacts", loc="left")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the numbers of branches, of bifurcations between them, and of their contacts."""
    special = data.special.values[data.special.values != ""]
    grazing = data.special.isin(["grazing", "impact lost"])
    smooth = int(np.isin(special, ["pitchfork", "flip", "fold", "torus"]).sum())
    chatter = data.frequency[(data["mean"] >= MANY).any("place")]
    counts = sorted({f"{each:g}" for each in data.contacts.values}, key=float)
    return {
        "branches": int(np.unique(data.branch).size),
        "smooth": smooth,
        "grazing": int(grazing.sum()),
        "numbers": ", ".join(counts),
        "chatter": chatter[[0, -1]].values if chatter.size else np.full(2, np.nan),
        "many": MANY,
        "stable_share": 100 * float((data.stable > 0).mean()),
        "branching": len(counts),
    }


FIGURE = Reproduction("branches", data, draw, 0.85, cases, values)
