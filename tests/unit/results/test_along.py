"""A script that reads the motion of a bare structure, of balls and of a bed needs no question about dimensions.

No earlier test could see the difference: each read the runs of one engine only.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb

SHAKEN: dict[str, Any] = {
    "structure": rb.SDOF(mass="2 kg", frequency="40 Hz", damping_ratio=0.02),
    "duration": "0.1 s",
    "output": rb.Output(rate="2 kHz"),
}
BALL = rb.ImpactDamper(
    ball=rb.Sphere(diameter="20 mm", material="steel"), gap="0.1 mm", contact=rb.Tsuji(restitution=0.6)
)


def bed(**changes: Any) -> rb.ParticleDamper:
    """Return a few balls in a box, which moves along z."""
    parts: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="6 mm", count=5),
        "cavity": rb.Box(size=("20 mm", "20 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.6),
        "packing": rb.Lattice(seed=1),
        "direction": "z",
        "softening": 50,
    }
    return rb.ParticleDamper(**(parts | changes))


def runs(direction: str | None = "z") -> dict[str, rb.Run]:
    """Return the run of a bare structure, of one with a ball, and of one with a bed."""
    base = rb.Harmonic(amplitude="8 m/s^2", frequency="38 Hz", **({"direction": direction} if direction else {}))
    dampers: dict[str, Any] = {"bare": {}, "ball": {"damper": BALL}, "bed": {"damper": bed()}}
    return {name: rb.simulate(rb.Case(**SHAKEN, base=base, **more)) for name, more in dampers.items()}


def test_variables_of_both_have_the_same_dimensions() -> None:
    """A variable that 1-D and 3-D runs share has the same dimensions in both, and z is an axis of each."""
    found = runs()
    for group in ("motion", "energy"):
        one, three = (getattr(found[name], group) for name in ("ball", "bed"))
        shared = set(one.data_vars) & set(three.data_vars)
        assert len(shared) > 9
        for name in shared:
            assert one[name].dims == three[name].dims, name
    for run in found.values():
        motion = run.motion.sel(axis="z")
        assert float(abs(motion.base_acceleration).max()) == pytest.approx(8.0, rel=1e-3)
        assert motion.interface_force.dims == ("time",)
    assert found["ball"].energy.normal_loss.sum("partner").dims == ("time", "damper")


@pytest.mark.parametrize("direction", ["z", None])
def test_one_script_for_all(direction: str | None) -> None:
    """`along` gives the same names and dimensions, and the numbers of a force balance, for each kind of run."""
    for name, run in runs(direction).items():
        for motion in (run.along(), run.along("z")):
            assert "axis" not in motion.dims, name
            force, pushed = motion.interface_force, motion.cavity_force.sum("damper")
            inertia = 2.0 * motion.absolute_acceleration.sel(point="mass")
            np.testing.assert_allclose(force, pushed - inertia, atol=1e-9 * float(abs(force).max() + abs(pushed).max()))


def test_points_in_space_are_one_point() -> None:
    """The three lines of a point that moves in 3-D are one point along a direction, also one between the axes."""
    modal = rb.Modal(
        frequencies=[30.0, 35.0, 42.0],
        damping_ratios=[0.01, 0.01, 0.01],
        shapes={"tip": [[0.7, 0.1, 0], [0, 0.8, 0], [0.1, 0, 0.6]]},
    )
    case = rb.Case(
        structure=modal,
        damper=bed(point="tip", softening=100),
        load=rb.Harmonic(amplitude="6 N", frequency="33 Hz", point="tip", direction="x"),
        duration="0.05 s",
    )
    run = rb.simulate(case)
    along = run.along([3, 0, 4])
    assert along.point.values.tolist() == ["tip"]
    lines = run.motion.displacement
    expected = 0.6 * lines.sel(point="tip x") + 0.8 * lines.sel(point="tip z")
    np.testing.assert_allclose(along.displacement.sel(point="tip"), expected, atol=1e-15)
    force = run.motion.cavity_force
    np.testing.assert_allclose(along.cavity_force, 0.6 * force.sel(axis="x") + 0.8 * force.sel(axis="z"), atol=1e-12)
    assert list(along.data_vars) == list(run.motion.data_vars)


def test_other_directions_are_refused() -> None:
    """A direction in which a 1-D run does not move is refused: its numbers would be those of another axis."""
    run = runs("y")["ball"]
    assert run.along("y").base_velocity.dims == ("time",)
    assert run.along([0, 2, 0]).base_velocity.dims == ("time",)
    with pytest.raises(rb.CaseError, match="moves along y, not along z"):
        run.along("z")
    with pytest.raises(rb.CaseError, match="is no direction"):
        run.along("up")
    two = rb.Case(
        structure=SHAKEN["structure"],
        dampers=(bed(name="a"), bed(name="b", direction="x")),
        load=rb.Harmonic(amplitude="5 N", frequency="40 Hz"),
        duration="0.02 s",
    )
    with pytest.raises(rb.CaseError, match="different directions"):
        rb.simulate(two).along()


def test_files_have_these_dimensions(tmp_path: Path) -> None:
    """A saved run opened with xarray has the dimensions of `run.motion`, and reads back to the last bit."""
    for name, run in runs().items():
        file = run.save(tmp_path / f"{name}.nc")
        with xr.open_dataset(file, group="motion", engine="h5netcdf") as stored:
            assert stored.base_velocity.dims == run.motion.base_velocity.dims == ("time", "axis")
        assert rb.load(file) == run
        assert rb.load(file).motion.axis.values.tolist() == run.motion.axis.values.tolist()
