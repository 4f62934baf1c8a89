"""Runs computed in plain Python: an exactly propagated oscillator with hard impacts.

The load is constant within a step, so that its work is exact; each impact conserves momentum and dissipates energy
by its restitution. Contact durations, overlaps and forces are those of an undamped Hertz contact with the
same approach speed.
"""

from __future__ import annotations

from math import cos, exp, inf, pi, sin, sqrt

import numpy as np

from rattlebox.results import Provenance, Run, RunArrays

MASS, STIFFNESS, DAMPING = 20.0, 80e3, 25.3
BALL_MASS, HERTZ = 1.2, 2.668518e10
CASE = 'name = "hand-made case, µ"\nduration = "1 s"\n'
PROVENANCE = Provenance("0.1.0", "hand-made", 7, "2030-01-02T03:04:05+00:00", "Linux x86_64")


class _Structure:
    """One mode under a force that is constant within a step, or a fixed wall."""

    def __init__(self, step: float, fixed: bool) -> None:
        self.fixed, self.z, self.v = fixed, 0.0, 0.0
        self.mass = inf if fixed else MASS
        a, k = DAMPING / (2 * MASS), STIFFNESS / MASS
        w = sqrt(k - a * a)
        c, s, d = cos(w * step), sin(w * step), exp(-a * step)
        self.step_matrix = (d * (c + a / w * s), d * s / w, -d * k / w * s, d * (c - a / w * s))

    def advance(self, force: float) -> tuple[float, float]:
        """Advance by one step; return the work of the force and the viscous loss."""
        if self.fixed:
            return 0.0, 0.0
        before, rest, start = self.energy, force / STIFFNESS, self.z
        a, b, c, d = self.step_matrix
        x = self.z - rest
        self.z, self.v = rest + a * x + b * self.v, c * x + d * self.v
        work = force * (self.z - start)
        return work, work - (self.energy - before)

    @property
    def energy(self) -> float:
        return 0.0 if self.fixed else 0.5 * MASS * self.v**2 + 0.5 * STIFFNESS * self.z**2


def make_run(
    rows: tuple[int, ...] = (1,),
    *,
    restitution: float = 0.7,
    pulse: float = 5e3,
    fixed: bool = False,
    ball_speed: float = 0.0,
    clearance: float = 0.8e-3,
    duration: float = 1.0,
    times: int = 1001,
    status: str = "finished",
    message: str = "",
) -> Run:
    """Return a run with one damper for each entry of `rows`, its number of balls."""
    inner = 20
    step = duration / max(times - 1, 1) / inner
    structure = _Structure(step, fixed)
    damper_of = np.repeat(np.arange(len(rows)), rows)
    balls, radius = len(damper_of), 5e-3
    centre = np.concatenate([(2 * np.arange(n) - (n - 1)) * radius for n in rows]) if balls else np.zeros(0)
    s, u = np.zeros(balls), np.full(balls, ball_speed)
    work = viscous = 0.0
    lost = np.zeros(len(rows))
    log: list[tuple[float, ...]] = []
    names = ("z", "v", "s", "u", "e", "work", "viscous", "lost", "force")
    samples: dict[str, list[object]] = {name: [] for name in names}

    def touch(now: float, damper: int, contact: int, left: int | None, right: int | None) -> None:
        masses = [structure.mass if i is None else BALL_MASS for i in (left, right)]
        speeds = [structure.v if i is None else u[i] for i in (left, right)]
        approach = speeds[0] - speeds[1]
        if approach <= 0:
            return
        reduced = 1 / sum(1 / m for m in masses)
        impulse = reduced * (1 + restitution) * approach
        for i, sign in ((left, -1.0), (right, 1.0)):
            if i is None:
                structure.v += sign * impulse / structure.mass
            else:
                u[i] += sign * impulse / BALL_MASS
        loss = 0.5 * reduced * approach**2 * (1 - restitution**2)
        lost[damper] += loss
        overlap = (5 * reduced * approach**2 / (4 * HERTZ)) ** 0.4
        period = 2.9432752 * overlap / approach
        log.append((damper, contact, now, approach, restitution, restitution * approach, period, overlap,
                    HERTZ * overlap**1.5, loss))  # fmt: skip

    for n in range(times * inner - inner + 1):
        now = n * step
        force = pulse * sin(pi * now / 1e-3) if now < 1e-3 else 0.0
        if n % inner == 0:
            places = structure.z, structure.v, s.copy(), u.copy(), structure.energy
            for name, value in zip(names, (*places, work, viscous, lost.copy(), force), strict=True):
                samples[name].append(value)
        done, gone = structure.advance(force)
        work, viscous = work + done, viscous + gone
        s += u * step
        first = 0
        for damper, count in enumerate(rows):
            half = clearance / 2
            row = range(first, first + count)
            if s[first] - structure.z < -half:
                touch(now, damper, 0, None, first)
            for k in row[:-1]:
                if s[k + 1] < s[k]:
                    touch(now, damper, k - first + 1, k, k + 1)
            if s[row[-1]] - structure.z > half:
                touch(now, damper, count, row[-1], None)
            first += count

    z, v = np.array(samples["z"]), np.array(samples["v"])
    s_all, u_all = (np.array(samples[name]).reshape(times, balls) for name in "su")
    columns = list(np.array(log).reshape(-1, 10).T)
    labels = (f"damper{d + 1}/{k + 1}" for d, count in enumerate(rows) for k in range(count))
    return Run(
        RunArrays(
            time=np.linspace(0, duration, times),
            points=("cavity",) if fixed else ("mass",),
            balls=tuple(labels),
            dampers=tuple(f"damper{d + 1}" for d in range(len(rows))),
            loads=() if fixed else ("half-sine",),
            displacement=z[:, None],
            velocity=v[:, None],
            ball_damper=damper_of,
            ball_centre=centre,
            clearance=np.full(len(rows), clearance),
            ball_position=s_all + centre,
            ball_velocity=u_all,
            relative_position=s_all + centre - z[:, None],
            relative_velocity=u_all - v[:, None],
            load=np.zeros((times, 0)) if fixed else np.array(samples["force"])[:, None],
            mode_frequency=np.zeros(0) if fixed else np.array([sqrt(STIFFNESS / MASS) / (2 * pi)]),
            mode_energy=np.zeros((times, 0)) if fixed else np.array(samples["e"])[:, None],
            ball_energy=0.5 * BALL_MASS * u_all**2,
            load_work=np.array(samples["work"]),
            viscous_loss=np.array(samples["viscous"]),
            normal_loss=np.array(samples["lost"]).reshape(times, len(rows)),
            impacts={
                "damper": columns[0].astype(int),
                "contact": columns[1].astype(int),
                "time": columns[2],
                "approach_speed": columns[3],
                "restitution": columns[4],
                "separation_speed": columns[5],
                "duration": columns[6],
                "peak_overlap": columns[7],
                "peak_force": columns[8],
                "energy_lost": columns[9],
                "complete": np.ones(len(log), bool),
            },
        ),
        CASE,
        PROVENANCE,
        status=status,
        message=message,
        counts={"impacts": len(log), "flights": len(log) + 1},
        wall_time=1.25e-3,
    )
