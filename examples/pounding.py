"""Two buildings that pound
========================

For structural engineers with buildings side by side: forces and accelerations of a collision, and the gap that avoids it.

A stiff building of three storeys and a soft one of five stand side by side. In an earthquake the roof of the lower one meets
the third floor of the higher one. The figure shows both motions, and the largest force over the gap.

:doc:`/how-to/stops` explains it.
"""

# sphinx_gallery_tags = ["building", "study"]

from pathlib import Path

import numpy as np

import rattlebox as rb

# %%
# Both buildings are one structure: their matrices are blocks, and all floors move with the ground.

low = rb.ShearBuilding(masses=["40 t"] * 3, stiffnesses=["70 MN/m"] * 3)
high = rb.ShearBuilding(masses=["60 t"] * 5, stiffnesses=["45 MN/m"] * 5)


def chain(masses, stiffness):
    """Return mass and stiffness matrix of storeys of equal stiffness [kg], [N/m]."""
    count = len(masses)
    k = stiffness * (2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    k[-1, -1] = stiffness
    return np.diag(masses), k


def blocks(*parts):
    """Return a matrix with these blocks on its diagonal."""
    size = sum(len(part) for part in parts)
    whole, first = np.zeros((size, size)), 0
    for part in parts:
        whole[first : first + len(part), first : first + len(part)] = part
        first += len(part)
    return whole


parts = [chain(low.masses, low.stiffnesses[0]), chain(high.masses, high.stiffnesses[0])]
pair = rb.Matrices(
    M=blocks(*(m for m, _ in parts)),
    K=blocks(*(k for _, k in parts)),
    damping_ratio="4 %",
    influence=[1] * 8,
    points={"low roof": 2, "high 3": 5, "high roof": 7},
)

# %%
# Concrete on concrete: a linear contact of 1 GN/m with a restitution of 0.65. The higher building is on the leading side.

case = rb.Case(
    structure=pair,
    stop=rb.Stop(
        point="low roof", other="high 3", gap="20 mm", contact=rb.Linear(stiffness="1 GN/m", restitution=0.65)
    ),
    base=rb.Record(file=Path(__file__).parent / "data" / "ground_motion.at2"),
    duration="23.9 s",
    output=rb.Output(rate="200 Hz"),
)
run = rb.simulate(case)
log = run.impacts
print(f"{len(run.arrays.impacts)} impacts, the strongest {1e-6 * float(log.peak_force.max()):.1f} MN")

# %%
# The gap is an axis of a sweep. A wider gap that is still closed can be worse: the buildings meet with more speed.

gaps = np.arange(5, 101, 5) * 1e-3
found = rb.sweep(
    case,
    {"stop.gap": gaps},
    measure=["peak_contact_force", "peak_acceleration", "impacts"],
    point="low roof",
    samples=4781,  # as many as in the run; accelerations are means over these 5 ms
)
free = float(gaps[found.impacts.values == 0].min())
alone = float(found.peak_acceleration[-1])
print(
    f"no collision from a gap of {1e3 * free:.0f} mm; acceleration up to {found.peak_acceleration.max() / alone:.1f} times"
)

with rb.plots.figure_style("page"):
    figure = rb.plots.StyledFigure("page", 0.42)
    left, right = figure.subplots(1, 2)
    late = (run.arrays.time > 4) & (run.arrays.time < 9)
    for name, shift, colour in zip(("low roof", "high 3"), (0.0, 20.0), rb.plots.SERIES_COLOURS, strict=False):
        x = run.arrays.displacement[late, run.arrays.points.index(name)]
        left.plot(run.arrays.time[late], 1e3 * x + shift, color=colour, label=name)
    rb.plots.label(left, "x", "Time", "s")
    rb.plots.label(left, "y", "Surface of the floor", "mm")
    right.plot(1e3 * gaps, 1e-6 * found.peak_contact_force, marker="o", label="largest contact force")
    right.set_ylim(bottom=0)
    rb.plots.label(right, "x", "Gap", "mm")
    rb.plots.label(right, "y", "Largest contact force", "MN")
    rb.plots.legend_above(left)
    figure.savefig("pounding.png")

# %%
# The force of each impact has an upper bound: that of two free bodies of the effective masses of both floors.

assert run.ok and run.energy_residual < 1e-9 and free == 0.09
force = found.peak_contact_force.values
assert force[gaps == 0.045] > 1.2 * force[gaps == 0.02]
contact, pair_of_floors = case.stops[0].contact, case.stops[0].pair(case.modes)
bound = np.sqrt(pair_of_floors.mass * contact.stiffness) * float(log.approach_speed.max())
assert float(log.peak_force.max()) < 1.05 * bound
