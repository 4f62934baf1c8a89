"""Clearance and mass of an impact damper
======================================

For users who choose clearance and mass of an impact damper: Pareto front of added mass and settling time.

Each design has to serve pulses of two strengths and three initial positions of the ball.

:doc:`/how-to/design` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "design"]

import rattlebox as rb

# %%
# A structure is hit by a pulse; a ball in a cavity shall stop it soon.

case = rb.Case(
    structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(diameter="50 mm", material="steel"),
        gap="0.4 mm",
        contact=rb.Tsuji(restitution=0.6),
    ),
    load=rb.HalfSine(amplitude="5 kN", duration="1 ms"),
    duration="6 s",
)

# %%
# Two variables, two objectives. Each trial runs six cases, two pulses with three starts of the ball; the worst one counts.

result = rb.design(
    case,
    {
        "damper.gap": ("0.1 mm", "2 mm"),
        "damper.ball.diameter": ["20 mm", "30 mm", "40 mm", "50 mm", "60 mm"],
    },
    ["added_mass", "settling_time"],
    levels={"load.amplitude": ["2 kN", "5 kN"]},
    starts=3,
    trials=40,
)

# %%
# The front: for each mass the fastest design. The last one becomes a case file.

rb.plot_design(result).savefig("design.png")
rb.Case.from_toml(result.case.item(-1)).to_file("fastest.toml")
fastest = result.isel(trial=result.front.values[-1])
print(f"{float(fastest.added_mass):.2f} kg of ball settle the structure within {float(fastest.settling_time):.1f} s")

# %%
# The number of the page.

assert abs(float(fastest.settling_time) - 1.8) < 0.1
