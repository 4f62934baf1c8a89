"""Find what decides how much of a pulse an impact damper takes up: clearance, restitution, load, or where the ball lies."""

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
found = rb.sensitivity(
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
rb.plot_sensitivity(found).savefig("sensitivity.png")
