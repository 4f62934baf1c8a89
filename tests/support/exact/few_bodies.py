"""A few spheres in a cavity on the modes of a structure, in plain Python, written from the documentation only.

Motion is integrated by the classical Runge-Kutta method. Begin and end of each contact are located to rounding, and steps
begin there anew, short ones first, so that the restitution law and the contact history start at the start of the contact.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import brentq

Vector = Any
Triple = Sequence[float]

PARTNER, WALL = 0, 1


@dataclass(frozen=True)
class Matter:
    """Density [kg/m^3], modulus of elasticity [Pa] and Poisson's ratio."""

    density: float
    young: float
    poisson: float

    @property
    def compliance(self) -> float:
        """(1 - nu^2) / E [1/Pa]."""
        return (1 - self.poisson**2) / self.young

    @property
    def shear_compliance(self) -> float:
        """(2 - nu) / G [1/Pa]."""
        return 2 * (1 + self.poisson) * (2 - self.poisson) / self.young


@dataclass(frozen=True)
class Ball:
    """A sphere and its start, from the cavity's centre at rest."""

    radius: float
    matter: Matter
    position: Triple
    velocity: Triple = (0.0, 0.0, 0.0)
    spin: Triple = (0.0, 0.0, 0.0)

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.matter.density * 4 / 3 * math.pi * self.radius**3

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre [kg m^2]."""
        return 0.4 * self.mass * self.radius**2


@dataclass(frozen=True)
class Wall:
    """A plane with its outward normal, or a surface `curved` about an axis (zero for a sphere); distance from the centre."""

    axis: Triple
    offset: float
    curved: bool = False


def box(x: float, y: float, z: float) -> list[Wall]:
    """Return the six planes of a box."""
    return [Wall(sign * axis, size / 2) for axis, size in zip(np.eye(3), (x, y, z), strict=True) for sign in (-1, 1)]


def cylinder(radius: float, length: float, axis: Triple) -> list[Wall]:
    """Return the side and the ends of a cylinder."""
    along = np.array(axis) / np.linalg.norm(axis)
    return [Wall(along, radius, True), Wall(-along, length / 2), Wall(along, length / 2)]


def sphere(radius: float) -> list[Wall]:
    """Return a hollow sphere."""
    return [Wall(np.zeros(3), radius, True)]


@dataclass(frozen=True)
class Mode:
    """Natural frequency [Hz], damping ratio, mass-normalised shape of the cavity [kg^-1/2], modal velocity at the start."""

    frequency: float
    damping: float
    shape: Triple
    velocity: float = 0.0


@dataclass(frozen=True)
class Laws:
    """Laws of the contacts with one partner: Hertz if `stiffness` is None, else linear [N/m].

    Restitution is a number, or speeds [m/s] and values between which it is linear. `spring` is the tangential stiffness
    of friction [N/m], None for Mindlin's. `damping` is tangential over normal damping ratio.
    """

    restitution: float | tuple[Sequence[float], Sequence[float]]
    stiffness: float | None = None
    pulls: bool = False
    friction: float = 0.0
    spring: float | None = None
    damping: float = 1.0
    rolling: float = 0.0
    rolling_stiffness: float = 1.0

    def damping_ratio(self, speed: float) -> float:
        """Return the damping ratio with which a contact that begins at this speed has its restitution."""
        e = self.restitution if isinstance(self.restitution, float) else float(np.interp(speed, *self.restitution))
        if e == 1:
            return 0.0
        if self.pulls:
            return -math.log(e) / math.hypot(math.pi, math.log(e))
        # ln e = -2 b cot b for zeta = cos b
        angle = brentq(lambda b: math.log(e) + 2 * b / math.tan(b), 1e-9, math.pi / 2, xtol=1e-16, rtol=1e-15)
        return math.cos(angle)


@dataclass
class Contact:
    """A contact of ball i with ball j or with a wall; `ratio` is its damping ratio while it is closed."""

    i: int
    j: int
    laws: Laws
    wall: Wall | None
    radius: float
    mass: Callable[[Vector], float]
    hertz: float
    shear: float
    closed: bool = False
    m: float = 0.0
    ratio: float = 0.0

    def stiffnesses(self, d: float) -> tuple[float, float]:
        """Return the stiffness of the tangential and of the rolling spring at an overlap."""
        k = self.laws.spring if self.laws.spring is not None else self.shear * math.sqrt(self.radius * d)
        return k, self.laws.rolling_stiffness * k * self.radius**2

    @property
    def tangential_ratio(self) -> float:
        """Damping ratio of the normal dashpot for the stiffness at the present overlap."""
        return self.ratio * (math.sqrt(5 / 6) if self.laws.stiffness is None else 1.0)

    def normal(self, d: float, rate: float) -> tuple[float, float]:
        """Return normal force and its elastic part."""
        if self.laws.stiffness is None:
            elastic = self.hertz * d**1.5
            total = elastic + math.sqrt(5) * self.ratio * math.sqrt(self.m * self.hertz) * d**0.25 * rate
        else:
            elastic = self.laws.stiffness * d
            total = elastic + 2 * self.ratio * math.sqrt(self.m * self.laws.stiffness) * rate
        return (total if self.laws.pulls else max(total, 0.0)), elastic

    def potential(self, d: float) -> float:
        """Return the elastic energy of the normal force."""
        return 0.4 * self.hertz * d**2.5 if self.laws.stiffness is None else 0.5 * self.laws.stiffness * d * d


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product; numpy's own takes far longer for three numbers."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def shortened(vector: Vector, limit: float) -> Vector:
    """Return a vector that is no longer than a limit."""
    length = math.sqrt(vector @ vector)
    return vector if length <= limit else vector * (limit / length)


@dataclass
class Bodies:
    """Balls in a cavity, and the structure that carries it.

    The load is a force [N] in time along `towards` at the cavity.
    """

    balls: Sequence[Ball]
    walls: Sequence[Wall]
    wall_matter: Matter | None
    modes: Sequence[Mode]
    laws: tuple[Laws, Laws]
    gravity: Triple = (0.0, 0.0, 0.0)
    load: Callable[[float], float] = lambda t: 0.0
    towards: Triple = (1.0, 0.0, 0.0)
    contacts: list[Contact] = field(default_factory=list)
    touches: list[tuple[float, int, int, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        n, m = len(self.balls), len(self.modes)
        self.radius = np.array([ball.radius for ball in self.balls])
        self.mass = np.array([ball.mass for ball in self.balls])
        self.inertia = np.array([ball.inertia for ball in self.balls])
        self.omega = 2 * math.pi * np.array([mode.frequency for mode in self.modes])
        self.decay = 2 * np.array([mode.damping for mode in self.modes]) * self.omega
        self.shape = np.array([mode.shape for mode in self.modes]).reshape(m, 3)
        self.pull = np.array(self.gravity)
        self.drive = self.shape @ np.array(self.towards)
        for i, j in combinations(range(n), 2):
            self._add(i, j, None)
        for wall in self.walls:
            for i in range(n):
                self._add(i, n, wall)
        held = 3 * len(self.contacts)
        sizes = {"q": m, "p": m, "x": 3 * n, "v": 3 * n, "w": 3 * n, "spring": held, "moment": held}
        sizes |= {"load": 1, "viscous": 1, "normal": 2, "sliding": 2, "rolling": 2}
        ends = np.cumsum(list(sizes.values()))
        self.at = {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}
        self.state = np.zeros(ends[-1])
        self.state[self.at["p"]] = [mode.velocity for mode in self.modes]
        for name, key in (("x", "position"), ("v", "velocity"), ("w", "spin")):
            self.state[self.at[name]] = np.ravel([getattr(ball, key) for ball in self.balls])
        self.time = 0.0

    def _add(self, i: int, j: int, wall: Wall | None) -> None:
        ball = self.balls[i]
        other = self.balls[j] if wall is None else None
        matter = other.matter if other else self.wall_matter
        radius = 1 / (1 / ball.radius + (1 / other.radius if other else 0.0))
        modulus = 1 / (ball.matter.compliance + (matter.compliance if matter else 0.0))
        shear = 8 / (ball.matter.shear_compliance + (matter.shear_compliance if matter else 0.0))

        def mass(normal: Vector) -> float:
            along = self.shape @ normal
            return 1 / (1 / ball.mass + (1 / other.mass if other else along @ along))

        hertz = 4 / 3 * modulus * math.sqrt(radius)
        self.contacts.append(Contact(i, j, self.laws[WALL if wall else PARTNER], wall, radius, mass, hertz, shear))

    def part(self, state: Vector, name: str) -> Vector:
        """Return a part of the state: a row for each body or contact, or numbers."""
        values = state[self.at[name]]
        return values.reshape(-1, 3) if name in ("x", "v", "w", "spring", "moment") else values

    def place(self, contact: Contact, x: Vector, u: Vector) -> tuple[Vector, float, float]:
        """Return the normal from ball i to its partner, the overlap, and the distance over which the normal turns."""
        if contact.wall is None:
            r = x[contact.j] - x[contact.i]
            distance = math.sqrt(r @ r)
            return r / distance, self.radius[contact.i] + self.radius[contact.j] - distance, distance
        axis = np.asarray(contact.wall.axis)
        r = x[contact.i] - u
        if not contact.wall.curved:
            return axis, self.radius[contact.i] - contact.wall.offset + r @ axis, math.inf
        r = r - axis * (r @ axis)
        distance = math.sqrt(r @ r)
        if distance == 0:
            return r, self.radius[contact.i] - contact.wall.offset, math.inf
        return r / distance, self.radius[contact.i] - contact.wall.offset + distance, -distance

    def rates(self, t: float, state: Vector) -> Vector:
        """Return the time derivative of the state."""
        q, p, x, v, w, spring, moment = (self.part(state, k) for k in ("q", "p", "x", "v", "w", "spring", "moment"))
        out = np.zeros_like(state)
        u, du = q @ self.shape, p @ self.shape
        n = len(self.balls)
        force, torque = np.zeros((n + 1, 3)), np.zeros((n, 3))
        d_spring, d_moment = self.part(out, "spring"), self.part(out, "moment")
        normal_loss, sliding, rolling = (self.part(out, k) for k in ("normal", "sliding", "rolling"))
        for number, contact in enumerate(self.contacts):
            if not contact.closed:
                continue
            i, j, laws = contact.i, contact.j, contact.laws
            partner = PARTNER if contact.wall is None else WALL
            normal, d, distance = self.place(contact, x, u)
            a, b = self.radius[i], 0.0 if contact.wall else self.radius[j]
            share = d / (a + b)
            a, b = a - share * a, b - share * b
            arms = a * w[i] + (b * w[j] if contact.wall is None else 0.0)
            relative = v[i] - (v[j] if contact.wall is None else du)
            rate = relative @ normal
            d = max(d, 0.0)
            N, elastic = contact.normal(d, rate)
            normal_loss[partner] += (N - elastic) * rate
            force[i] -= N * normal
            force[j] += N * normal
            if laws.friction == 0:
                continue
            turning = (rate * normal - relative) / distance
            if contact.wall is not None and distance < 0:
                axis = np.asarray(contact.wall.axis)
                turning = turning + axis * (axis @ relative) / distance
            k, k_roll = contact.stiffnesses(d)
            loosen = rate / (2 * d) if rate < 0 and d > 0 and laws.spring is None else 0.0
            slip = relative - rate * normal + cross(arms, normal)
            T = spring[number] - normal * (spring[number] @ normal)
            limit = laws.friction * max(N, 0.0)
            T = shortened(T, limit)
            dashpot = -2 * laws.damping * contact.tangential_ratio * math.sqrt(contact.m * k) * slip
            F = T + shortened(dashpot, limit - math.sqrt(T @ T))
            d_spring[number] = -k * slip + loosen * T - (T @ turning) * normal
            force[i] += F
            force[j] -= F
            moved = cross(normal, F)
            torque[i] += a * moved
            if contact.wall is None:
                torque[j] += b * moved
            sliding[partner] -= F @ slip
            if laws.rolling == 0:
                continue
            spin = w[i] - (w[j] if contact.wall is None else 0.0)
            spin = spin - normal * (spin @ normal)
            M = moment[number] - normal * (moment[number] @ normal)
            M = shortened(M, laws.rolling * contact.radius * max(N, 0.0))
            d_moment[number] = -k_roll * spin + loosen * M - (M @ turning) * normal
            torque[i] += M
            if contact.wall is None:
                torque[j] -= M
            rolling[partner] -= M @ spin
        push = self.load(t)
        out[self.at["q"]] = p
        out[self.at["p"]] = -self.decay * p - self.omega**2 * q + self.shape @ force[n] + self.drive * push
        out[self.at["x"]] = state[self.at["v"]]
        out[self.at["v"]] = (force[:n] / self.mass[:, None] + self.pull).ravel()
        out[self.at["w"]] = (torque / self.inertia[:, None]).ravel()
        out[self.at["load"]] = push * (self.drive @ p)
        out[self.at["viscous"]] = self.decay @ p**2
        return out

    def advanced(self, h: float) -> Vector:
        """Return the state after a step of the classical Runge-Kutta method."""
        t, y = self.time, self.state
        one = self.rates(t, y)
        two = self.rates(t + h / 2, y + h / 2 * one)
        three = self.rates(t + h / 2, y + h / 2 * two)
        four = self.rates(t + h, y + h * three)
        return y + h / 6 * (one + 2 * two + 2 * three + four)

    def sides(self, state: Vector) -> Vector:
        """Return for each contact a number that becomes positive when the contact begins or ends."""
        x, u = self.part(state, "x"), self.part(state, "q") @ self.shape
        return np.array([(-1 if contact.closed else 1) * self.place(contact, x, u)[1] for contact in self.contacts])

    def run(self, until: float, step: float, flight: float) -> None:
        """Advance to a time, with largest steps in contacts and in flight [s]."""
        h = step / 1000
        while self.time < until:
            h = min(1.5 * h, step if any(contact.closed for contact in self.contacts) else flight)
            h = min(h, until - self.time)
            new, watched = self.advanced(h), self.sides(self.state) < 0
            turned = np.flatnonzero(watched & (self.sides(new) > 0))
            first = -1
            if turned.size:
                ends = {
                    k: brentq(lambda part, k=k: self.sides(self.advanced(part))[k], 0.0, h, xtol=1e-22, rtol=1e-15)
                    for k in turned
                }
                first = min(ends, key=lambda k: ends[k])
                h = ends[first]
                new = self.advanced(h)
            self.time = until if h == until - self.time else self.time + h
            self.state = new
            self._settle()
            if first >= 0:
                self._turn(first)
                h = step / 1000

    def _turn(self, number: int) -> None:
        """End a contact, or begin one with the damping ratio for its approach speed."""
        contact = self.contacts[number]
        contact.closed = not contact.closed
        if not contact.closed:
            self.part(self.state, "spring")[number] = self.part(self.state, "moment")[number] = 0.0
            return
        x, v = self.part(self.state, "x"), self.part(self.state, "v")
        q, p = self.part(self.state, "q"), self.part(self.state, "p")
        normal, _, _ = self.place(contact, x, q @ self.shape)
        speed = (v[contact.i] - (v[contact.j] if contact.wall is None else p @ self.shape)) @ normal
        contact.m, contact.ratio = contact.mass(normal), contact.laws.damping_ratio(speed)
        self.touches.append((self.time, contact.i, contact.j, float(speed)))

    def _settle(self) -> None:
        """Project springs onto the plane of contact and limit them."""
        x, v, spring, moment = (self.part(self.state, name) for name in ("x", "v", "spring", "moment"))
        u, du = self.part(self.state, "q") @ self.shape, self.part(self.state, "p") @ self.shape
        for number, contact in enumerate(self.contacts):
            if contact.closed:
                normal, d, _ = self.place(contact, x, u)
                rate = (v[contact.i] - (v[contact.j] if contact.wall is None else du)) @ normal
                N = max(contact.normal(d, rate)[0], 0.0) if d > 0 else 0.0
                for held, limit in ((spring, contact.laws.friction), (moment, contact.laws.rolling * contact.radius)):
                    held[number] = shortened(held[number] - normal * (held[number] @ normal), limit * N)

    def energies(self) -> dict[str, Any]:
        """Return the energies of the ledger [J], with losses among balls and at walls."""
        q, p, x, v, w, spring, moment = (
            self.part(self.state, k) for k in ("q", "p", "x", "v", "w", "spring", "moment")
        )
        held = {name: np.zeros(2) for name in ("normal", "sliding", "rolling")}
        for number, contact in enumerate(self.contacts):
            d = max(self.place(contact, x, q @ self.shape)[1], 0.0) if contact.closed else 0.0
            if d > 0:
                partner = PARTNER if contact.wall is None else WALL
                k, k_roll = contact.stiffnesses(d)
                held["normal"][partner] += contact.potential(d)
                if contact.laws.friction:
                    held["sliding"][partner] += spring[number] @ spring[number] / (2 * k)
                    held["rolling"][partner] += moment[number] @ moment[number] / (2 * k_roll)
        out = {name + "_loss": self.part(self.state, name) - held[name] for name in ("sliding", "rolling")}
        return out | {
            "normal_loss": self.part(self.state, "normal").copy(),
            "contact_energy": sum(float(held[name].sum()) for name in held),
            "mode_energy": 0.5 * (p**2 + self.omega**2 * q**2),
            "kinetic_energy": 0.5 * float(self.mass @ (v * v).sum(axis=1)),
            "rotation_energy": 0.5 * float(self.inertia @ (w * w).sum(axis=1)),
            "gravity_energy": -float(self.mass @ x @ self.pull),
            "load_work": float(self.part(self.state, "load")[0]),
            "viscous_loss": float(self.part(self.state, "viscous")[0]),
        }
