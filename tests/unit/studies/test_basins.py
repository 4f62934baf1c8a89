"""Basins of attraction: attractors of starts, refused arguments, figures."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.paths import replaced

EXAMPLE = Path(__file__).parents[3] / "examples" / "basins.py"
QUIET = {"progress": False}
STARTS = {"damper.start": np.linspace(-0.96, 0.96, 9), "damper.velocity": np.linspace(-0.2, 0.2, 9)}


def shaken(amplitude=1e-3, phase=0.0, restitution=0.6, **damper):
    """Return a ball in a shaken cavity."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{amplitude!r} m", frequency="10 Hz", phase=phase)),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            contact=rb.Tsuji(restitution=restitution),
            **damper,
        ),
        duration="1 s",
        method=rb.Newton(),
    )


def test_mirrored_starts_lead_to_mirrored_motions():
    """Mirrored starts with a phase shift of half a cycle lead to the mirrored motions."""
    maps = rb.basins(shaken(), STARTS, cycles=(200, 16), **QUIET)
    twins = rb.basins(shaken(phase=np.pi), STARTS, cycles=(200, 16), **QUIET)
    assert (maps.attractor > 0).all()
    assert sorted(np.round(maps.orbit_impacts_per_cycle.values).tolist()) == [2, 2, 3, 3]
    np.testing.assert_array_equal(maps.attractor, twins.attractor[::-1, ::-1])
    np.testing.assert_allclose(maps.orbit_relative_velocity, -twins.orbit_relative_velocity, atol=1e-6)
    assert float(maps.share.sum()) == pytest.approx(1)


def test_runs_end_on_their_attractor():
    """Single runs from some starts end at a strobe of the attractor in the map."""
    maps = rb.basins(shaken(), STARTS, cycles=(200, 16), **QUIET)
    for i, j in [(0, 0), (2, 7), (4, 4), (8, 1), (8, 8)]:
        damper = shaken(start=float(STARTS["damper.start"][i]), velocity=float(STARTS["damper.velocity"][j]))
        run = rb.simulate(damper.model_copy(update={"duration": 21.6}))
        orbit = maps.sel(orbit=int(maps.attractor[i, j]))
        assert run.arrays.relative_velocity[-1, 0] == pytest.approx(
            float(orbit.orbit_relative_velocity[0, 0]), abs=1e-5
        )


def test_chaos_has_no_attractor():
    """Motions that do not repeat have the number 0 and no share."""
    maps = rb.basins(shaken(2.1e-3), STARTS, cycles=(100, 16), **QUIET)
    assert (maps.attractor == 0).all()
    assert (maps.period == 0).all()
    assert maps.sizes["orbit"] == 0
    figure = rb.plot_basins(maps)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["no period found, 100 %"]


def test_motions_without_impacts_are_one_attractor():
    """Without impacts the position of the ball does not matter: there is one attractor."""
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.05),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="0.1 N", frequency="8 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    maps = rb.basins(case, {"damper.start": np.linspace(-0.9, 0.9, 7)}, cycles=(100, 8), **QUIET)
    assert maps.attractor.values.tolist() == [1] * 7
    assert maps.orbit_impacts_per_cycle.values.tolist() == [0]
    with pytest.raises(rb.CaseError, match="two axes"):
        rb.plot_basins(maps)


def test_unfinished_runs_have_their_own_number():
    """A start with an unfinished run has the number -1."""
    contact = rb.Tsuji(restitution=rb.JacksonGreen(yield_stress="100 MPa"))
    case = replaced(shaken(1e-4), {"damper.contact": contact, "method": rb.EventDriven()})
    maps = rb.basins(case, {"damper.velocity": [0.01, 5.0]}, cycles=(3, 4), **QUIET)
    assert maps.status.values.tolist() == [0, 1]
    assert maps.attractor.values[1] == -1


@pytest.mark.parametrize(
    ("starts", "options", "message"),
    [
        ({"damper.begin": [0.0]}, {}, "there is no 'begin'"),
        (STARTS, {"tolerance": 2}, "tolerance = 2"),
        (STARTS, {"apart": 0}, "apart = 0"),
        (STARTS, {"cycles": (10, 1)}, "to evaluate, >= 2"),
        ({"damper.start": [0.0, 1.5]}, {}, "damper.start"),
    ],
)
def test_bad_arguments_are_refused(starts, options, message):
    """Bad arguments are refused before the first run."""
    with pytest.raises(rb.CaseError, match=message):
        rb.basins(shaken(), starts, **{"cycles": (3, 4), **options})


def test_a_case_without_damper_is_refused():
    """A case without a damper is refused."""
    structure = rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.01)
    bare = rb.Case(structure=structure, load=rb.Harmonic(amplitude="1 N", frequency="10 Hz"), duration="1 s")
    with pytest.raises(rb.CaseError, match="the case has no damper"):
        rb.basins(bare, {"structure.displacement": [0.0, 1e-3]})


def test_example(tmp_path, monkeypatch):
    """The example has four attractors, two mirrored pairs, and each strobe is in its own basin."""
    monkeypatch.chdir(tmp_path)
    maps = runpy.run_path(str(EXAMPLE))["maps"]
    assert maps.orbit_impacts_per_cycle.values == pytest.approx([2, 2, 3, 3], abs=0.1)
    assert maps.share.values == pytest.approx([0.34, 0.32, 0.22, 0.13], abs=0.02)
    for orbit in maps.orbit.values:
        one = maps.sel(orbit=orbit)
        start, velocity = float(one.orbit_relative_position[0, 0]) / 1e-3, float(one.orbit_relative_velocity[0, 0])
        near = maps.attractor.sel({"damper.start": start, "damper.velocity": velocity}, method="nearest")
        assert int(near) == orbit
    figure = rb.plot_basins(maps, size="page")
    figure.draw_without_rendering()
    assert len(figure.axes[0].lines) == 4
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert box.x0 > -0.01 and box.y0 > -0.01 and box.x1 < width + 0.01 and box.y1 < height + 0.01
    assert (tmp_path / "basins.png").stat().st_size > 5000
