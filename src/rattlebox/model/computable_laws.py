"""Checks that the coefficients of contact laws are finite for the bodies of a case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from .dampers import ImpactDamper
from .errors import Hint, at
from .methods import Method
from .modes import ModalModel
from .particle_damper import ParticleDamper
from .stops import Stop

_NOT_COMPUTABLE = "cannot be computed for bodies of these sizes, masses and moduli"
_USUAL = "numbers of usual sizes"


def check_laws(damper: ImpactDamper, modes: ModalModel, method: Method) -> None:
    """Check that the coefficients of the contact laws are finite for their pairs of bodies."""
    for number, pair in enumerate(damper.pairs(modes.effective_mass(damper.point))):
        between = 0 < number < len(damper.balls) and damper.ball_contact is not None
        law = damper.ball_contact if between and damper.ball_contact is not None else damper.contact
        with at("ball_contact" if between else "contact"), _raise_if_not_finite():
            # A striker without a radius has one that is not a number, and so have laws that need it.
            sized = not any(np.isnan(body.radius).any() for body in (pair.below, pair.above))
            if sized or method.hard_restitution(law, pair) is None:
                _, values = law.coefficients(pair)
                if not sized and not all(np.isfinite(value).all() for value in values.values()):
                    raise Hint(
                        f"the contact law {law.kind!r} follows from the radius of the bodies, and the striker has none",
                        'radius = "0.5 m" of the striker, or a law with a contact time or a stiffness',
                    )
                _check_finite(values)
            if law.impact_restitution is not None:
                with at("restitution"):
                    _, values = law.impact_restitution.coefficients(pair)
                    _check_finite(values)


def check_stop_law(stop: Stop, modes: ModalModel, method: Method) -> None:
    """Check that the contact law of a stop is finite; laws of spheres need its radius and material."""
    pair = stop.pair(modes)
    with at("contact"):
        try:
            with _raise_if_not_finite():
                if method.hard_restitution(stop.contact, pair) is None:
                    _check_finite(stop.contact.coefficients(pair)[1])
        except Hint as hint:
            if not hint.complaint.startswith(_NOT_COMPUTABLE) or stop.is_sized:
                raise
            raise Hint(
                f"the contact law {stop.contact.kind!r} follows from radius and material, and the stop has not both",
                'radius = "20 mm" and material = "steel" of the stop, or a law with a stiffness',
            ) from None
        if stop.contact.impact_restitution is not None:
            with at("restitution"), _raise_if_not_finite():
                _check_finite(stop.contact.impact_restitution.coefficients(pair)[1])


def check_particle_laws(damper: ParticleDamper) -> None:
    """Check that the coefficients of all laws of a particle damper are finite for their pairs of bodies."""
    for entry in damper.contact_table.entries:
        with at(*entry.place), _raise_if_not_finite():
            _check_finite(damper.softened(entry)[1])
            _check_finite(damper.softened_friction(entry)[1])
            _check_finite(damper.rolling_of(entry).coefficients())
            if entry.contact.impact_restitution is not None:
                with at("restitution"):
                    _check_finite(entry.contact.impact_restitution.coefficients(entry.pair)[1])


@contextmanager
def _raise_if_not_finite() -> Iterator[None]:
    """Raise if a formula divides by zero or overflows."""
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            yield
    except ArithmeticError:
        raise Hint(_NOT_COMPUTABLE, _USUAL) from None


def _check_finite(values: Mapping[str, Any]) -> None:
    """Raise if a coefficient is not finite."""
    for name, value in values.items():
        if not np.isfinite(value).all():
            raise Hint(f"{_NOT_COMPUTABLE}: its {name.replace('_', ' ')} is not finite", _USUAL)
