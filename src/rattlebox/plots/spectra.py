"""Figures of runs over frequency: power spectral density, levels in octave bands, shock response spectrum."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox._util.exceptions import CaseError

from ..analysis.power_spectra import band_levels, power_spectral_density
from ..analysis.shock import shock_response_spectrum
from ..analysis.signals import labelled
from ..model.units import STANDARD_GRAVITY
from ..results import Run
from ..results.acceleration import base_at_points
from ..results.figures import run_figure
from ..results.summary import largest_points
from .labels import log_ticks
from .panels import MAX_SERIES, draw_line, time_window
from .responses import response
from .style import StyledFigure, axis_in_g, figure_style, label, legend_above, pen, scaled, series_colour
from .types import Size, Vector

if TYPE_CHECKING:
    import xarray

_BASE = "base"
_ACCELERATIONS = {"acceleration": "Acceleration relative to base", "absolute_acceleration": "Absolute acceleration"}
_UNDER = 0.05
"""Share of the mean square below the lowest third-octave band from which on the legend states it."""
_DECADES = 8  # of a power spectral density below its peak; numbers below are rounding


class _Signal(NamedTuple):
    """Samples of one line of a figure at even times, (N,), with its name."""

    time: Vector
    values: xarray.DataArray
    name: str


class _Signals(NamedTuple):
    """Lines of a figure, their quantity and unit; those with the largest RMS of many."""

    lines: list[_Signal]
    text: str
    unit: str
    choice: str

    @classmethod
    def of(cls, run: Run, of: str, point: str | None, between: tuple[float, float] | None) -> _Signals:
        """Return the signals of a variable."""
        arrays, window = run.arrays, time_window(run.arrays, between)
        time = arrays.time[window]
        if of in _ACCELERATIONS:
            panel = response(run, "velocity", point)
            values, names, text, unit = panel.values, panel.names, _ACCELERATIONS[of], "m/s^2"
            if point is not None:
                text = f"{text} of {point}"
            if of == "absolute_acceleration" and arrays.base_velocity.any():
                base = base_at_points(run.case, arrays.base_velocity)[:, [arrays.points.index(name) for name in names]]
                values, names = np.column_stack([values + base, base[:, :1]]), [*names, _BASE]
            # Differences of the velocity contain each contact, and samples of the acceleration the contacts that they hit.
            values, time = np.diff(values[window], axis=0) / np.diff(time)[:, None], time[:-1] + 0.5 * np.diff(time)
        else:
            panel = response(run, of, point)
            values, names, text, unit = panel.values[window], panel.names, panel.text, panel.unit
        if point is not None and point not in names:
            raise CaseError(f"point = {point!r} is not a point of this run", ", ".join(arrays.points))
        points = names[: len(names) - (_BASE in names)]
        chosen = largest_points(values[:, : len(points)].std(axis=0), MAX_SERIES - 1 if _BASE in names else MAX_SERIES)
        choice = f"the largest {len(chosen)} of {len(points)}" if len(chosen) < len(points) else ""
        chosen += [len(points)] * (_BASE in names)
        lines = [_Signal(time, labelled("x", values[:, k], unit, text, time=time), names[k]) for k in chosen]
        return cls(lines, text, unit, choice)

    def densities(self, resolution: float | None) -> Iterator[xarray.DataArray]:
        """Yield the power spectral density of each line, without the loss of means over a sampling step."""
        for line in self.lines:
            try:
                found = power_spectral_density(line.time, line.values, resolution=resolution)
            except ValueError as error:
                raise CaseError(str(error), "output = rb.Output(rate=...) for even times; resolution") from None
            step = float(line.time[1] - line.time[0])
            gain = (
                np.sinc(found.frequency * step) ** 2 if self.text.split(" of ")[0] in _ACCELERATIONS.values() else 1.0
            )
            density = (found.density / gain).assign_attrs(found.density.attrs | found.attrs)[1:]  # the mean is removed
            # The windows of the density weigh the ends of a run less: its area differs from the mean square of a short run.
            areas = [max(float(each.integrate("frequency")), 1e-300) for each in (density, found.density[1:])]
            yield density.assign_attrs(rms=float(line.values.std()) * np.sqrt(areas[0] / areas[1]))

    def named(self, line: _Signal, value: float, what: str) -> str:
        """Return the name of a line with a number of it, accelerations in g."""
        number = f"{value / STANDARD_GRAVITY:.3g} g" if self.unit == "m/s^2" else ""
        if not number:
            divisor, unit = scaled(value, self.unit)
            number = f"{value / divisor:.3g} {unit}"
        return " ".join(filter(None, (line.name, what, number)))

    def finish(self, axes: Axes, text: str, unit: str, per_g: float) -> None:
        """Label the axes, with a second axis in g."""
        axes.set_xscale("log")
        log_ticks(axes.xaxis)
        label(axes, "x", "Frequency", "Hz")
        label(axes, "y", text, unit)
        if self.unit == "m/s^2":
            axis_in_g(axes, "y", per_g, unit=unit.replace("(m/s^2)", "g").replace("m/s^2", "g"))
        legend_above(axes, **({"title": self.choice, "alignment": "left"} if self.choice else {}))


@run_figure("psd")
def plot_psd(
    run: Run,
    *,
    of: str = "absolute_acceleration",
    point: str | None = None,
    resolution: float | None = None,
    size: Size = "column",
    between: tuple[float, float] | None = None,
) -> Figure:
    """Draw the power spectral density of a response, with the RMS value of the whole run in the legend.

    Parameters
    ----------
    run
        Run with evenly spaced output times, `rb.Output(rate=...)`.
    of
        Variable of the motion or drift, as in `plot_responses`.
    point
        Point of the structure; default all, of many those with the largest RMS value.
    resolution
        Spacing of the frequencies [Hz]; see `rattlebox.analysis.power_spectral_density`.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to evaluate [s]; default the whole run.

    Returns
    -------
    Figure
        Figure with one panel; of a single line with the 95 % interval. Absolute accelerations have a line of the base, and
        all accelerations a second axis in g^2/Hz.

    Raises
    ------
    CaseError
        If the run has no such variable or point, its output times are not even, or the resolution does not fit.

    Notes
    -----
    Accelerations are differences of the velocity over the output step, which contain each contact, divided by the factor
    sinc(f dt) by which a mean over the step reduces a harmonic motion of frequency f.
    """
    from scipy.stats import chi2

    signals = _Signals.of(run, of, point, between)
    densities = list(signals.densities(resolution))
    peak = max(float(density.max()) for density in densities)
    with figure_style(size):
        figure = StyledFigure(size, 0.7)
        axes = figure.subplots()
        for number, (line, density) in enumerate(zip(signals.lines, densities, strict=True)):
            name = signals.named(line, density.attrs["rms"], "RMS")
            draw_line(axes, density.frequency.values, density.values, number, name)
            if len(signals.lines) == 1:
                freedom = density.attrs["degrees_of_freedom"]
                ends = (density * freedom / chi2.ppf(share, freedom) for share in (0.975, 0.025))
                axes.fill_between(density.frequency, *ends, color=series_colour(number), alpha=0.25, lw=0)
        axes.set_yscale("log")
        axes.set_ylim(bottom=max(peak * 10.0**-_DECADES, 0.5 * min(float(density.min()) for density in densities)))
        unit = f"({signals.unit})^2/Hz" if "/" in signals.unit else f"{signals.unit}^2/Hz"
        signals.finish(axes, f"PSD of {signals.text[0].lower()}{signals.text[1:]}", unit, STANDARD_GRAVITY**2)
    return figure


@run_figure("third_octaves")
def plot_third_octaves(
    run: Run,
    *,
    of: str = "absolute_acceleration",
    point: str | None = None,
    resolution: float | None = None,
    size: Size = "column",
    between: tuple[float, float] | None = None,
) -> Figure:
    """Draw the RMS value of a response in each third-octave band.

    Parameters
    ----------
    run
        Run with evenly spaced output times, `rb.Output(rate=...)`.
    of
        Variable of the motion or drift, as in `plot_responses`.
    point
        Point of the structure; default all, of many those with the largest RMS value.
    resolution
        Spacing of the frequencies of the power spectral density [Hz]; a band needs four of them.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to evaluate [s]; default the whole run.

    Returns
    -------
    Figure
        Figure with one panel, and a second axis in g for accelerations. The legend has the largest band, and the share of
        the mean square below the lowest band, for which the run is too short, above 5 %.

    Raises
    ------
    CaseError
        As `plot_psd`, and if no band has four frequencies.

    Notes
    -----
    `rattlebox.analysis.band_levels` of the density of `plot_psd`.
    """
    signals = _Signals.of(run, of, point, between)
    densities = list(signals.densities(resolution))
    try:
        levels = [band_levels(density) for density in densities]
    except ValueError as error:
        raise CaseError(str(error), "a longer run or a smaller resolution") from None
    with figure_style(size):
        figure = StyledFigure(size, 0.7)
        axes = figure.subplots()
        scale = scaled([level.max() for level in levels], signals.unit)
        for number, (line, density, level) in enumerate(zip(signals.lines, densities, levels, strict=True)):
            edges = np.append(level["lower"].values, level["upper"].values[-1])
            k = int(np.argmax(level.values))
            name = f"{signals.named(line, float(level[k]), '')} at {level['nominal'].values[k]} Hz"
            # Bands that a short run does not resolve are not drawn, but may hold nearly all of its motion.
            under = density.where(density.frequency < edges[0], 0.0).integrate("frequency") / density.integrate(
                "frequency"
            )
            if under > _UNDER:
                name += f" ({100 * float(under):.0f} % below)"
            axes.stairs(level / scale.divisor, edges, color=series_colour(number), lw=pen(0.9), label=name)
        axes.set_ylim(bottom=0)
        text = f"RMS of {signals.text[0].lower()}{signals.text[1:]} in third octaves"
        signals.finish(axes, text, scale.unit, STANDARD_GRAVITY)
    return figure


@run_figure("shock_spectrum")
def plot_shock_spectrum(
    run: Run,
    *,
    point: str | None = None,
    damping_ratio: float = 0.05,
    size: Size = "column",
    between: tuple[float, float] | None = None,
) -> Figure:
    """Draw the shock response spectrum of the absolute acceleration of points and of the base.

    Parameters
    ----------
    run
        Run with evenly spaced output times, `rb.Output(rate=...)`.
    point
        Point of the structure; default all, of many those with the largest RMS value.
    damping_ratio
        Damping ratio of the oscillators; 0.05 is a quality factor of 10.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to evaluate [s]; default the whole run.

    Returns
    -------
    Figure
        Figure with one panel: the largest absolute acceleration over the natural frequency, and a second axis in g.

    Raises
    ------
    CaseError
        If the run has no such point, its output times are not even, or the damping ratio is out of range.

    Notes
    -----
    `rattlebox.analysis.shock_response_spectrum` (maximax) of differences of the velocity over the output step, up to a tenth
    of the output rate.
    """
    signals = _Signals.of(run, "absolute_acceleration", point, between)
    try:
        spectra = [
            shock_response_spectrum(line.time, line.values, damping_ratio=damping_ratio).maximax
            for line in signals.lines
        ]
    except ValueError as error:
        raise CaseError(str(error), "output = rb.Output(rate=...) for even times") from None
    with figure_style(size):
        figure = StyledFigure(size, 0.7)
        axes = figure.subplots()
        for number, (line, spectrum) in enumerate(zip(signals.lines, spectra, strict=True)):
            draw_line(
                axes,
                spectrum.frequency.values,
                spectrum.values,
                number,
                signals.named(line, float(spectrum.max()), "largest"),
            )
        axes.set_yscale("log")
        log_ticks(axes.yaxis)
        signals.finish(axes, "Largest absolute acceleration", "m/s^2", STANDARD_GRAVITY)
        label(axes, "x", f"Natural frequency, {100 * damping_ratio:g} % damping", "Hz")
    return figure
