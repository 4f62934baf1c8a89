"""Place and number of dampers on a beam
=====================================

For users who choose place and number of dampers: the response of a beam at three levels, from the loss map of one ball.

The map is computed once. Six arrangements of balls on a clamped beam then take seconds; the best one is simulated at its
largest amplitude, which agrees within 5 %.

:doc:`/how-to/map_on_structure` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "map", "response"]

import rattlebox as rb

# %%
# One ball in a cavity is shaken at many amplitudes: its loss map. Without gravity two frequencies are enough.

ball = rb.ImpactDamper(
    ball=rb.Sphere(diameter="8 mm", material="steel"),
    gap="0.2 mm",
    velocity="0.1 m/s",
    contact=rb.Tsuji(restitution=0.6),
)
shaker = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="0.1 mm", frequency="100 Hz")),
    damper=ball,
    duration="1 s",
    method=rb.Newton(),  # hard impacts
)
loss_map = rb.loss_map(shaker, rb.geomspace("0.04 mm", "8 mm", 47), ["70 Hz", "110 Hz"], cycles=(200, 100))
loss_map.to_netcdf("ball.nc")  # the file for colleagues

# %%
# The beam is clamped at one end and pushed at the other; the map stands for one, two or four balls, in the middle or at
# the tip.

beam = rb.Beam(length="400 mm", material="steel", diameter="20 mm", damping_ratio=0.002)
levels = ["0.5 N", "1 N", "2 N"]
response = rb.response_from_map(
    beam, "ball.nc", level=levels, number=[1, 2, 4], at=["middle", "tip"], load_point="tip", point="tip"
)

# %%
# How much does each arrangement lower the peak, at three levels of the force?

if __name__ == "__main__":
    reduction = response.peak / response.bare_amplitude.max("frequency")
    for place in response["at"].values:
        for number in response.number.values:
            row = reduction.sel(at=place, number=number).values
            print(
                f"{number} at {place:6}: peak"
                + "".join(f" {100 * value:5.0f} %" for value in row)
                + " of the bare beam"
            )
    rb.plot_response_from_map(response, at="tip", number=4).savefig("map_on_structure.png")

# %%
# The best one is simulated in full near its peak.

if __name__ == "__main__":
    best = response.sel(at="tip", number=4, level=1.0)
    case = rb.Case(
        structure=beam,
        damper=ball.model_copy(update={"point": "tip", "number": 4}),
        load=rb.Harmonic(amplitude="1 N", frequency="80 Hz", point="tip"),
        duration="1 s",
        method=rb.Newton(),
    )
    near = [float(best.peak_frequency) * factor for factor in (0.997, 1.0, 1.003)]
    simulated = rb.frequency_response(case, near, direction="down", cycles=(300, 50), point="tip").amplitude.max()
    print(f"4 at the tip, 1 N: {1e3 * float(best.peak):.3f} mm from the map, {1e3 * float(simulated):.3f} mm simulated")
    assert abs(best.peak / simulated - 1) < 0.05
