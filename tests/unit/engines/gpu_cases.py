"""Cases that hold, between them, everything that a trajectory on a graphics card may be made of."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import rattlebox as rb
from rattlebox.model.case import Case

BALL = rb.Sphere(radius="10 mm", material="steel")
MASS = rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.01)
SHAKE = rb.Harmonic(amplitude="20 N", frequency="10 Hz")
CYCLES = (2.0, 6.0)


class Variants(NamedTuple):
    """A case with an axis, and how it is looked at."""

    case: Case
    axes: dict[str, Any]
    look: Mapping[str, Any] = MappingProxyType({"cycles": CYCLES})


def _case(contact: Any = None, **parts: Any) -> Case:
    damper = rb.ImpactDamper(ball=BALL, gap="1 mm", start=0.3, contact=contact or rb.Tsuji(restitution=0.6))
    given = {"structure": MASS, "damper": damper, "load": SHAKE, "duration": "0.6 s"} | parts
    return rb.Case(**{name: part for name, part in given.items() if part is not None})


def _of(contact: Any = None, **parts: Any) -> Variants:
    return Variants(_case(contact, **parts), {"damper.gap": ["0.5 mm", "1 mm", "1.7 mm"]})


def _asked(restitution: Any) -> Variants:
    return _of(rb.Tsuji(restitution=restitution))


ROW = rb.ImpactDamper(
    balls=[rb.Sphere(radius=radius, material="steel") for radius in ("4 mm", "5 mm", "6 mm")],
    gap="1 mm",
    start=[-0.5, 0.0, 0.3],
    velocity=[0.1, 0.2, -0.3],
    wall="aluminium",
    contact=rb.Tsuji(restitution=0.8),
    ball_contact=rb.Linear(stiffness="1 MN/m", restitution=0.8),
)
BEAM = rb.Modal(
    frequencies=[5.0, 17.0, 31.0],
    damping_ratios=[0.01] * 3,
    shapes={"tip": [0.6, -0.5, 0.4], "middle": [0.3, 0.4, -0.2]},
)
CURVE = rb.Record(times=[0.0, 0.01, 0.04, 0.6], values=[0.0, 300.0, -300.0, 0.0])
STEEL = rb.JacksonGreen(extrapolate=True)

CASES: dict[str, dict[str, Variants]] = {
    "contact": {
        "Tsuji": _of(rb.Tsuji(restitution=0.6)),
        "Tsuji with a fixed dashpot": _of(rb.Tsuji(alpha=0.3, ending="zero_overlap")),
        "Linear": _of(rb.Linear(contact_time="0.5 ms", restitution=0.6)),
        "Thornton": _of(rb.Thornton(yield_pressure="1 GPa")),
    },
    "restitution": {
        "Constant": _asked(rb.Constant(0.5)),
        "Tabulated": _asked(rb.Tabulated(speeds=[0.01, 0.1, 1.0], values=[0.9, 0.7, 0.4])),
        "JacksonGreen": _asked(STEEL),
        "ThorntonRestitution": _asked(rb.ThorntonRestitution()),
        "Johnson": _asked(rb.Johnson()),
    },
    "structure": {
        "SDOF": _of(),
        "Modal": Variants(
            _case(
                structure=BEAM,
                damper=None,
                dampers=[
                    rb.ImpactDamper(
                        ball=BALL, gap="0.4 mm", contact=rb.Tsuji(restitution=0.6), point="tip", name="end"
                    ),
                    ROW.model_copy(update={"point": "middle"}),
                ],
                load=rb.Harmonic(amplitude="20 N", frequency="10 Hz", point="tip"),
            ),
            {"dampers[0].gap": ["0.3 mm", "0.4 mm"]},
        ),
        "Matrices": _of(
            structure=rb.Matrices(M=[[2.0, 0.3], [0.3, 1.0]], K=[[4e4, -1e4], [-1e4, 3e4]], points={"top": [0.2, 1.0]})
        ),
        "Fixed": Variants(
            _case(structure=rb.Fixed(), load=None, damper=ROW.model_copy(update={"gravity": -9.81})),
            {"damper.gap": ["1 mm", "2 mm"]},
            {"last": 4},
        ),
        "Shaker": Variants(
            _case(structure=rb.Shaker(motion=rb.Harmonic(amplitude="3 mm", frequency="12 Hz")), load=None),
            {"structure.motion.amplitude": ["2 mm", "3 mm"]},
        ),
    },
    "load": {
        "HalfSine": Variants(
            _case(load=rb.HalfSine(amplitude="200 N", duration="5 ms")), {"load.amplitude": ["50 N", "200 N"]}, {}
        ),
        "Harmonic": Variants(_case(), {"load.frequency": ["9 Hz", "11 Hz"]}),
        "Record": Variants(_case(load=CURVE), {"damper.gap": ["0.5 mm", "1 mm"]}, {}),
        "motion of the base": Variants(
            _case(load=None, base=rb.Harmonic(amplitude="5 m/s^2", frequency="10 Hz")),
            {"base.amplitude": ["3 m/s^2", "5 m/s^2"]},
        ),
    },
    "method": {
        "EventDriven": _of(),
        "EventDriven without collocation": _of(method=rb.EventDriven(collocation=False)),
        "Newton": _of(method=rb.Newton(restitution=0.7)),
        "TwoStep": Variants(_case(method=rb.TwoStep(), duration="0.1 s"), {"damper.gap": ["0.1 mm", "0.2 mm"]}, {}),
    },
    "cavity": {
        "one ball": _of(),
        "a row of balls": Variants(_case(damper=ROW), {"damper.gap": ["1 mm", "1.5 mm"]}),
    },
    "ending": {
        "finished": _of(),
        "law_domain": Variants(_case(rb.Tsuji(restitution=rb.JacksonGreen())), {"damper.velocity": [1.0, 3000.0]}),
        "too_many_events": _of(method=rb.EventDriven(max_events=10)),
        "no_rebound": _asked(rb.Tabulated(speeds=[0.01, 0.1], values=[0.5, 0.0])),
    },
    "output": {
        "motion": Variants(_case(), {"damper.gap": ["0.5 mm", "1 mm"]}, {"cycles": CYCLES, "motion": True}),
        "last impacts": Variants(_case(), {"damper.gap": ["0.5 mm", "1 mm"]}, {"cycles": CYCLES, "last": 7}),
        "state at the end": Variants(_case(), {"damper.gap": ["0.5 mm", "1 mm"]}, {"cycles": CYCLES, "state": True}),
    },
}


def bed(speed: float = 1.0, **options: Any) -> Any:
    """Return 40 balls in a box on a structure that is hit."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", radius="2 mm", count=40),
        "cavity": rb.Box(size=("22 mm",) * 3),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": rb.Mindlin(0.3),
        "softening": 1000.0,
        "velocity": (0.3, 0.1, -speed),
        "packing": rb.Lattice(noise=1.0, seed=2),
    }
    return rb.Case(
        structure=rb.SDOF(mass=0.5, stiffness=2e4, damping_ratio=0.02, velocity=0.5),
        damper=rb.ParticleDamper(**{**usual, **options}),
        duration="3 ms",
        output=rb.Output(rate=10_000.0),
    )


MISSING: dict[str, dict[str, str]] = {
    "output": {
        "functions of a Run": "a card makes no Run; use measures by name",
        "whole trajectories, impact logs": "`rb.simulate`, on the processor",
    },
    "study": {
        "bifurcation up or down": "one motion, each value of which goes on from the one before",
    },
}
BELOW = {"method": ("Dem",)}
"""What the page tells of in a part of its own."""
STUDIES = (
    "sweep",
    "basins",
    "lyapunov",
    "frequency_response",
    "bifurcation with direction fresh",
    "loss_map",
    "sensitivity",
    "design",
)


def table() -> list[str]:
    """Return the lines of the parity table of docs/gpu.md."""
    from rattlebox.studies.measures import MEASURES

    lines = ["| | on the processor | on a card |", "|---|---|---|"]
    for group in dict.fromkeys([*CASES, *MISSING]):
        names = [*CASES.get(group, ()), *(STUDIES if group == "study" else ())]
        if names:
            lines.append(f"| {group}: {', '.join(names)} | yes | yes |")
        lines += [f"| {group}: {name} | yes | yes, see below |" for name in BELOW.get(group, ())]
        lines += [f"| {group}: {name} | yes | no: {why} |" for name, why in MISSING.get(group, {}).items()]
    lines.append(f"| measure: {', '.join(MEASURES)} | yes | yes |")
    return lines
