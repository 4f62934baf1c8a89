"""Bifurcation diagrams: directions, strobes, impacts, refused arguments, figures."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.reductions import Motion
from rattlebox.studies.work.variants import Variants, order_along
from rattlebox.studies.work.work import Work

EXAMPLE = Path(__file__).parents[3] / "examples" / "bifurcation.py"
AMPLITUDE = "structure.motion.amplitude"
QUIET = {"progress": False}


def shaken(*, method=None, **damper):
    """Return a ball in a shaken cavity."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz", phase=0.3)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            velocity=0.1,
            contact=rb.Tsuji(restitution=0.6),
            **damper,
        ),
        duration="1 s",
        method=method or rb.Newton(),
    )


def test_both_goes_up_and_then_back_down():
    """The way down begins with the last state of the way up; both are sorted by the parameter."""
    values = np.linspace(0.5e-3, 1.5e-3, 5)
    options = {"cycles": (20, 8), "show": "impacts", **QUIET}
    both = rb.bifurcation(shaken(), AMPLITUDE, values, **options)
    assert both.direction.values.tolist() == ["up", "down"]
    assert both.relative_position.dims == ("direction", AMPLITUDE, "cycle", "ball")
    assert both.relative_position.shape == (2, 5, 8, 1)
    np.testing.assert_array_equal(both[AMPLITUDE], values)
    up = rb.bifurcation(shaken(), AMPLITUDE, values, direction="up", **options)
    for name in up.data_vars:
        np.testing.assert_array_equal(up[name][0], both[name][0])
    there_and_back = np.concatenate([values, values[::-1]])
    grid, order = order_along(read_axes(shaken(), {AMPLITUDE: there_and_back}), "up")
    variants = Variants(shaken(), grid, cycles=(20, 8), samples=9)
    chain = run_work(Work(ImpactEngine(variants, motion=True, state=True), order), **QUIET)
    np.testing.assert_array_equal(both.relative_position[1], chain.relative_position.values[0, :4:-1, 1:])


def test_directions_differ_where_motions_coexist():
    """Where motions with two and three impacts coexist, each direction follows its own."""
    values = np.linspace(0.9e-3, 1.3e-3, 21)
    maps = rb.bifurcation(shaken(), AMPLITUDE, values, cycles=(200, 16), **QUIET)
    near = maps.sel({AMPLITUDE: 1.0e-3}, method="nearest")
    assert near.impacts_per_cycle.values == pytest.approx([2, 3], abs=0.1)


def test_strobes_and_impacts_are_those_of_a_run():
    """Strobes, phases and speeds of impacts agree with a run of the same case."""
    case = shaken(method=rb.EventDriven())
    maps = rb.bifurcation(case, AMPLITUDE, [1.5e-3], cycles=(3, 4), show="impacts", direction="fresh", **QUIET)
    maps = maps.isel({"direction": 0, AMPLITUDE: 0})
    motion = rb.Harmonic(amplitude="1.5 mm", frequency="10 Hz", phase=0.3)
    times = np.linspace(0.4, 0.7, 4)
    run = rb.simulate(
        case.model_copy(
            update={"structure": rb.Shaker(motion=motion), "duration": 0.7, "output": rb.Output(times=list(times))}
        )
    )
    np.testing.assert_allclose(maps.relative_velocity[:, 0], run.arrays.relative_velocity[1:, 0], rtol=1e-8)
    late = run.arrays.impacts.time >= 0.3
    phases = maps.impact_phase.dropna("impact")
    phase = (2 * np.pi * 10 * run.arrays.impacts.time[late] + 0.3) % (2 * np.pi)
    np.testing.assert_allclose(phases, phase, rtol=1e-8)
    np.testing.assert_allclose(maps.approach_speed.dropna("impact"), run.arrays.impacts.approach_speed[late], rtol=1e-8)


def test_names_can_vary_without_continuation():
    """With direction 'fresh', values without order, here materials, are allowed, with linked parameters."""
    paths = ("damper.ball.material", "damper.gap")
    maps = rb.bifurcation(
        shaken(), paths, (["steel", "brass"], ["1 mm", "2 mm"]), cycles=(5, 4), direction="fresh", **QUIET
    )
    assert maps.period.dims == ("direction", "damper.ball.material")
    assert maps["damper.gap"].values.tolist() == [1e-3, 2e-3]


@pytest.mark.parametrize(
    ("path", "values", "options", "message"),
    [
        (AMPLITUDE, [1e-3, 1e-3], {}, "strictly rising"),
        (AMPLITUDE, [2e-3, 1e-3], {}, "strictly rising"),
        ("damper.ball.material", ["steel", "brass"], {}, "are not numbers and have no order"),
        (AMPLITUDE, [1e-3], {"show": "strobes"}, "show = 'strobes'"),
        (AMPLITUDE, [1e-3], {"direction": "left"}, "direction = 'left'"),
        (AMPLITUDE, [1e-3], {"cycles": (5, 1)}, "to evaluate, >= 2"),
        (AMPLITUDE, [1e-3], {"workers": 0}, "workers = 0"),
        (AMPLITUDE, [1e-3], {"tolerance": 0}, "tolerance = 0"),
        (AMPLITUDE, [1e-3], {"apart": 2}, "apart = 2"),
    ],
)
def test_bad_arguments_are_refused(path, values, options, message):
    """Bad arguments are refused before the first run."""
    with pytest.raises(rb.CaseError, match=message):
        rb.bifurcation(shaken(), path, values, **{"cycles": (3, 2), **options})


def test_cases_without_damper_or_cycle_are_refused():
    """A case without a damper or without a harmonic load is refused."""
    structure = rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.01)
    bare = rb.Case(structure=structure, load=rb.Harmonic(amplitude="1 N", frequency="10 Hz"), duration="1 s")
    with pytest.raises(rb.CaseError, match="the case has no damper"):
        rb.bifurcation(bare, "load.amplitude", [1.0, 2.0])
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    )
    free = rb.Case(structure=structure, damper=damper, duration="1 s")
    with pytest.raises(rb.CaseError, match="cycles require a harmonic load"):
        rb.bifurcation(free, "damper.gap", [1e-3, 2e-3])


@pytest.mark.parametrize("size", ["column", "page"])
@pytest.mark.parametrize(
    "of", [None, "relative_position", "relative_velocity", "displacement", "velocity", "impact_phase"]
)
def test_every_quantity_is_drawn(of, size):
    """Each quantity is drawn with dots for both directions, and the figure fits on the paper."""
    maps = rb.bifurcation(shaken(), AMPLITUDE, [0.5e-3, 1e-3, 1.5e-3], cycles=(20, 8), show="impacts", **QUIET)
    figure = rb.plot_bifurcation(maps, of, size=size)
    figure.draw_without_rendering()
    upper, lower = figure.axes
    assert lower.get_xlabel() == "Structure motion amplitude (mm)"
    down, up = (line.get_ydata() for line in upper.lines)
    values = maps["approach_speed" if of is None else of]
    assert up.size == down.size == values.isel(direction=0).size
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01


@pytest.mark.parametrize("of", ["impacts_per_cycle", "loss_per_cycle", "multiplier"])
def test_every_measure_is_drawn(of):
    """Measures over the parameter are drawn with one dot for each value; only quantities over cycles were accepted."""
    maps = rb.bifurcation(
        shaken(), AMPLITUDE, [0.5e-3, 1e-3, 1.5e-3], cycles=(20, 8), measure="loss_per_cycle", **QUIET
    )
    figure = rb.plot_bifurcation(maps, of)
    figure.draw_without_rendering()
    down, up = (line.get_ydata() for line in figure.axes[0].lines)
    assert down.shape == up.shape == (3,)
    assert figure.axes[0].get_ylabel().startswith(maps[of].attrs["long_name"].capitalize()[:6])
    with pytest.raises(rb.CaseError, match="no such quantity"):
        rb.plot_bifurcation(maps, "period")


def test_transient_motions_are_drawn_as_such():
    """The strip of periods names motions that still contract, and the note of the dataset counts them."""
    maps = rb.bifurcation(shaken(), AMPLITUDE, [0.2e-3, 0.25e-3, 0.3e-3], cycles=(8, 12), direction="fresh", **QUIET)
    assert (maps.motion == Motion.TRANSIENT).any() and "come closer" in maps.attrs["unsettled"]
    assert (maps.period.values[maps.motion.values == Motion.TRANSIENT] == 0).all()
    figure = rb.plot_bifurcation(maps)
    assert "transient" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_unknown_quantity_is_refused():
    """Drawing a quantity or a ball that the diagram lacks is refused."""
    maps = rb.bifurcation(shaken(), AMPLITUDE, [1e-3], cycles=(3, 2), **QUIET)
    with pytest.raises(rb.CaseError, match="no such quantity"):
        rb.plot_bifurcation(maps, "approach_speed")
    with pytest.raises(rb.CaseError, match="ball = 1"):
        rb.plot_bifurcation(maps, "relative_position", ball=1)


def test_example(tmp_path, monkeypatch):
    """The least amplitude with two impacts per cycle in the example agrees with theory."""
    monkeypatch.chdir(tmp_path)
    maps = runpy.run_path(str(EXAMPLE))["maps"]
    down = maps.sel(direction="down")
    two = down[AMPLITUDE].where((down.period == 1) & np.isclose(down.impacts_per_cycle, 2))
    rho = 2 / np.pi * (1 - 0.6) / (1 + 0.6)
    assert float(two.min()) == pytest.approx(1e-3 * rho / np.sqrt(1 + rho**2), abs=15e-6)
    assert (tmp_path / "bifurcation.png").stat().st_size > 5000
