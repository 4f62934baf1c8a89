"""`check_step`: the change of measures at half of the time step, whichever limit sets it.

No test saw that half of the `fraction` changes nothing where a wave or the samples set the step: the tests of the step
looked at contacts as limits, and the advice of the pages was never followed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.prepare.particles import count_steps


def case(**changes: Any) -> rb.Case:
    """Return a few balls on a shaker."""
    method, output = changes.pop("method", rb.Dem()), changes.pop("output", rb.Output())
    given: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="4 mm", count=16),
        "cavity": rb.Box(size=("15 mm", "15 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.6),
        "direction": "z",
        "packing": rb.Settled(seed=2),
        "softening": 400,
    }
    motion = rb.Harmonic(amplitude="40 m/s^2", frequency="70 Hz", direction="z")
    damper = rb.ParticleDamper(**given | changes)
    return rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="0.1 s", method=method, output=output)


LIMITS = {
    "contact": case(method=rb.Dem(fraction=0.005)),
    "wave": case(method=rb.Dem(fraction=0.2)),
    "samples": case(output=rb.Output(rate="2 MHz")),
    "given": case(method=rb.Dem(dt="3 us")),
}


@pytest.mark.parametrize("limit", sorted(LIMITS))
def test_the_step_of_the_run_is_halved(limit: str) -> None:
    """For each limit of the step, the first row has the step of the run and the second row half of it."""
    given = LIMITS[limit].replaced({"duration": "5 ms"})
    result = rb.check_step(given, packings=2, progress=False)
    steps = result.step.values
    assert steps[0] == pytest.approx(given.duration / count_steps(given), rel=1e-12)
    assert steps[1] == pytest.approx(steps[0] / 2, rel=1e-12)
    for step in steps.tolist():
        taken = rb.simulate(given.replaced({"method": rb.Dem(dt=step)}), progress=False)
        assert taken.diagnostics["step"] == pytest.approx(step, rel=1e-9)


def test_a_fine_step_is_kept_and_a_coarse_one_changes() -> None:
    """A change within its error and the tolerance is no change; the form of the result is that of `check_softening`."""
    fine = rb.check_step(case(), "reduced_loss", packings=4, tolerance=0.2, cycles=(5, 20), progress=False)
    assert not fine.reduced_loss_changed.any() and fine.reduced_loss_kept[-1]
    np.testing.assert_allclose(fine.reduced_loss_change, fine.reduced_loss - fine.reduced_loss[-1])
    other = rb.check_softening(case(), "reduced_loss", packings=2, cycles=(1, 2), progress=False)
    assert set(other) == set(fine) and set(other.attrs) == set(fine.attrs)
    assert fine.step.attrs["units"] == "s"


def test_several_parts_and_cycles() -> None:
    """The step is that of the runs of the study, with its samples; each part divides it."""
    result = rb.check_step(case(), "reduced_loss", parts=(1, 2, 5), packings=2, cycles=(1, 2), progress=False)
    np.testing.assert_allclose(result.step[0] / result.step, [1, 2, 5])


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({}, {"parts": (2,)}, "two parts or more"),
        ({}, {"parts": (2, 1)}, "two parts or more"),
        ({}, {"parts": (0.5, 1)}, "parts"),
        ({}, {"packings": 1}, "packings"),
        ({}, {"measures": "nonsense"}, "nonsense"),
        ({"packing": rb.Lattice(noise=0)}, {}, "no random seed"),
    ],
)
def test_wrong_arguments_are_refused(changes: dict[str, Any], options: dict[str, Any], message: str) -> None:
    """Arguments that do not fit are refused with an alternative."""
    with pytest.raises(rb.CaseError, match=message):
        rb.check_step(case(**changes), **{"cycles": (1, 1), "progress": False, **options})


def test_a_case_without_particles_is_refused() -> None:
    """Impact dampers have no time step."""
    with pytest.raises(rb.CaseError, match="no particle damper"):
        rb.check_step(rb.reference_case(duration=0.1))
