"""Stability of cutting: dampers away from the tip, amplitudes, coverage of the map, study files, refused arguments."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import rattlebox as rb

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
KS = "2200 N/mm^2"
TOOL = rb.SDOF(mass="2.5 kg", frequency="130 Hz", damping_ratio=0.02)


def made_map(mass: Any, ends: tuple[float, float] = (1e-7, 1e-2), hertz: Any = (60.0, 400.0)) -> xarray.Dataset:
    """Return a map with the masses of a function of the amplitude."""
    amplitudes = np.geomspace(*ends, 41)
    values = np.array([[complex(mass(a))] * len(hertz) for a in amplitudes])
    axes = (AMPLITUDE, FREQUENCY)
    return xarray.Dataset(
        {"effective_mass": (axes, values.real), "damping_mass": (axes, -values.imag)},
        {AMPLITUDE: (AMPLITUDE, amplitudes, {"units": "m"}), FREQUENCY: (FREQUENCY, list(hertz), {"units": "Hz"})},
    )


def rising(amplitude: float) -> complex:
    """Return an apparent mass whose damping rises with the amplitude, and falls above 0.1 mm."""
    ratio = amplitude / 1e-4
    return 0.02 - 0.05j * 2 * ratio / (1 + ratio**2)


def chain() -> rb.Matrices:
    """Return two masses; the tool cuts with the second one."""
    return rb.Matrices(
        M=[[2.0, 0], [0, 1.2]],
        C=[[60.0, -20], [-20, 20]],
        K=[[2.6e6, -9e5], [-9e5, 9e5]],
        points={"shank": 0, "tip": 1},
    )


@pytest.mark.parametrize(("at", "number"), [("tip", 1), ("shank", 2), (("shank", "tip"), 1)])
def test_constant_masses_have_the_limit_of_the_matrices(at: Any, number: int) -> None:
    """With dampers of constant apparent mass the limit is that of the matrices with these masses, at any amplitude."""
    mass = 0.06 - 0.04j
    found = rb.stability_lobes(
        chain(), made_map(lambda _: mass), KS, 0.9, at=at, number=number, point="tip", amplitudes=["2 um", "0.3 mm"]
    )
    structure = chain()
    m, c, k = (np.array(each, complex) for each in structure.matrices())
    for name in (at,) if isinstance(at, str) else at:
        place = structure.points[name]
        m[place, place] += number * mass
    omega = 2 * np.pi * np.linspace(60, 400, 400_001)
    dynamic = k - omega[:, None, None] ** 2 * m + 1j * omega[:, None, None] * c
    response = 0.9 * np.linalg.inv(dynamic)[:, 1, 1]
    exact = -0.5 / (2.2e9 * response.real.min())
    np.testing.assert_allclose(found.limit, exact, rtol=2e-8)
    assert float(found.interpolation_error.max()) < 1e-6
    assert float(found.minimum_real_part[0]) == pytest.approx(response.real.min(), rel=2e-8)


def test_limit_at_each_amplitude_is_that_of_the_mass_there() -> None:
    """A damper at the tip has at each amplitude the limit of its apparent mass, and the words name the best amplitude."""
    sizes = [1e-6, 1e-5, 1e-4, 1e-3]
    found = rb.stability_lobes(TOOL, made_map(rising), KS, amplitudes=sizes, speeds=["2000 rpm", "3000 rpm"])
    omega = 2 * np.pi * np.linspace(100, 200, 1_000_001)
    for size, limit in zip(sizes, found.limit.values, strict=True):
        dynamic = 2.5 * ((2 * np.pi * 130) ** 2 + 0.04j * 2 * np.pi * 130 * omega) - omega**2 * (2.5 + rising(size))
        assert limit == pytest.approx(-0.5 / (2.2e9 * (1 / dynamic).real.min()), rel=1e-4)
    words = found.attrs["answer"].splitlines()
    assert words[1].startswith("With the dampers chatter is contained at 0.1 mm up to 47.1 µm depth of cut")
    assert "at 1 µm up to" in words[1] and "at 1 mm up to" in words[1]
    assert words[2].startswith("The limit falls above 0.1 mm")
    assert words[3].startswith("The deepest stable cut at the given speeds is")


def test_accelerations_of_a_map_are_those_of_the_tip() -> None:
    """A map over accelerations gives the limit of the map over displacements."""
    hertz = np.geomspace(100.0, 300.0, 81)
    place = made_map(rising, hertz=hertz)
    accelerations = np.geomspace(0.1, 1e5, 121)
    values = np.array([[rising(a / (2 * np.pi * f) ** 2) for f in hertz] for a in accelerations])
    axes = (AMPLITUDE, FREQUENCY)
    shaken = xarray.Dataset(
        {"effective_mass": (axes, values.real), "damping_mass": (axes, -values.imag)},
        {AMPLITUDE: (AMPLITUDE, accelerations, {"units": "m/s^2"}), FREQUENCY: (FREQUENCY, hertz, {"units": "Hz"})},
    )
    one, other = (
        rb.stability_lobes(TOOL, each, KS, 0.7, ["2100 rpm"], amplitudes=["20 um", "0.2 mm"])
        for each in (place, shaken)
    )
    np.testing.assert_allclose(other.limit, one.limit, rtol=2e-3)
    np.testing.assert_allclose(other.depth, one.depth, rtol=5e-3)


def test_what_the_map_does_not_cover_is_unknown() -> None:
    """Where a smaller depth may lie outside of the map, limits are NaN and a warning says so; a map elsewhere is refused."""
    narrow = made_map(lambda _: 0.05 - 0.3j, hertz=(125.0, 138.0))
    with pytest.raises(rb.CaseError, match="do not contain the chatter of this tool"):
        rb.stability_lobes(TOOL, narrow, KS, amplitudes=["10 um"])
    with pytest.raises(rb.CaseError, match="map around 132"):
        rb.stability_lobes(TOOL, made_map(rising, hertz=(300.0, 400.0)), KS, amplitudes=["10 um"])
    part = rb.stability_lobes(TOOL, made_map(rising, (1e-5, 1e-3)), KS, amplitudes=["1 um", "0.1 mm", "2 mm"])
    assert np.isnan(part.limit).values.tolist() == [True, False, True]
    assert "at 2 of 3 amplitudes a smaller depth may lie outside" in part.attrs["warnings"]
    fast = rb.stability_lobes(TOOL, made_map(rising, hertz=(110.0, 170.0)), KS, speeds=["2500 rpm", "60000 rpm"])
    assert np.isfinite(fast.depth[:, 0]).all() and np.isnan(fast.depth[:, 1]).all()
    assert (fast.waves[:, 1] == -1).all() and np.isfinite(fast.bare_depth).all()
    assert "compute a map with more frequencies" in fast.attrs["warnings"]


def test_interval_of_the_map() -> None:
    """The interval of the limit is the change with the map shifted by its own intervals."""
    table = made_map(lambda _: 0.02 - 0.05j)
    half = np.full(table.effective_mass.shape, 0.004)
    axes = table.effective_mass.dims
    table = table.assign(effective_mass_interval=(axes, 0 * half), damping_mass_interval=(axes, half))
    found = rb.stability_lobes(TOOL, table, KS, amplitudes=["50 um"])
    more = rb.stability_lobes(TOOL, made_map(lambda _: 0.02 - 0.054j), KS, amplitudes=["50 um"])
    assert float(found.limit_interval[0]) == pytest.approx(float(more.limit[0] - found.limit[0]), rel=1e-2)


def test_points_in_3d_have_a_direction() -> None:
    """A tool that moves in 3-D cuts along a direction."""
    shape = [[0.5, 0.0, 0.2], [0.0, 0.4, 0.1]]
    tool = rb.Modal(frequencies=[120.0, 160.0], damping_ratio=0.02, shapes={"tip": shape})
    found = rb.stability_lobes(tool, None, KS, direction="y")
    omega2 = (2 * np.pi * 160) ** 2
    assert float(found.limit[0]) == pytest.approx(2 * omega2 / 0.16 * 0.02 * 1.02 / 2.2e9, rel=1e-9)
    with pytest.raises(rb.CaseError, match="needs a direction"):
        rb.stability_lobes(tool, None, KS)


def ball(**fields: Any) -> rb.ImpactDamper:
    """Return a steel ball of 14 g."""
    contact = rb.Tsuji(restitution=0.6)
    sphere = rb.Sphere(diameter="15 mm", material="steel")
    return rb.ImpactDamper(ball=sphere, gap="0.1 mm", velocity="0.1 m/s", contact=contact, **fields)


def test_map_of_a_damper_is_computed() -> None:
    """A damper, alone or in the case, gives the limit of its map."""
    sizes = ["0.1 mm", "0.3 mm"]
    options: dict[str, Any] = {"amplitudes": sizes, "frequencies": ["110 Hz", "200 Hz"], "progress": False}
    case = rb.Case(structure=TOOL, damper=ball(number=2), method=rb.Newton(), duration="1 s")
    found = rb.stability_lobes(case, None, KS, **options)
    shaken = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="0.1 mm", frequency="130 Hz")),
        damper=ball(),
        method=rb.Newton(),
        duration="1 s",
    )
    ends = 1e-4 / 1.25, 3e-4 * 1.25
    table = rb.loss_map(shaken, np.geomspace(*ends, 24).tolist(), ["110 Hz", "200 Hz"], progress=False)
    np.testing.assert_allclose(
        found.limit, rb.stability_lobes(TOOL, table, KS, amplitudes=sizes, number=2).limit, rtol=1e-9
    )
    alone = rb.stability_lobes(
        rb.Case(structure=TOOL, method=rb.Newton(), duration="1 s"), ball(), KS, number=2, **options
    )
    np.testing.assert_allclose(alone.limit, found.limit, rtol=1e-9)
    assert (found.limit > found.bare_limit).all()


def test_study_file(tmp_path: Path) -> None:
    """A study file gives the result of the function, with a map next to it."""
    made_map(rising).to_netcdf(tmp_path / "map.nc")
    (tmp_path / "study.toml").write_text(
        'kind = "stability_lobes"\ndamper = "map.nc"\ncutting_coefficient = "2200 N/mm^2"\ndirectional_factor = 0.7\n'
        'teeth = 2\nspeeds = { from = "1000 rpm", to = "3000 rpm", count = 5 }\namplitudes = ["10 um", "0.1 mm"]\n'
        '[case]\nduration = "1 s"\n[case.structure]\nkind = "sdof"\nmass = "2.5 kg"\n'
        'frequency = "130 Hz"\ndamping_ratio = 0.02\n'
    )
    from rattlebox.studies.study_file import read_study

    study = read_study(tmp_path / "study.toml")
    found = study.run(store=tmp_path / "lobes.zarr")
    exact = rb.stability_lobes(
        TOOL, made_map(rising), KS, 0.7, rb.linspace("1000 rpm", "3000 rpm", 5), teeth=2, amplitudes=["10 um", "0.1 mm"]
    )
    assert found.drop_attrs().identical(exact.drop_attrs())
    assert rb.open_study(tmp_path / "lobes.zarr").load().equals(found)
    with pytest.raises(rb.StoreError, match="holds another study"):
        rb.stability_lobes(TOOL, None, KS, store=tmp_path / "lobes.zarr")


FREE = rb.Matrices(
    M=[[2, 0], [0, 3]], K=[[4e5, -4e5], [-4e5, 4e5]], C=[[20, -20], [-20, 20]], points={"tip": 0, "end": 1}
)
REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"cutting_coefficient": None}, "a cutting coefficient is needed"),
    ({"cutting_coefficient": ("2200", "Pa")}, '"2200 N/mm^2"'),
    ({"cutting_coefficient": "2200 N"}, "cutting_coefficient = '2200 N': a force over an area is needed"),
    ({"cutting_coefficient": "2200 N/mm"}, 'cutting_coefficient = "2000 N/mm^2"'),
    ({"directional_factor": 0}, "does not feel the force"),
    ({"speeds": [1000, 2000]}, "rpm and rad/s differ by 9.55"),
    ({"speeds": ["2000 rpm", "1000 rpm"]}, "rising"),
    ({"speeds": ["20 N"]}, "angular velocity"),
    ({"speeds": ["20 1/s"]}, '"20 rad/s" or "20 Hz"'),
    ({"speeds": ["1e-6 rpm", "1000 rpm"]}, "is the limit of all speeds"),  # took all memory
    ({"case": FREE, "point": "tip"}, "moves freely, in a mode without stiffness"),  # a limit of picometres
    ({"teeth_in_cut": 1.5}, "more than the number of teeth"),
    ({"amplitudes": ["1 um"]}, "has no amplitude"),
    ({"damper": ball()}, "none are given"),
    ({"damper": "nothing.nc"}, "does not exist"),
    ({"point": "tool"}, "no point 'tool'"),
    ({"case": rb.SDOF(mass="1 kg", frequency="50 Hz")}, "has no damping"),
    ({"case": rb.Fixed()}, "has no modes"),
    ({"case": rb.Case(structure=TOOL, damper=ball(), duration="1 s"), "damper": ball()}, "another one is given"),
]


@pytest.mark.parametrize(("change", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_refused_arguments(change: dict[str, Any], words: str) -> None:
    """Arguments that are not valid are refused before anything is computed."""
    with pytest.raises(rb.RattleboxError, match=re.escape(words)):
        rb.stability_lobes(**({"case": TOOL, "cutting_coefficient": KS} | change))


def test_measures_of_a_frequency_response() -> None:
    """A stepped sine of a linear tool has the smallest real part and the dynamic stiffness of the formula."""
    case = rb.Case(structure=TOOL, load=rb.Harmonic(amplitude="10 N", frequency="130 Hz"), duration="1 s")
    found = rb.frequency_response(
        case, rb.linspace("124 Hz", "138 Hz", 57), cycles=(400, 8), direction="up", progress=False
    )
    stiffness = 2.5 * (2 * np.pi * 130) ** 2
    assert found.minimum_real_part.item() == pytest.approx(-1 / (4 * stiffness * 0.02 * 1.02), rel=1e-3)
    assert found.dynamic_stiffness.item() == pytest.approx(2 * stiffness * 0.02, rel=2e-3)


def hard_ball(**fields: Any) -> rb.ImpactDamper:
    """Return a ball of tungsten carbide in a narrow gap."""
    parts: dict[str, Any] = {
        "ball": rb.Sphere(diameter="22 mm", material="tungsten_carbide"),
        "gap": "20 um",
        "velocity": "15 mm/s",
        "contact": rb.Tsuji(restitution=0.6),
    }
    return rb.ImpactDamper(**(parts | fields))


def test_a_damper_in_a_tuned_mass_is_given_in_three_ways() -> None:
    """A list of both, a case with both, and a case with the tuned mass and the damper are the same tool.

    Tests had one kind of damper at a time, and a list of a tuned mass and a damper was called no loss map.
    """
    tuned = rb.TunedMass.den_hartog(TOOL, mass="0.2 kg")
    inside = hard_ball(point="tuned mass")
    case = rb.Case(structure=TOOL, tuned_mass=tuned, duration="1 s")
    options: dict[str, Any] = {"cutting_coefficient": KS, "amplitudes": ["20 um", "50 um"], "cycles": (8, 8)}
    both = rb.stability_lobes(TOOL, [tuned, inside], **options)
    in_case = rb.stability_lobes(case.replaced({"damper": inside}), **options)
    beside = rb.stability_lobes(case, inside, **options)
    assert both.limit.notnull().all()
    np.testing.assert_allclose(both.limit, in_case.limit, rtol=1e-9)
    np.testing.assert_allclose(both.limit, beside.limit, rtol=1e-9)
    without = rb.stability_lobes(TOOL, tuned, KS).limit.values.ravel()[0]
    assert abs(both.limit.values[0] / without - 1) > 0.01
    mapped = made_map(lambda _: 0.03 - 0.01j)
    np.testing.assert_allclose(
        rb.stability_lobes(TOOL, [tuned, mapped], KS, at="tuned mass", amplitudes=["20 um", "50 um"]).limit,
        rb.stability_lobes(case, mapped, KS, at="tuned mass", amplitudes=["20 um", "50 um"]).limit,
        rtol=1e-9,
    )


def test_advice_for_dampers_is_followed() -> None:
    """A damper at a point that the tool lacks, and a damper beside that of the case, are refused with advice that works."""
    options: dict[str, Any] = {"cutting_coefficient": KS, "amplitudes": ["20 um", "50 um"], "cycles": (8, 8)}
    inside = hard_ball(point="tuned mass")
    with pytest.raises(rb.CaseError, match="the damper is at 'tuned mass', and the tool has no point") as caught:
        rb.stability_lobes(TOOL, inside, **options)
    assert (
        caught.value.suggestion == 'at = "mass", or damper = [rb.TunedMass(...), damper] for a damper in a tuned mass'
    )
    assert rb.stability_lobes(TOOL, inside, at="mass", **options).limit.notnull().all()
    case = rb.Case(structure=TOOL, damper=hard_ball(), duration="1 s")
    with pytest.raises(rb.CaseError, match="another one is given") as caught:
        rb.stability_lobes(case, hard_ball(), **options)
    assert caught.value.suggestion == "case.without_dampers(), or no damper beside the case"
    for damper in ((case.without_dampers(), hard_ball()), (case,)):
        assert rb.stability_lobes(*damper, **options).limit.notnull().all()
    with pytest.raises(rb.CaseError, match="damper lists several dampers"):
        rb.stability_lobes(TOOL, [hard_ball(), hard_ball()], **options)
    assert rb.stability_lobes(TOOL, hard_ball(), number=2, **options).limit.notnull().all()
