"""Several dampers with rows of balls on one structure, compared with independent equations integrated by SciPy."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import rattlebox as rb

Array = NDArray[np.float64]
DURATION = 0.06
SOFT = rb.Material(density=7850.0, young=2e7, poisson=0.3)
OMEGA, ZETA, SHAPE = 2 * math.pi * np.array([6.0, 17.0]), np.array([0.02, 0.3]), {"a": [0.9, 0.5], "b": [0.4, -0.8]}
FORCE, LOAD_RATE = 15.0, 2 * math.pi * 11.0
ALPHA, LINEAR = 0.3, {"stiffness": 4e3, "damping": 0.6}
DAMPERS: list[dict[str, Any]] = [
    {"point": "a", "radii": [6e-3], "gap": 4e-4, "start": [0.2], "velocity": [0.1], "gravity": 0.0, "law": "tsuji"},
    {
        "point": "b",
        "radii": [5e-3, 4e-3, 7e-3],
        "gap": 6e-4,
        "start": [-0.6, 0.0, 0.5],
        "velocity": [0.2, -0.1, 0.05],
        "gravity": -9.81,
        "law": "tsuji",
    },
    {
        "point": "a",
        "radii": [8e-3, 5e-3],
        "gap": 3e-4,
        "start": [-0.3, 0.4],
        "velocity": [0.0, -0.2],
        "gravity": 0.0,
        "law": "linear",
    },
]


def case(ending: str) -> Any:
    """Return the case."""
    laws = {"tsuji": rb.Tsuji(alpha=ALPHA, ending=ending), "linear": rb.Linear(**LINEAR, ending=ending)}
    return rb.Case(
        structure=rb.Modal(frequencies=OMEGA / (2 * math.pi), damping_ratios=ZETA, shapes=SHAPE),
        dampers=[
            rb.ImpactDamper(
                name=f"damper {k}",
                balls=[rb.Sphere(radius=r, material=SOFT) for r in d["radii"]],
                **{key: d[key] for key in ("point", "gap", "start", "velocity", "gravity")},
                contact=laws[d["law"]],
            )
            for k, d in enumerate(DAMPERS)
        ],
        load=rb.Harmonic(amplitude=FORCE, frequency=LOAD_RATE / (2 * math.pi), point="a"),
        duration=DURATION,
        output=rb.Output(times=np.linspace(0, DURATION, 121)),
    )


class Equations:
    """Right-hand side of the equations of motion of the case; positions are relative to the packed rows."""

    def __init__(self, ending: str) -> None:
        self.clip = ending == "zero_force"
        self.masses = [np.array([SOFT.density * 4 / 3 * math.pi * r**3 for r in d["radii"]]) for d in DAMPERS]
        self.first = np.cumsum([0, *(len(d["radii"]) for d in DAMPERS)])
        self.modulus = SOFT.young / (2 * (1 - SOFT.poisson**2))

    def start(self) -> Array:
        """Return modal coordinates, positions and their rates."""
        places = [x * d["gap"] for d in DAMPERS for x in d["start"]]
        return np.array([0.0, 0.0, *places, 0.0, 0.0, *(v for d in DAMPERS for v in d["velocity"])])

    def row(self, y: Array, number: int) -> tuple[Array, Array]:
        """Return the positions and rates of a row, including the walls on both sides."""
        d, half = DAMPERS[number], y.size // 2
        shape = np.array(SHAPE[d["point"]])
        own = slice(2 + self.first[number], 2 + self.first[number + 1])
        z, v = shape @ y[:2], shape @ y[half : half + 2]
        rates = y[half:][own]
        return np.array([z - d["gap"], *y[:half][own], z + d["gap"]]), np.array([v, *rates, v])

    def force(self, number: int, contact: int, overlap: float, rate: float) -> float:
        """Return the force of a contact; zero if it is open."""
        if overlap <= 0:
            return 0.0
        d, masses = DAMPERS[number], self.masses[number]
        bodies = [k for k in (contact - 1, contact) if 0 <= k < masses.size]
        inverse = sum(1 / masses[k] for k in bodies) + (len(bodies) == 1) * float(np.square(SHAPE[d["point"]]).sum())
        if d["law"] == "linear":
            push = LINEAR["stiffness"] * overlap + LINEAR["damping"] * rate
        else:
            radius = 1 / sum(1 / d["radii"][k] for k in bodies)
            stiffness = 4 / 3 * self.modulus * math.sqrt(radius)
            push = stiffness * overlap**1.5 + ALPHA * math.sqrt(stiffness / inverse) * overlap**0.25 * rate
        return max(push, 0.0) if self.clip else push

    def __call__(self, t: float, y: Array) -> Array:
        """Return the derivative of the state."""
        half = y.size // 2
        pull = np.array(SHAPE["a"]) * FORCE * math.sin(LOAD_RATE * t)
        accelerations = []
        for number, d in enumerate(DAMPERS):
            x, v = self.row(y, number)
            forces = [
                self.force(number, k, a - b, va - vb)
                for k, ((a, va), (b, vb)) in enumerate(pairwise(zip(x, v, strict=True)))
            ]
            accelerations += list(d["gravity"] + (np.array(forces[:-1]) - forces[1:]) / self.masses[number])
            pull = pull + np.array(SHAPE[d["point"]]) * (forces[-1] - forces[0])
        modes = pull - 2 * ZETA * OMEGA * y[half : half + 2] - OMEGA**2 * y[:2]
        return np.concatenate([y[half:], modes, accelerations])

    def gap(self, number: int, contact: int) -> Any:
        """Return an event function that crosses zero downwards at first touch."""

        def value(t: float, y: Array) -> float:
            x, _ = self.row(y, number)
            return float(x[contact + 1] - x[contact])

        value.direction = -1  # type: ignore[attr-defined]
        return value


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
def test_rows_in_several_cavities_agree_with_scipy(ending: str) -> None:
    """Times of first touch and the motion of three cavities with six balls agree with SciPy."""
    run = rb.simulate(case(ending))
    equations = Equations(ending)
    contacts = [(d, c) for d, own in enumerate(DAMPERS) for c in range(len(own["radii"]) + 1)]
    solution = solve_ivp(
        equations,
        (0, DURATION),
        equations.start(),
        method="DOP853",
        t_eval=np.linspace(0, DURATION, 121),
        events=[equations.gap(*contact) for contact in contacts],
        rtol=1e-11,
        atol=1e-14,
        max_step=1e-4,
    )
    log = run.arrays.impacts
    touches = sorted((t, *contact) for times, contact in zip(solution.t_events, contacts, strict=True) for t in times)
    assert len(touches) > 20
    assert [(d, c) for _, d, c in touches] == list(zip(log.damper.tolist(), log.contact.tolist(), strict=True))
    assert log.time == pytest.approx([t for t, _, _ in touches], abs=1e-9)
    displacement = solution.y[:2].T @ np.array(SHAPE["a"])
    assert run.arrays.displacement[:, run.arrays.points.index("a")] == pytest.approx(displacement, abs=1e-10)
    places = run.arrays.ball_position - run.arrays.ball_centre
    assert np.abs(places - solution.y[2:8].T).max() < 1e-10
