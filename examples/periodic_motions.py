"""Frequency response with unstable branches and an isola
======================================================

For researchers of non-smooth dynamics: all periodic motions with two and four impacts a cycle of an impact damper over the
frequency, stable or not.

The symmetric motion with two impacts a cycle is stable below and above the resonance and loses its symmetry in two
pitchforks; between them it is unstable. The symmetric motions with four impacts are on a closed curve, an
isola without a connection to the others. Runs end on its two stable parts, below and above the peak.

:doc:`/how-to/periodic_motions` explains it.
"""

# sphinx_gallery_tags = ["lecture", "response"]

import numpy as np

import rattlebox as rb

CASE = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
    method=rb.Newton(),
    duration="3 s",
)
FREQUENCIES = ("24 Hz", "42 Hz")
FOUR_IMPACTS = [-2.778e-3, -0.2005, -3.195e-3, -0.6344]
"""State near a motion with four impacts a cycle: displacement and velocity of the mass, then of the ball."""

if __name__ == "__main__":
    main = rb.continue_orbit(rb.find_orbit(CASE), "load.frequency", FREQUENCIES)
    pitchfork = main.specials[1]
    crooked = main.switch(pitchfork)
    near = rb.find_orbit(CASE.replaced({"load.frequency": "30.5 Hz"}), near=FOUR_IMPACTS, period=1)
    isola = rb.continue_orbit(near, "load.frequency", FREQUENCIES)
    branches = {"two impacts": main, "four impacts, an isola": isola, "not symmetric": crooked}
    rb.plot_branches(branches, size="page").savefig("periodic_motions.png")
    print(main)
    print(isola)
    assert [point.kind for point in main.specials] == ["pitchfork", "pitchfork", "torus"]
    assert isola.is_closed
    # A run that starts on the stable part of the isola stays there.
    stable = int(np.flatnonzero(isola.data.stable.values.astype(bool))[3])
    orbit = isola.orbit(stable)
    run = orbit.run(300)
    last = run.arrays.time > run.arrays.time[-1] - 5 * orbit.period
    reached = 0.5 * np.ptp(run.arrays.displacement[last, 0])
    assert abs(reached / orbit.amplitudes["mass"] - 1) < 1e-3
    assert abs(pitchfork.value - 32.080534) < 1e-6
