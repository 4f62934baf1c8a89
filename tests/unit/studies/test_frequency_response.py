"""Frequency responses: coexisting motions, variables, status, refused arguments."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb

EXAMPLE = Path(__file__).parents[3] / "examples" / "frequency_response.py"
QUICK = {"cycles": (60, 8), "samples": 16, "progress": False}


def case(**changes):
    """Return a small ball with hard impacts in a light, weakly damped structure."""
    parts = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.Harmonic(amplitude="5 N", frequency="30 Hz"),
        "duration": "1 s",
        "method": rb.Newton(),
    }
    return rb.Case(**{**parts, **changes})


def test_coexisting_motions():
    """Upwards the ball is at rest until the structure reaches it; downwards it continues to hit the walls."""
    response = rb.frequency_response(case(), rb.linspace("28 Hz", "30 Hz", 11), progress=False, cycles=(150, 16))
    up, down = (response.sel(direction=way).isel(level=0) for way in ("up", "down"))
    assert up.impacts_per_cycle[0] == 0
    assert down.impacts_per_cycle[0] > 2
    assert up.period[0] == 1
    assert up.amplitude[0] == pytest.approx(float(response.bare_amplitude[0, 0]), rel=1e-3)
    assert down.amplitude[0] > 1.2 * up.amplitude[0]
    assert up.amplitude[-1] == pytest.approx(float(down.amplitude[-1]), rel=0.05)


def test_example():
    """Upwards the ball is at rest until the amplitude of the bare structure is almost the clearance."""
    one = runpy.run_path(str(EXAMPLE))["response"].isel(level=0)
    still = one.impacts_per_cycle.sel(direction="up").values == 0
    last = int(np.flatnonzero(still)[-1])
    assert still[:last].all()
    assert 0.95 < one.bare_amplitude[last] / 1e-3 < 1 < one.bare_amplitude[last + 2] / 1e-3
    assert (one.impacts_per_cycle.sel(direction="down") > 2).all()


def test_variables():
    """Every variable has dimensions, unit and long name, and further measures are included."""
    response = rb.frequency_response(
        case(), ["29 Hz", "31 Hz"], levels=["2 N", 5.0, "0.01 kN"], measure=["loss_per_cycle"], direction="up", **QUICK
    )
    assert response.sizes == {"direction": 1, "level": 3, "frequency": 2}
    assert response.level.values == pytest.approx([2, 5, 10])
    assert (response.level.units, response.frequency.units) == ("N", "Hz")
    assert {"status", "peak", "rms", "amplitude", "phase", "spread", "period", "loss_per_cycle"} <= set(response)
    assert all({"units", "long_name"} <= set(v.attrs) for n, v in response.items() if n != "status")


def test_fresh_starts_each_frequency_from_the_case():
    """With direction 'fresh' each frequency is a separate run."""
    both = rb.frequency_response(case(), [29.2, 30.2], direction="fresh", **QUICK)
    alone = rb.frequency_response(case(), [30.2], direction="up", **QUICK)
    assert both.peak.values[0, 0, 1] == alone.peak.values[0, 0, 0]


def test_bits_do_not_depend_on_threads():
    """The result has the same bits for any number of threads."""
    one, two = (rb.frequency_response(case(), [30, 31], levels=[5, 10, 20], workers=n, **QUICK) for n in (1, 2))
    assert one.drop_attrs().equals(two.drop_attrs())


def test_base_motion():
    """Under base acceleration the relative displacement is that of the linear oscillator, in another phase."""
    shaken = case(damper=[], load=[], base=rb.Harmonic(amplitude="2 m/s^2", frequency="30 Hz"))
    response = rb.frequency_response(shaken, [20.0, 31.0, 45.0], cycles=(400, 8), progress=False)
    omega = 2 * np.pi * response.frequency.values
    exact = -2 / (40e3 - omega**2 + 2j * 0.01 * 200 * omega)
    assert response.amplitude.values[0, 0] == pytest.approx(abs(exact), rel=1e-6)
    assert response.phase.values[0, 0] == pytest.approx(np.angle(exact), abs=1e-6)
    assert response.level.units == "m/s^2"


def test_a_run_that_fails_has_a_status():
    """A level beyond the range of a law has a status and no numbers; the other levels are computed."""
    weak = case(
        method=rb.EventDriven(),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="lead"),
            gap="1 mm",
            contact=rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid")),
        ),
    )
    response = rb.frequency_response(weak, [31.0, 32.0], levels=[0.1, 1e6], direction="up", **QUICK)
    assert (response.status[0, 0] == 0).all()
    assert (response.status[0, 1] != 0).all()
    assert np.isnan(response.amplitude[0, 1]).all()
    assert (response.period[0, 1] == 0).all()


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({}, {"direction": "left"}, "must be 'up', 'down', 'both' or 'fresh'"),
        ({}, {"samples": 3}, "at least 8"),
        ({}, {"cycles": (10.5, 8)}, "two whole numbers"),
        ({}, {"frequencies": [31, 30]}, "strictly rising"),
        ({}, {"frequencies": ["30 m"]}, "frequency"),
        ({}, {"levels": ["1 m"]}, "amplitude"),
        ({"load": rb.HalfSine(amplitude=1.0, duration=0.1)}, {}, "0 harmonic loads or base motions"),
        ({"load": [rb.Harmonic(amplitude=1.0, frequency=f) for f in (1, 2)]}, {}, "loads[0], loads[1]"),
        ({"structure": rb.Fixed(), "load": []}, {}, "has no modes"),
        ({}, {"measure": ["impact"]}, "impacts"),
    ],
)
def test_bad_input_is_refused(changes, options, message):
    """Bad arguments are refused with advice."""
    with pytest.raises(rb.CaseError) as error:
        rb.frequency_response(case(**changes), **{"frequencies": [30.0, 31.0], **QUICK, **options})
    assert message in str(error.value)
