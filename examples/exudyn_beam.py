"""Particles on a flexible beam in Exudyn
======================================

For users of Exudyn: a box of balls at the tip of a flexible beam.

Exudyn integrates a cantilever of ANCF elements with an empty box as tip mass, Rattlebox the balls in the box; after each
step they exchange the velocity of the tip and the force of the balls. For the small deflections here the beam is linear,
so that `rb.simulate` checks the result. Needs `pip install '.[examples]'`.

:doc:`/how-to/stepper` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "coupling"]

from itertools import pairwise

import exudyn as exu
import matplotlib.pyplot as plt
import numpy as np
from exudyn.itemInterface import (
    LoadForceVector,
    MarkerNodeCoordinate,
    MarkerNodePosition,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
    ObjectConnectorCoordinate,
    ObjectMassPoint2D,
)

import rattlebox as rb

LENGTH, BOX = 0.4, 0.2  # of the beam, m; mass of the empty box, kg
BEAM = rb.Beam(length=LENGTH, bending_stiffness="108 N m^2", mass_per_length="1.413 kg/m", tip_mass=BOX)
PUSH, PUSHED = 20.0, 5e-3  # N, s
STEP, DURATION, ELEMENTS = 1e-4, 0.25, 6


def balls(**place):
    """Return a hundred steel balls. The beam moves along x, gravity is along z."""
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=100),
        cavity=rb.Box(size=("36 mm", "30 mm", "30 mm")),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.2,
        softening=1000,
        **place,
    )


def coupled(damped=True, step=STEP):
    """Return times and displacements of the tip, by Exudyn with Rattlebox [s], [m]."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    places = np.linspace(0, LENGTH, ELEMENTS + 1)
    nodes = [system.AddNode(NodePoint2DSlope1(referenceCoordinates=[x, 0, 1, 0])) for x in places]
    for pair in pairwise(nodes):
        beam = ObjectANCFCable2D(
            length=LENGTH / ELEMENTS,
            massPerLength=BEAM.mass_per_length,
            bendingStiffness=BEAM.bending_stiffness,
            axialStiffness=3.6e7,
            nodeNumbers=list(pair),
        )
        system.AddObject(beam)
    ground = system.AddMarker(MarkerNodeCoordinate(nodeNumber=system.AddNode(NodePointGround()), coordinate=0))
    for coordinate in (0, 1, 3):  # position, and slope across
        clamped = system.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        system.AddObject(ObjectConnectorCoordinate(markerNumbers=[ground, clamped]))
    system.AddObject(ObjectMassPoint2D(mass=BOX, nodeNumber=nodes[-1]))
    tip = system.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    load = system.AddLoad(LoadForceVector(markerNumber=tip))
    system.Assemble()
    motion = rb.Harmonic(amplitude="3 mm", frequency="20 Hz")
    damper, force = rb.Stepper(balls(), motion=motion, velocity=(0, 0, 0)), 0.0  # the beam starts at rest
    times, path = [0.0], [0.0]

    def before_step(system, end):
        """Apply the force of the last step in the step that ends at a time."""
        nonlocal force
        now = system.systemData.GetTime()
        if now > damper.time:  # not so if Exudyn repeats a step
            velocity = system.GetNodeOutput(nodes[-1], exu.OutputVariableType.Velocity)[1]
            force = damper.advance(now, velocity=(velocity, 0, 0)).force[0]
            times.append(now)
            path.append(system.GetNodeOutput(nodes[-1], exu.OutputVariableType.Displacement)[1])
        push = PUSH if end < PUSHED + step / 2 else 0.0
        system.SetLoadParameter(load, "loadVector", [0, push + force * damped, 0])
        return True

    system.SetPreStepUserFunction(before_step)
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(DURATION / step)
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.relativeTolerance = 1e-6
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solution.file.write = False
    assert system.SolveDynamic(settings)
    return np.array(times), np.array(path)


def whole_run(damped=True):
    """Return the same by `rb.simulate`."""
    push = rb.Record(times=[0, PUSHED, PUSHED * (1 + 1e-9), DURATION], values=[PUSH, PUSH, 0, 0], point="tip")
    dampers = (balls(point="tip"),) if damped else ()
    run = rb.simulate(rb.Case(structure=BEAM, load=push, dampers=dampers, duration=DURATION), progress=False)
    return run.motion.time.values, run.motion.displacement.sel(point="tip").values


def rms(result):
    """Return the RMS displacement [m]."""
    time, displacement = result
    return np.sqrt(np.trapezoid(displacement**2, time) / time[-1])


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    own, bare, whole = coupled(), coupled(damped=False), whole_run()
    remaining, difference = rms(own) / rms(bare), rms(own) / rms(whole) - 1
    print(f"RMS {100 * remaining:.0f} % of that without balls; rb.simulate differs by {100 * abs(difference):.1f} %")
    assert 0.45 < remaining < 0.55 and abs(difference) < 0.03  # 4 % between random packings
    figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
    axes.plot(bare[0], 1e3 * bare[1], "0.7", label="without balls")
    axes.plot(own[0], 1e3 * own[1], label="Exudyn with Rattlebox")
    axes.plot(whole[0], 1e3 * whole[1], ":", lw=1.6, label="rb.simulate")
    axes.set(xlabel="Time (s)", ylabel="Displacement of the tip (mm)", xlim=(0, DURATION))
    axes.set_ylim(top=3.6)
    axes.legend(ncols=3, loc="upper right")
    figure.savefig("exudyn_beam.png", dpi=200)


if __name__ == "__main__":
    main()
