"""Case -> the plain numbers that the core reads (core/python/read.hpp). Everything goes by name, in SI units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.methods import Newton, TwoStep
from rattlebox.model.pairs import Pair, contact_pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel
    from rattlebox.model.restitutions import Restitution

Packed = dict[str, Any]


def pack(case: Case) -> Packed:
    """Pack a case for the core.

    Parameters
    ----------
    case
        What the user describes.

    Returns
    -------
    dict
        Modes, loads, dampers, contacts, sample times and settings, as core/python/read.hpp reads them.
    """
    modes = case.modes
    return {
        "mode_decay": _array(modes.decay),
        "mode_stiffness": _array(modes.stiffness),
        "mode_displacement": _array(modes.q0),
        "mode_velocity": _array(modes.p0),
        "loads": _loads(case, modes),
        "dampers": [
            {
                "clearance": damper.clearance,
                "gravity": damper.gravity,
                "shape": _array(modes.shape(damper.point)),
                "mass": _array(damper.masses),
                "position": _array(damper.positions0),
                "velocity": _array(damper.velocities0),
            }
            for damper in case.dampers
        ],
        "contacts": [
            _contact(case, index, pair, place)
            for index in range(len(case.dampers))
            for place, pair in enumerate(contact_pairs(case, index))
        ],
        "sample_times": _array(case.sample_times()),
        "settings": {"duration": case.duration, **_method(case)},
    }


def _array(values: Any) -> NDArray[np.float64]:
    return np.ascontiguousarray(values, dtype=np.float64)


def _loads(case: Case, modes: ModalModel) -> list[Packed]:
    loads = [
        {**signal.coefficients(), "shape": _array(modes.shape(signal.point)), "base": False} for signal in case.loads
    ]
    base = [
        {**signal.coefficients(), "shape": -_participation(modes), "base": True} for signal in case.base_acceleration()
    ]
    return loads + base


def _participation(modes: ModalModel) -> NDArray[np.float64]:
    return _array(np.zeros(0) if modes.participation is None else modes.participation)


def _contact(case: Case, damper_index: int, pair: Pair, place: int) -> Packed:
    damper = case.dampers[damper_index]
    between_balls = 0 < place < len(damper.balls)
    law = damper.ball_contact if between_balls and damper.ball_contact is not None else damper.contact
    if isinstance(case.method, Newton):
        restitution: Restitution | None = case.method.restitution or law.equivalent_restitution(pair)
        normal: Packed = {"law": "linear", "stiffness": 1.0, "mass": pair.mass, "damping": 0.0}
    else:
        restitution = law.restitution
        name, values = law.coefficients(pair)
        normal = {"law": name, **values}
    if restitution is None:
        rebound: Packed = {"law": "constant", "e": 1.0}
    else:
        name, values = restitution.coefficients(pair)
        rebound = {"law": name, **{key: _value(value) for key, value in values.items()}}
    return {"mass": pair.mass, "normal": normal, "restitution": rebound}


def _value(value: Any) -> Any:
    return value if isinstance(value, (int, float)) else _array(value)


def _method(case: Case) -> Packed:
    method = case.method
    if isinstance(method, TwoStep):
        return {
            "method": "two_step",
            "dt_flight": method.dt_flight,
            "dt_contact": method.dt_contact,
            "adaptive_inner": method.inner == "dopri5",
        }
    if isinstance(method, Newton):
        return {"method": "newton", "stick": method.stick, "max_events": method.max_events}
    return {
        "method": "event_driven",
        "tolerance": method.tolerance,
        "max_events": method.max_events,
        "collocation": method.collocation,
    }
