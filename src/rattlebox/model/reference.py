"""The reference case: one steel ball on a structure that a short pulse hits."""

from __future__ import annotations

from .case import Case
from .contacts import Contact, Tsuji
from .dampers import ImpactDamper, Sphere
from .methods import EventDriven, Newton, Output, TwoStep
from .shocks import HalfSine
from .structures import SDOF


def reference_case(
    contact: Contact | None = None,
    *,
    start: float = 0.0,
    amplitude: float = 5000.0,
    duration: float = 10.0,
    output: Output | None = None,
    method: EventDriven | TwoStep | Newton | None = None,
) -> Case:
    """Return the case of the reference paper: 1.2 kg of steel in a cavity on 20 kg, hit by a half sine of 1 ms.

    The paper is "Energy Dissipation in Particle-based Impact Damper Systems: Investigation based on Elasto-plastic
    impact model".

    Parameters
    ----------
    contact
        Contact law; default the constant restitution of the paper, `Tsuji(alpha=0.006313, ending="zero_overlap")`.
    start
        Reduced start position of the ball, from -1 (trailing wall) to 1 (leading wall).
    amplitude
        Amplitude of the half sine [N].
    duration
        Duration of the run [s].
    output
        Output times; default those of `Output()`.
    method
        Method; default `EventDriven()`.

    Returns
    -------
    Case
        The case; `Case.replaced` changes any other value.

    Examples
    --------
    >>> import rattlebox as rb
    >>> elasto_plastic = rb.Tsuji(restitution=rb.JacksonGreen(), ending="zero_overlap")
    >>> run = rb.simulate(rb.reference_case(elasto_plastic, duration=0.1))
    >>> run.status
    'finished'
    """
    damper = ImpactDamper(
        balls=(Sphere(radius=33.17e-3, material="steel"),),
        gap=0.4e-3,
        start=start,
        contact=contact or Tsuji(alpha=0.006313, ending="zero_overlap"),
    )
    return Case(
        structure=SDOF(mass=20.0, stiffness=80e3, damping=25.3),
        dampers=(damper,),
        loads=(HalfSine(amplitude=amplitude, duration=1e-3),),
        duration=duration,
        output=output or Output(),
        method=method or EventDriven(),
    )
