"""Tests of the figures of frequency responses and Lyapunov exponents."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb

import rattlebox as rb
from rattlebox.plots.lyapunov import _colours
from rattlebox.plots.style import FAINT, WIDTHS

from .conftest import is_within_page


def response(directions=("up", "down")):
    """Return a response at two levels, with coexisting motions at the second one and irregular last motions."""
    frequency = np.linspace(20.0, 30.0, 11)
    amplitude = np.ones((2, 2, 11)) * [[[1e-3], [2e-3]]]
    amplitude[1, 1, :4] = 5e-3
    period = np.ones((2, 2, 11), int)
    period[:, :, -1] = 0
    over = ("direction", "level", "frequency")

    def variable(values, units, name):
        return over, values[: len(directions)], {"units": units, "long_name": name}

    return xr.Dataset(
        {
            "amplitude": variable(amplitude, "m", "amplitude of the first harmonic"),
            "phase": variable(np.full((2, 2, 11), -1.0), "rad", "phase to the load"),
            "impacts_per_cycle": variable(np.full((2, 2, 11), 2.0), "1", "impacts a cycle"),
            "period": variable(period, "1", "cycles after which the motion repeats"),
            "bare_amplitude": (over[1:], amplitude[0], {"units": "m", "long_name": "amplitude without dampers"}),
        },
        {
            "direction": list(directions),
            "level": ("level", [1.0, 2.0], {"units": "N"}),
            "frequency": ("frequency", frequency, {"units": "Hz"}),
        },
    )


def exponents(axes):
    """Return exponents of regular, neutral, chaotic and merging motions over 0, 1 or 2 axes."""
    values = np.array([-0.5, 0.001, 1.2, -np.inf])[: 4 if axes else 1]
    values = values[0] if axes == 0 else np.repeat(values[:, None], 3, axis=1) if axes == 2 else values
    running = np.multiply.outer(values, np.ones(50))
    dims = ("load.amplitude", "damper.material")[:axes]
    texts = {"units": "1", "long_name": "logarithmic growth in a cycle"}
    error = np.where(np.isinf(values), np.nan, 0.1)
    return xr.Dataset(
        {
            "exponent": (dims, 10 * values, {"units": "1/s", "long_name": "largest Lyapunov exponent"}),
            "standard_error": (dims, error, {"units": "1/s", "long_name": "standard error of the exponent"}),
            "growth_per_cycle": (dims, values, texts),
            "running_exponent": ((*dims, "cycle"), 10 * running, {"units": "1/s", "long_name": "so far"}),
        },
        {
            "cycle": ("cycle", np.arange(1.0, 51.0)),
            **({"load.amplitude": ("load.amplitude", np.arange(4.0), {"units": "N"})} if axes else {}),
            **({"damper.material": ("damper.material", ["steel", "lead", "brass"])} if axes == 2 else {}),
        },
    )


@pytest.mark.parametrize("size", WIDTHS)
@pytest.mark.parametrize("of", ["amplitude", ("amplitude", "phase", "impacts_per_cycle")])
def test_layout_of_responses(tmp_path, of, size):
    """Figures of every size, with one panel or three, are saved without a warning and fit on the page."""
    figure = rb.plot_frequency_response(response(), of, size=size, per_level=size == "page")
    figure.savefig(tmp_path / "figure.png")
    assert figure.get_figwidth() * 25.4 == pytest.approx(WIDTHS[size])
    assert is_within_page(figure)
    assert "Hz" in figure.axes[-1].get_xlabel()


def test_coexisting_motions_are_shaded():
    """The area between up and down is filled only where they differ; crosses mark irregular motions."""
    axes = rb.plot_frequency_response(response(), "amplitude").axes[0]
    filled = [path.vertices[:, 0] for part in axes.collections for path in part.get_paths() if len(path.vertices)]
    assert len(filled) == 1
    assert (filled[0].min(), filled[0].max()) == pytest.approx((20.0, 23.0))
    crosses = [line for line in axes.lines if line.get_marker() == "x"]
    assert all(np.flatnonzero(np.isfinite(line.get_ydata())).tolist() == [10] for line in crosses)
    alone = rb.plot_frequency_response(response(("fresh",)), "amplitude")
    assert not alone.axes[0].collections
    assert is_within_page(alone)


def test_response_over_level():
    """Curves of a linear structure coincide after division by the level."""
    axes = rb.plot_frequency_response(response(("up",)), "amplitude", per_level=True).axes[0]
    curves = [line.get_ydata() for line in axes.lines if line.get_linestyle() == "-" and line.get_color() != FAINT]
    assert curves[0] == pytest.approx(curves[1])
    assert "mm/N" in axes.get_ylabel()


def test_unknown_measure():
    """An unknown measure raises an error that lists the known ones."""
    with pytest.raises(rb.CaseError, match="amplitude"):
        rb.plot_frequency_response(response(), "amplitud")


def test_axis_of_names():
    """The ticks of an axis of names have these names."""
    axes = rb.plot_lyapunov(exponents(2)).axes[0]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["steel", "lead", "brass"]
    alone = rb.plot_lyapunov(exponents(2).isel({"load.amplitude": 0})).axes[0]
    assert [text.get_text() for text in alone.get_xticklabels()] == ["steel", "lead", "brass"]


@pytest.mark.parametrize("size", WIDTHS)
@pytest.mark.parametrize("axes", [0, 1, 2])
def test_layout_of_exponents(tmp_path, axes, size):
    """Figures over 0, 1 and 2 axes are saved without a warning and fit on the page, also with -inf."""
    figure = rb.plot_lyapunov(exponents(axes), size=size)
    figure.savefig(tmp_path / "figure.png")
    assert is_within_page(figure)
    assert figure.get_figwidth() * 25.4 == pytest.approx(WIDTHS[size])


def test_three_axes():
    """Three axes raise an error with a suggestion."""
    study = exponents(2).expand_dims(third=2)
    with pytest.raises(rb.CaseError, match="sel"):
        rb.plot_lyapunov(study)


def test_colours_in_grey():
    """A larger exponent has a lighter colour everywhere."""
    lightness = _colours()(np.linspace(0, 1, 200))[:, :3] @ [0.299, 0.587, 0.114]
    assert (np.diff(lightness) > 0).all()
    assert np.ptp(to_rgb(FAINT)) < 0.01


def test_amplitudes_name_their_point() -> None:
    """Figures of one case, a branch and a response, had amplitudes of different points and named neither.

    The structures of all tests of these figures had one point.
    """
    frame = rb.Matrices(
        M=[[2.0, 0.0], [0.0, 1.0]],
        K=[[80e3, -40e3], [-40e3, 40e3]],
        damping_ratio=0.01,
        points={"lower": 0, "upper": 1},
    )
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="16 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6), point="upper"
    )
    base = rb.Harmonic(amplitude="1.2 m/s^2", frequency="19 Hz")
    case = rb.Case(structure=frame, damper=ball, base=base, duration="8 s", method=rb.Newton())
    options = {"levels": ["1.2 m/s^2"], "direction": "fresh", "cycles": (20, 8), "progress": False}
    found = rb.frequency_response(case, ["19 Hz", "19.1 Hz"], **options)
    labels = [axes.get_ylabel().replace("\n", " ") for axes in rb.plot_frequency_response(found).axes[:2]]
    assert "first harmonic of upper (mm)" in labels[0] and "upper" not in labels[1]
    at_base = rb.plot_frequency_response(rb.frequency_response(case, ["19 Hz", "19.1 Hz"], point="lower", **options))
    assert "first harmonic of lower (mm)" in at_base.axes[0].get_ylabel().replace("\n", " ")
    branch = rb.continue_orbit(rb.find_orbit(case, period=1), "base.frequency", ("18.9 Hz", "19.1 Hz"), progress=False)
    for point, name in ((None, "lower"), ("upper", "upper")):
        figure = rb.plot_branches(branch, point=point, log=True)
        figure.canvas.draw()
        axes = figure.axes[0]
        assert axes.get_ylabel().replace("\n", " ") == f"Amplitude of {name} (mm)"
        assert "times" not in "".join(text.get_text() for text in axes.get_yticklabels(which="both"))
