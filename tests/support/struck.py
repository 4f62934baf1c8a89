"""A structure with an impact damper under a pulse, as a case and as the text of a case file."""

from typing import Any

import rattlebox as rb

CASE_FILE = """
[structure]
kind = "sdof"
mass = "20 kg"
stiffness = "80 kN/m"
damping = "25.3 N s/m"

[load]
kind = "half_sine"
amplitude = "5 kN"
duration = "1 ms"

[damper]
gap = "0.4 mm"
ball = { radius = "33.17 mm", material = "steel" }
contact = { kind = "tsuji", restitution = 0.9 }
"""
"""Case file without its duration."""


def struck(**changes: Any) -> rb.Case:
    """Return the case of a smaller ball with other fields."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="30 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.HalfSine(amplitude="5 kN", duration="1 ms"),
        "duration": "1 s",
    }
    return rb.Case(**(parts | changes))
