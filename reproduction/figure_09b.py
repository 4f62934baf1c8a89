"""Figure 9b: phase portraits of the structure after a weak pulse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .figure import Claim, Reproduction
from .figure_09a import AMPLITUDE, MEMBERS, WINDOW, cases, draw_portraits, outside, portraits
from .reference import DAMPING, MASS, PULSE, STIFFNESS


def data() -> xr.Dataset:
    """Compute the portraits of the structure."""
    return portraits("structure")


def draw(data: xr.Dataset) -> Figure:
    """Draw the portraits of the structure."""
    return draw_portraits(data, ("Displacement", "Velocity"), walls=False)


def _amplitude(data: xr.Dataset) -> xr.DataArray:
    """Return the radius of the portrait [m], with the velocity divided by the natural frequency."""
    radius: xr.DataArray = (data.position**2 + data.velocity**2 * (MASS / STIFFNESS)) ** 0.5
    return radius.where(data.time > PULSE, drop=True)


def _decay(amplitude: xr.DataArray) -> float:
    """Return the rate [1/s] of the exponential fitted to an amplitude."""
    return -float(np.polyfit(amplitude.time, np.log(amplitude), 1)[0])


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    amplitude = _amplitude(data)
    first, last = amplitude.isel(time=0), amplitude.isel(time=-1)
    centred = amplitude.sel(model="constant", case=1)
    kicked = ", ".join(
        f"{1e6 * float(last.sel(model=model, case=k)):.1f} µm in case {k} with {model} restitution"
        for k in (2, 3)
        for model in data.model.values
    )
    return (
        f"The structure in the first {data.time[-1]:g} s after a pulse of {AMPLITUDE:g} N: single runs above, below them "
        f"median and band of {MEMBERS} starts within 1 µm (largest displacement in windows of {WINDOW:g} s). Case 1 is a "
        "spiral from "
        f"{1e6 * float(first.sel(model='constant', case=1)):.1f} µm into a stable focus, at a rate of "
        f"{_decay(centred):.3f} per second; the viscous damper alone gives C/(2M) = {DAMPING / (2 * MASS):.4f}. In cases "
        f"2 and 3 each contact moves the structure to another spiral, inwards or outwards: after {data.time[-1]:g} s the "
        f"amplitude is {kicked}, against {1e6 * float(last.sel(model='constant', case=1)):.1f} µm without any contact. "
        f"{outside(data)}".rstrip()
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on the focus of case 1 and on the effect of contacts."""
    amplitude = _amplitude(data)
    centred = amplitude.sel(case=1)
    rate, viscous = _decay(centred.sel(model="constant")), DAMPING / (2 * MASS)
    focus = int(data.contacts.sel(case=1).max()) == 0 and abs(rate / viscous - 1) < 0.01
    jump = amplitude.diff("time").max(("model", "time"))
    outwards = 1e6 * float(jump.sel(case=[2, 3]).max())
    smooth = 1e6 * float(jump.sel(case=1))
    ends = (amplitude.sel(case=[2, 3]) / centred).isel(time=-1)
    return (
        Claim(
            "Case 1 is a pure stable focus, owed to the viscous damper of the structure.",
            "section 5.1, figure 9",
            f"decay at {rate:.4f} per second, C/(2M) = {viscous:.4f} per second, no contact",
            "case 1 centred; both models",
            "reproduced" if focus else "not reproducible",
        ),
        Claim(
            "With contacts (cases 2 and 3) the behaviour differs qualitatively.",
            "section 5.1, figure 9b",
            f"contacts throw the structure outwards by up to {outwards:.1f} µm at once, "
            f"while case 1 {'only shrinks' if smooth < 0 else f'grows by {smooth:.2g} µm'}; after "
            f"{data.time[-1]:g} s its amplitude is {float(ends.min()):.2f} to {float(ends.max()):.2f} times that of case 1",
            "cases 2 and 3 at either wall; both models",
            "reproduced" if outwards > 10 * abs(smooth) else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="9b",
    title="Phase portraits of the structure after a weak pulse",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
