"""Which tolerances matter
=======================

For users who must know which tolerances matter: sensitivity of an impact damper to four parameters.

Among clearance, restitution, load and initial position, the restitution has the largest influence on the share of the energy
that the impacts dissipate.

:doc:`/how-to/sensitivity` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "sensitivity"]

import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(diameter="50 mm", material="steel"),
        gap="0.4 mm",
        contact=rb.Tsuji(restitution=0.6),
    ),
    load=rb.HalfSine(amplitude="5 kN", duration="1 ms"),
    duration="4 s",
)
result = rb.sensitivity(
    case,
    {
        "damper.gap": ("0.2 mm", "1.2 mm"),
        "damper.contact.restitution": (0.3, 0.9),
        "load.amplitude": ("4 kN", "6 kN"),
        "damper.start": (-1, 1),
    },
    ["impact_share", "peak_contact_force"],
    n=128,
)
rb.plot_sensitivity(result).savefig("sensitivity.png")
shares = result.total.sel(measure="impact_share")
print(f"largest total index of the impact share: {float(shares.max()):.2f}, {shares.idxmax().item()}")
assert shares.idxmax() == "damper.contact.restitution"
