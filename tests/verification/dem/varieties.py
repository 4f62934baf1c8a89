"""Two balls that meet and hit walls, for every law, wall, structure and load: what all engines must agree on."""

from typing import Any

import numpy as np

import rattlebox as rb

from . import cases

BALL = cases.Ball(2e-3, velocity=(2.0, -0.7, 0.9), spin=(200, -80, 50))
OTHER = cases.Ball(
    3e-3, position=(0.0055, 1e-3, -5e-4), velocity=(-3.0, 0.1, 0.4), spin=(-90, 120, 30), material="brass"
)

VARIETIES: dict[str, dict[str, Any]] = {
    "Hertz, fixed restitution": {},
    "Jackson and Green": {"contact": rb.Tsuji(restitution=rb.JacksonGreen())},
    "Johnson": {"contact": rb.Tsuji(restitution=rb.Johnson())},
    "Thornton's restitution": {"contact": rb.Tsuji(restitution=rb.ThorntonRestitution())},
    "table": {"contact": rb.Tsuji(restitution=rb.Tabulated(speeds=[0.1, 1.0, 5.0], values=[0.95, 0.8, 0.6]))},
    "given damping": {"contact": rb.Tsuji(alpha=0.3)},
    "ends at zero overlap": {"contact": rb.Tsuji(restitution=0.7, ending="zero_overlap")},
    "linear": {
        "contact": rb.Linear(stiffness="200 kN/m", restitution=0.7),
        "friction": rb.LinearSpring(0.3, ratio=0.4),
    },
    "linear, by contact time": {
        "contact": rb.Linear(contact_time="0.1 ms", restitution=0.7),
        "friction": rb.LinearSpring(0.3, ratio=0.4),
    },
    "yielding": {"contact": rb.Thornton(yield_pressure="900 MPa")},
    "smooth": {"friction": None},
    "rolling": {"rolling": 0.05},
    "upright cylinder": {"cavity": rb.Cylinder(diameter="18 mm", length="12 mm")},
    "lying cylinder": {"cavity": rb.Cylinder(diameter="16 mm", length="20 mm", axis="x")},
    "sphere": {"cavity": rb.SphericalCavity(radius="9 mm")},
    "gravity": {"gravity": (0, 0, -9.81)},
    "two modes": {
        "structure": rb.Modal(
            frequencies=[40.0, 170.0],
            damping_ratios=[0.02, 0.05],
            shapes={"tip": [[0.0, 0.3, 1.0], [1.0, 0.0, -0.4]]},
        ),
        "point": "tip",
        "load": rb.HalfSine(amplitude=20.0, duration="4 ms", point="tip", direction="z"),
    },
    "base": {
        "structure": rb.SDOF(mass=0.2, stiffness=2e4, damping_ratio=0.02),
        "base": rb.Harmonic(amplitude=30.0, frequency=70.0),
    },
    "shaker": {"structure": rb.Shaker(motion=rb.Harmonic(amplitude=30.0, frequency=70.0, direction="z"))},
}


def pair(options: dict[str, Any]) -> Any:
    """Return two balls that meet obliquely and then hit walls."""
    usual: dict[str, Any] = {
        "cavity": rb.Box(size=("22 mm", "14 mm", "12 mm")),
        "contact": rb.Tsuji(restitution=0.8),
        "friction": rb.Mindlin(0.3),
        "softening": 100.0,
    }
    return cases.case([BALL, OTHER], dt=2e-7, steps=60_000, samples=60, **{**usual, **options})


def told(dem: Any) -> dict[str, Any]:
    """Return all that a simulation of either engine tells."""
    state = dem.state()
    ends = {f"{key} {k}": getattr(part, key) for k, part in enumerate(state.cavities) for key in part.fields()}
    counts, records = dem.counts(), dem.records()
    most = {name: getattr(counts, name) for name in ("first_touches", "largest_overlap", "largest_approach_speed")}
    samples = {name: getattr(records, name) for name in records.fields()}
    return {**samples, **ends, **most, "end of q": state.q, "status": dem.status}


def agree(one: Any, other: Any, to: float) -> None:
    """Hold that two simulations tell the same, relative to the largest value of each kind."""
    wanted, found = told(one), told(other)
    for key in wanted:
        scale = np.max(np.abs(wanted[key]), initial=0.0)
        np.testing.assert_allclose(found[key], wanted[key], rtol=to, atol=to * scale, err_msg=key)
