"""Frequency response up and down
==============================

For users who sweep a test frequency: frequency response of an impact damper, up and down.

Between 28 and 29.7 Hz two steady motions coexist: in the sweep up the ball stays at rest, in the sweep down it works.

:doc:`/how-to/frequency_response` explains it.
"""

# sphinx_gallery_tags = ["lecture", "response"]

import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="30 Hz"),
    duration="1 s",
    method=rb.Newton(),
)
response = rb.frequency_response(case, rb.linspace("28 Hz", "31 Hz", 31))

if __name__ == "__main__":
    at_29_hz = response.impacts_per_cycle.isel(level=0).sel(frequency=29.0, method="nearest")
    for direction in ("up", "down"):
        print(f"{direction}: {float(at_29_hz.sel(direction=direction)):.1f} impacts per cycle at 29 Hz")
    assert at_29_hz.sel(direction="up") == 0 and at_29_hz.sel(direction="down") > 2
    rb.plot_frequency_response(response).savefig("frequency_response.png")
