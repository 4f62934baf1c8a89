"""The compiled core of Rattlebox."""

from collections.abc import Callable, Sequence
import enum
from typing import Annotated, Self, overload

import numpy
import numpy.typing
from numpy.typing import NDArray


class Varies(enum.Enum):
    """How a field can depend on the variant of a batch."""

    number = 0

    vector = 1

    never = 2

class Node:
    """
    A struct with read-only fields that is passed between Python and the core.
    """

    @staticmethod
    def fields() -> dict[str, Varies]:
        """
        Return the names of the fields, and how each can depend on the variant of a batch.
        """

    def replace(self, **changes: object) -> Self:
        """Return a copy with other values of some fields."""

    def __repr__(self) -> str: ...

class NormalForce(Node):
    """A normal contact law for one pair."""

    def resized(self, radius: float, mass: float, new_radius: float, new_mass: float) -> NormalForce:
        """
        Return the law of a pair of another size, given R* [m] and m* [kg] of both pairs.
        """

    def contact_time(self, speed: float) -> float:
        """Return the duration of an undamped impact at this speed [s]."""

    def largest_overlap(self, speed: float) -> float:
        """Return an upper bound of the overlap of an impact at this speed [m]."""

    def damping_ratio(self, restitution: float, speed: float) -> float:
        """
        Return the damping ratio of an impact with this restitution and speed; 0 for a law with hysteresis.
        """

    @property
    def needs_restitution(self) -> bool:
        """Whether the dashpot follows from a restitution."""

    @property
    def elastic_coefficient(self) -> float:
        """The coefficient of the elastic force, in the unit of the law."""

    @property
    def effective_mass(self) -> float:
        """Effective mass of the pair [kg]."""

class HertzTsujiForce(NormalForce):
    """The law 'hertz_tsuji' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], alpha: float | numpy.typing.NDArray[numpy.float64] | None = None, zero_overlap: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def alpha(self) -> float | numpy.typing.NDArray[numpy.float64] | None: ...

    @property
    def zero_overlap(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class LinearForce(NormalForce):
    """The law 'linear' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], damping: float | numpy.typing.NDArray[numpy.float64] | None = None, zero_overlap: float | numpy.typing.NDArray[numpy.float64], fixed_contact_time: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping(self) -> float | numpy.typing.NDArray[numpy.float64] | None: ...

    @property
    def zero_overlap(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def fixed_contact_time(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class ThorntonForce(NormalForce):
    """The law 'thornton' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], radius: float | numpy.typing.NDArray[numpy.float64], modulus: float | numpy.typing.NDArray[numpy.float64], yield_pressure: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def radius(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def modulus(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def yield_pressure(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class PowerForce(NormalForce):
    """The law 'power' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], exponent: float | numpy.typing.NDArray[numpy.float64], damping: float | numpy.typing.NDArray[numpy.float64], damping_exponent: float | numpy.typing.NDArray[numpy.float64], zero_overlap: float | numpy.typing.NDArray[numpy.float64], hertz: float | numpy.typing.NDArray[numpy.float64], fixed_restitution: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def exponent(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping_exponent(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def zero_overlap(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def hertz(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def fixed_restitution(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class TabulatedForce(NormalForce):
    """The law 'tabulated' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], loading_knots: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], loading_coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], loading_integral: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], unloading_knots: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], unloading_coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], unloading_integral: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def loading_knots(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def loading_coefficients(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def loading_integral(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def unloading_knots(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def unloading_coefficients(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def unloading_integral(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class ExternalForce(NormalForce):
    """The law 'external' for one pair; see its header in core/contact."""

    def __init__(self, *, stiffness: float | numpy.typing.NDArray[numpy.float64], mass: float | numpy.typing.NDArray[numpy.float64], c2: float | numpy.typing.NDArray[numpy.float64], c3: float | numpy.typing.NDArray[numpy.float64], c4: float | numpy.typing.NDArray[numpy.float64], c5: float | numpy.typing.NDArray[numpy.float64], c6: float | numpy.typing.NDArray[numpy.float64], c7: float | numpy.typing.NDArray[numpy.float64], number: float | numpy.typing.NDArray[numpy.float64], zero_overlap: float | numpy.typing.NDArray[numpy.float64], tangential_share: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c2(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c3(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c4(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c5(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c6(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def c7(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def number(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def zero_overlap(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def tangential_share(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def normal_law(law: str, coefficients: dict[str, object]) -> NormalForce:
    """Return a law by its name, with its coefficients by their names."""

def add_external_law(address: int) -> int:
    """
    Add a normal law of another package, given the address of its table; return its number.
    """

def external_law_name(number: int) -> str:
    """Return the name of a law of another package."""

def normal_law_names() -> list[str]:
    """Return the names of the normal laws of the core."""

class TangentialForce(Node):
    """A tangential contact law for one pair."""

    def stiffness_at(self, radius: float, mass: float, normal_stiffness: float, overlap: float) -> float:
        """Return the tangential stiffness of a pair at an overlap [N/m]."""

    @property
    def friction_coefficient(self) -> float:
        """Friction over normal force."""

    @property
    def damping_share(self) -> float:
        """Damping ratio of the tangential dashpot over that of the normal one."""

class MindlinFriction(TangentialForce):
    """The law 'mindlin' for one pair; see its header in core/contact."""

    def __init__(self, *, friction: float | numpy.typing.NDArray[numpy.float64], shear_modulus: float | numpy.typing.NDArray[numpy.float64], damping: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def friction(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def shear_modulus(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class SpringFriction(TangentialForce):
    """The law 'spring' for one pair; see its header in core/contact."""

    def __init__(self, *, friction: float | numpy.typing.NDArray[numpy.float64], stiffness: float | numpy.typing.NDArray[numpy.float64], ratio: float | numpy.typing.NDArray[numpy.float64], damping: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def friction(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def ratio(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def tangential_law(law: str, coefficients: dict[str, object]) -> TangentialForce:
    """Return a law by its name, with its coefficients by their names."""

class Restitution(Node):
    """A restitution law for one pair."""

    def at(self, speeds: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
        """
        Return the restitution at each speed; NaN outside the range of the law.
        """

class ConstantRestitution(Restitution):
    """The law 'constant' for one pair; see its header in core/contact."""

    def __init__(self, *, e: float | numpy.typing.NDArray[numpy.float64], maximum: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def e(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def maximum(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class TableRestitution(Restitution):
    """The law 'table' for one pair; see its header in core/contact."""

    def __init__(self, *, maximum: float | numpy.typing.NDArray[numpy.float64], speeds: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> None: ...

    @property
    def maximum(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def speeds(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def values(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class JacksonGreenRestitution(Restitution):
    """The law 'jackson_green' for one pair; see its header in core/contact."""

    def __init__(self, *, critical_speed: float | numpy.typing.NDArray[numpy.float64], yield_strain: float | numpy.typing.NDArray[numpy.float64], extrapolate: float | numpy.typing.NDArray[numpy.float64], maximum: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def critical_speed(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def yield_strain(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def extrapolate(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def maximum(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class ThorntonRestitution(Restitution):
    """The law 'thornton' for one pair; see its header in core/contact."""

    def __init__(self, *, yield_speed: float | numpy.typing.NDArray[numpy.float64], maximum: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def yield_speed(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def maximum(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class JohnsonRestitution(Restitution):
    """The law 'johnson' for one pair; see its header in core/contact."""

    def __init__(self, *, speed_scale: float | numpy.typing.NDArray[numpy.float64], maximum: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def speed_scale(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def maximum(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def restitution_law(law: str, coefficients: dict[str, object]) -> Restitution:
    """Return a law by its name, with its coefficients by their names."""

class RollingResistance(Node):
    """Rolling resistance of one pair."""

    def __init__(self, *, coefficient: float | numpy.typing.NDArray[numpy.float64], stiffness: float | numpy.typing.NDArray[numpy.float64], damping: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def coefficient(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def stiffness(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def damping(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def restitution_of_damping(damping_ratio: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], zero_overlap: bool) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
    """Return the restitution that each damping ratio gives."""

def damping_of_restitution(restitution: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], zero_overlap: bool) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
    """Return the damping ratio that gives each restitution."""

class HalfSine(Node):
    """A half-sine pulse: N or m/s^2, rad/s, rad, s, s."""

    def __init__(self, *, amplitude: float | numpy.typing.NDArray[numpy.float64], frequency: float | numpy.typing.NDArray[numpy.float64], phase: float | numpy.typing.NDArray[numpy.float64], start: float | numpy.typing.NDArray[numpy.float64], stop: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def amplitude(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def frequency(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def phase(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def start(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def stop(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Harmonic(Node):
    """A harmonic: N or m/s^2, rad/s, rad, s, s."""

    def __init__(self, *, amplitude: float | numpy.typing.NDArray[numpy.float64], frequency: float | numpy.typing.NDArray[numpy.float64], phase: float | numpy.typing.NDArray[numpy.float64], start: float | numpy.typing.NDArray[numpy.float64], stop: float | numpy.typing.NDArray[numpy.float64]) -> None: ...

    @property
    def amplitude(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def frequency(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def phase(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def start(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def stop(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Record(Node):
    """A piecewise-linear signal through points, zero outside."""

    def __init__(self, *, times: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> None: ...

    @property
    def times(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def values(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Load(Node):
    """
    A signal and the force on each mode per unit of it; for a base acceleration, minus the participation factor.
    """

    def __init__(self, *, signal: HalfSine | Harmonic | Record, shape: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], base: bool) -> None: ...

    @property
    def signal(self) -> HalfSine | Harmonic | Record: ...

    @property
    def shape(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def base(self) -> bool: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Method(enum.Enum):
    event_driven = 0

    newton = 1

    two_step = 2

class Settings(Node):
    """Settings of a run of the 1-D engine."""

    def __init__(self, *, method: Method, duration: float | numpy.typing.NDArray[numpy.float64], tolerance: float | numpy.typing.NDArray[numpy.float64] = 1e-12, max_events: int = 10000000, stick: float | numpy.typing.NDArray[numpy.float64] = 1e-06, dt_flight: float | numpy.typing.NDArray[numpy.float64] = 5e-06, dt_contact: float | numpy.typing.NDArray[numpy.float64] = 3e-08, adaptive_inner: bool = False, collocation: bool = True, contact_samples: int = 0, keep_end: bool = False) -> None: ...

    @property
    def method(self) -> Method: ...

    @property
    def duration(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def tolerance(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def max_events(self) -> int: ...

    @property
    def stick(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def dt_flight(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def dt_contact(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def adaptive_inner(self) -> bool: ...

    @property
    def collocation(self) -> bool: ...

    @property
    def contact_samples(self) -> int: ...

    @property
    def keep_end(self) -> bool: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Damper(Node):
    """
    An impact damper with its balls, whose positions are relative to the closely packed, centred row; without balls a stop with half of the clearance as its gap.
    """

    def __init__(self, *, clearance: float | numpy.typing.NDArray[numpy.float64], gravity: float | numpy.typing.NDArray[numpy.float64], shape: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], base: float | numpy.typing.NDArray[numpy.float64] = 0.0) -> None: ...

    @property
    def clearance(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def gravity(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def shape(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mass(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def position(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def base(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Contact(Node):
    """The contact of two neighbours: effective mass and laws."""

    def __init__(self, *, mass: float | numpy.typing.NDArray[numpy.float64], normal: NormalForce, restitution: Restitution) -> None: ...

    @property
    def mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def normal(self) -> NormalForce: ...

    @property
    def restitution(self) -> Restitution: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Problem(Node):
    """
    A problem of the 1-D engine. Arrays that broadcast over a grid in place of numbers make it a batch.
    """

    def __init__(self, *, settings: Settings, mode_decay: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_coupling: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_displacement: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], loads: Sequence[Load], dampers: Sequence[Damper], contacts: Sequence[Contact], sample_times: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], start_state: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)] | None = None, changed: bool = False) -> None: ...

    @property
    def settings(self) -> Settings: ...

    @property
    def mode_decay(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_stiffness(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_coupling(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_displacement(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_velocity(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def loads(self) -> list[Load]: ...

    @property
    def dampers(self) -> list[Damper]: ...

    @property
    def contacts(self) -> list[Contact]: ...

    @property
    def sample_times(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def start_state(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)] | None: ...

    @property
    def changed(self) -> bool: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Status(enum.IntEnum):
    """How a run ended."""

    finished = 0

    law_domain = 1

    too_many_events = 2

    step_too_small = 3

    interrupted = 4

    not_finite = 5

    energy_error = 6

    escaped = 7

    no_rebound = 8

    refused = 9

    false_contact = 10

class Impacts(Node):
    """The impact log, one row for each impact."""

    def __init__(self, *, damper: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], contact: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], approach_speed: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], restitution: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], separation_speed: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], duration: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], peak_overlap: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], peak_force: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], energy_lost: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], complete: Annotated[NDArray[numpy.bool_], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    @property
    def damper(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def contact(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def approach_speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def restitution(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def separation_speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def duration(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def peak_overlap(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def peak_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def energy_lost(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def complete(self) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Counts(Node):
    """Counts of the work of a run."""

    def __init__(self, *, events: int, flights: int, contact_steps: int, rejected_steps: int, collocated: int, extrapolated: int, sticks: int, simultaneous_impacts: int) -> None: ...

    @property
    def events(self) -> int: ...

    @property
    def flights(self) -> int: ...

    @property
    def contact_steps(self) -> int: ...

    @property
    def rejected_steps(self) -> int: ...

    @property
    def collocated(self) -> int: ...

    @property
    def extrapolated(self) -> int: ...

    @property
    def sticks(self) -> int: ...

    @property
    def simultaneous_impacts(self) -> int: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class EndStates(Node):
    """
    States from which another run continues: at the end, and the last one that a longer run has, too.
    """

    def __init__(self, *, end: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu')], whole: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu')], motion: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], phases: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    @property
    def end(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def whole(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def motion(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def phases(self) -> Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Result(Node):
    """
    A run of the 1-D engine. `state` holds displacement and velocity of each mode, then positions and velocities of all balls; `chosen` is true for samples at times of the problem.
    """

    def __init__(self, *, time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], state: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], chosen: Annotated[NDArray[numpy.bool_], dict(shape=(None,), order='C', device='cpu')], load_work: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], base_work: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], viscous_loss: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], normal_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], plastic_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], contact_energy: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], cavity_force: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], impacts: Impacts, states: EndStates, counts: Counts, status: Status, energy_residual_limit: float, permitted_error: float, energy_rounding: float, stopped_at: float, stopped_value: float, stopped_contact: int, seconds: float) -> None: ...

    @property
    def time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def state(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def chosen(self) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def load_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def base_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def viscous_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def normal_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def plastic_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def contact_energy(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def cavity_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def impacts(self) -> Impacts: ...

    @property
    def states(self) -> EndStates: ...

    @property
    def counts(self) -> Counts: ...

    @property
    def status(self) -> Status: ...

    @property
    def energy_residual_limit(self) -> float: ...

    @property
    def permitted_error(self) -> float: ...

    @property
    def energy_rounding(self) -> float: ...

    @property
    def stopped_at(self) -> float: ...

    @property
    def stopped_value(self) -> float: ...

    @property
    def stopped_contact(self) -> int: ...

    @property
    def seconds(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class RecordedRun(Node):
    """
    A window of a recorded run. Arrays that the requested measures do not need may be empty, and numbers NaN.
    """

    def __init__(self, *, time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], displacement: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], start_acceleration: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], end_acceleration: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], base_acceleration: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], damper_force: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], base_force: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], motion: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], gravity: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], load_work: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], base_work: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], viscous_loss: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], contact_loss: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], period: float = float('nan'), loss_per_cycle: float = float('nan'), mass: float = float('nan'), cavity_speed: float = float('nan'), effective_mass: float = float('nan'), damping_mass: float = float('nan')) -> None: ...

    @property
    def time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def displacement(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def start_acceleration(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def end_acceleration(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def base_acceleration(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def damper_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def base_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def motion(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def gravity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def load_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def base_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def viscous_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def contact_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def period(self) -> float: ...

    @property
    def loss_per_cycle(self) -> float: ...

    @property
    def mass(self) -> float: ...

    @property
    def cavity_speed(self) -> float: ...

    @property
    def effective_mass(self) -> float: ...

    @property
    def damping_mass(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Measure(Node):
    """Name, unit, meaning and requirements of a measure."""

    def __init__(self, *, name: str, unit: str, meaning: str, average: str, cyclic: bool, of_impacts: bool, of_samples: bool, of_base_force: bool, of_loss_in_cycle: bool, of_acceleration: bool, of_first_harmonic: bool) -> None: ...

    @property
    def name(self) -> str: ...

    @property
    def unit(self) -> str: ...

    @property
    def meaning(self) -> str: ...

    @property
    def average(self) -> str: ...

    @property
    def cyclic(self) -> bool: ...

    @property
    def of_impacts(self) -> bool: ...

    @property
    def of_samples(self) -> bool: ...

    @property
    def of_base_force(self) -> bool: ...

    @property
    def of_loss_in_cycle(self) -> bool: ...

    @property
    def of_acceleration(self) -> bool: ...

    @property
    def of_first_harmonic(self) -> bool: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def measures() -> list[Measure]:
    """Return the measures in the order of their table."""

def measure(run: RecordedRun, names: Sequence[str]) -> list[float]:
    """Return measures of a recorded run."""

most_batches: int = 64

def settled_after(time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], limit: float) -> float:
    """
    Return the time after which the magnitude of a signal is at most a limit; see `rattlebox.analysis.settling_time`.
    """

class Window(Node):
    """
    Equally spaced samples of each run from `start` to its end, in cycles of `period`, at a point with these mode shapes, which moves with the base if `base` is 1; the participation and the residual mass give the force on the base.
    """

    def __init__(self, *, start: float | numpy.typing.NDArray[numpy.float64], period: float | numpy.typing.NDArray[numpy.float64], shape: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], base: float | numpy.typing.NDArray[numpy.float64], participation: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], residual_mass: float | numpy.typing.NDArray[numpy.float64], samples: int) -> None: ...

    @property
    def start(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def period(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def shape(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def base(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def participation(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def residual_mass(self) -> float | numpy.typing.NDArray[numpy.float64]: ...

    @property
    def samples(self) -> int: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Block(Node):
    """Output of the variants of a batch, one row for each."""

    def __init__(self, *, status: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')], measures: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]], batches: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]], batch_length: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, displacement: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, velocity: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, relative_position: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')] | None, relative_velocity: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')] | None, state: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, last_time: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, last_approach_speed: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, last_contact: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None, runs: Sequence[Result]) -> None: ...

    @property
    def status(self) -> Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def measures(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]]: ...

    @property
    def batches(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]]: ...

    @property
    def batch_length(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def displacement(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def relative_position(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')] | None: ...

    @property
    def relative_velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')] | None: ...

    @property
    def state(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def last_time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def last_approach_speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def last_contact(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')] | None: ...

    @property
    def runs(self) -> list[Result]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def sweep(problem: Problem, grid: Sequence[int], start: int, stop: int, window: Window, measures: Sequence[str], batched: Sequence[str] = [], motion: bool = False, state: bool = False, last: int = 0, threads: int = 1, progress: Callable[[int], object] | None = None, times: Sequence[float] | None = None) -> Block | None:
    """
    Run the variants start to stop of a batch over a grid and return their output; None if `progress` returned False. With `times` the output holds the runs, too, with samples at these times.
    """

class NotLinear(enum.IntEnum):
    """Why a derivative does not exist."""

    none = 0

    simultaneous = 1

    grazing = 2

    kink = 3

    closed = 4

class Linearised(Node):
    """
    A run with derivatives of its state in the state at the start and in parameters, at fixed times.
    """

    def __init__(self, *, time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], state: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], rate: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], miss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], derivative: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], impacts: Impacts, phases: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')], counts: Counts, status: Status, refused: NotLinear, stopped_at: float, stopped_value: float, refused_at: float, stopped_contact: int, refused_contact: int) -> None: ...

    @property
    def time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def state(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def rate(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def miss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def derivative(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def impacts(self) -> Impacts: ...

    @property
    def phases(self) -> Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def counts(self) -> Counts: ...

    @property
    def status(self) -> Status: ...

    @property
    def refused(self) -> NotLinear: ...

    @property
    def stopped_at(self) -> float: ...

    @property
    def stopped_value(self) -> float: ...

    @property
    def refused_at(self) -> float: ...

    @property
    def stopped_contact(self) -> int: ...

    @property
    def refused_contact(self) -> int: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def linearise(problem: Problem, start: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')] | None, from_time: float, times: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], coarse: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], derivatives: bool = True) -> Linearised:
    """
    Run a problem of the 1-D engine from a state (None: that of the problem) at a time up to the last of `times`, with derivatives in the state at the start and in parameters. The problem is a batch of variants along one axis, of which the first runs; each row of `weights` is the derivative in one parameter as a sum over the variants, and each row of `coarse` is another one of lower order.
    """

class Partner(enum.IntEnum):
    """Body that a particle touches."""

    particle = 0

    wall = 1

class SolidForm(enum.Enum):
    rod = 0

    plate = 1

    ball = 2

    mesh = 3

class Solid(Node):
    """
    A body in a cavity, which is one wall, or a closed surface of triangles with normals out of the space of the particles, with a wall for each group of triangles. `size` is half of the edges of a plate, radius and half of the length of a rod, or the radius of a ball [m]; the third of the axes is along a rod.
    """

    def __init__(self, *, form: SolidForm, materials: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], labels: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], groups: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], encloses: bool, smooth: float, centre: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], size: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], axes: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> None: ...

    @property
    def form(self) -> SolidForm: ...

    @property
    def materials(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def labels(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def groups(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def encloses(self) -> bool: ...

    @property
    def smooth(self) -> float: ...

    @property
    def centre(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def size(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def axes(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def faces(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class SurfaceContacts(Node):
    """
    Contacts of spheres with solids: number of the sphere and of the wall, outward normal, and distance of the centre [m].
    """

    def __init__(self, *, point: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], solid: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], normal: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], distance: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    @property
    def point(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def solid(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def normal(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def distance(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

def crossing_triangles(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')]:
    """Return pairs of triangles that cross each other, a hundred at most."""

class Surfaces:
    """The solids of a cavity."""

    def __init__(self, solids: Sequence[Solid]) -> None: ...

    def distances(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]:
        """
        Return the distance of each point from the walls of the solids, positive where particles may be; infinity for walls of a surface of which another one is nearer.
        """

    def contacts(self, points: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], radii: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> SurfaceContacts:
        """Return the contacts of spheres, as a run has them."""

class WallForm(enum.Enum):
    plane = 0

    cylinder = 1

    sphere = 2

class Wall(Node):
    """
    A wall around the centre of a cavity: outward normal of a plane or axis of a cylinder, and distance or radius [m]. `label` is the number of its name; walls of one name are summed in results.
    """

    def __init__(self, *, form: WallForm, axis: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], offset: float, material: int, label: int = 0) -> None: ...

    @property
    def form(self) -> WallForm: ...

    @property
    def axis(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def offset(self) -> float: ...

    @property
    def material(self) -> int: ...

    @property
    def label(self) -> int: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Rotation(Node):
    """
    Rotation of a cavity about an axis at the distance `-arm` from its centre. From each knot on, the angle is a cubic polynomial with four coefficients, plus a sine.
    """

    def __init__(self, *, axis: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], arm: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], carries_structure: bool, knots: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], amplitude: float, frequency: float, phase: float) -> None: ...

    @property
    def axis(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def arm(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def carries_structure(self) -> bool: ...

    @property
    def knots(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def coefficients(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def amplitude(self) -> float: ...

    @property
    def frequency(self) -> float: ...

    @property
    def phase(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Cavity(Node):
    """
    A cavity and its particles. `particle_pair` and `wall_pair` are the indices of the laws of two species, and of a species and a wall material. `period` is the distance of the images of a particle along each axis, 0 if it is not periodic.
    """

    def __init__(self, *, shape: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], walls: Sequence[Wall], solids: Sequence[Solid] = [], period: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], position: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], spin: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], radius: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], inertia: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], species: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], particle_pair: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], wall_pair: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], rotation: Rotation | None = None) -> None: ...

    @property
    def shape(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def walls(self) -> list[Wall]: ...

    @property
    def solids(self) -> list[Solid]: ...

    @property
    def period(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def position(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def spin(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def radius(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def mass(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def inertia(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def species(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def particle_pair(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def wall_pair(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def rotation(self) -> Rotation | None: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class PairLaws(Node):
    """
    The laws of two species, or of a species and a wall, with R* [m] and m* [kg] of the pair that they hold for.
    """

    def __init__(self, *, normal: NormalForce, restitution: Restitution, tangential: TangentialForce, rolling: RollingResistance, radius: float, mass: float) -> None: ...

    @property
    def normal(self) -> NormalForce: ...

    @property
    def restitution(self) -> Restitution: ...

    @property
    def tangential(self) -> TangentialForce: ...

    @property
    def rolling(self) -> RollingResistance: ...

    @property
    def radius(self) -> float: ...

    @property
    def mass(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class DemProblem(Node):
    """
    A problem of the 3-D engine. Contacts older than `enduring` [s] count as enduring. Step 0 is at the time `origin` [s], and samples are taken `every` steps from `first_step` on. `each_wall` is whether forces and losses are also summed for each wall.
    """

    def __init__(self, *, dt: float, steps: int, every: int, enduring: float = float('inf'), origin: float = 0.0, first_step: int = 0, each_wall: bool = False, gravity: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], mode_decay: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_coupling: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_displacement: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mode_velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], loads: Sequence[Load], load_directions: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], cavities: Sequence[Cavity], pairs: Sequence[PairLaws]) -> None: ...

    @property
    def dt(self) -> float: ...

    @property
    def steps(self) -> int: ...

    @property
    def every(self) -> int: ...

    @property
    def enduring(self) -> float: ...

    @property
    def origin(self) -> float: ...

    @property
    def first_step(self) -> int: ...

    @property
    def each_wall(self) -> bool: ...

    @property
    def gravity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]: ...

    @property
    def mode_decay(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_stiffness(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_coupling(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_displacement(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def mode_velocity(self) -> Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]: ...

    @property
    def loads(self) -> list[Load]: ...

    @property
    def load_directions(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]: ...

    @property
    def cavities(self) -> list[Cavity]: ...

    @property
    def pairs(self) -> list[PairLaws]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class Records(Node):
    """
    Samples of a run of the 3-D engine: over samples, then modes, loads or cavities, then components or partners.
    """

    def __init__(self, *, time: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], q: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], p: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], load_work: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], base_work: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], viscous_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], kinetic: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], rotation: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], angle: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], speed: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], drive_work: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], potential: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], elastic: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], centre: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], momentum: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], force: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], moment: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], normal_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], plastic_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], sliding_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], rolling_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], contacts: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu')], wall_force: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], wall_moment: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], wall_impulse: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], wall_normal_force: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_normal_impulse: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_normal_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_plastic_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_sliding_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_rolling_loss: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], wall_impacts: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

    @property
    def time(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def q(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def p(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def load_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def base_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def viscous_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def kinetic(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def rotation(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def angle(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def drive_work(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def potential(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def elastic(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def centre(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def momentum(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def moment(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def normal_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def plastic_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def sliding_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def rolling_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def contacts(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def wall_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def wall_moment(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def wall_impulse(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')]: ...

    @property
    def wall_normal_force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_normal_impulse(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_normal_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_plastic_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_sliding_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_rolling_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def wall_impacts(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class CavityState(Node):
    """
    Particles of a cavity in the order of the case, and the displacement of the cavity.
    """

    def __init__(self, *, position: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], velocity: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], spin: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], displacement: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    @property
    def position(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def velocity(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def spin(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def displacement(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class DemState(Node):
    """The state at the last step whose forces are known."""

    def __init__(self, *, step: int, time: float, q: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], p: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], cavities: Sequence[CavityState]) -> None: ...

    @property
    def step(self) -> int: ...

    @property
    def time(self) -> float: ...

    @property
    def q(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def p(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def cavities(self) -> list[CavityState]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class ContactList(Node):
    """
    Contacts of a cavity, and the force on the first partner [N]; walls are numbered after the particles.
    """

    def __init__(self, *, first: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], second: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')], force: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

    @property
    def first(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def second(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class DemCounts(Node):
    """Counts and extremes of a run of the 3-D engine; arrays over cavities."""

    def __init__(self, *, steps: int, rebuilds: int, refreshes: int, extrapolated: int, candidates: int, memory_bytes: int, first_touches: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')], largest_overlap: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], largest_approach_speed: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], enduring_loss: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], seconds: float) -> None: ...

    @property
    def steps(self) -> int: ...

    @property
    def rebuilds(self) -> int: ...

    @property
    def refreshes(self) -> int: ...

    @property
    def extrapolated(self) -> int: ...

    @property
    def candidates(self) -> int: ...

    @property
    def memory_bytes(self) -> int: ...

    @property
    def first_touches(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')]: ...

    @property
    def largest_overlap(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def largest_approach_speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def enduring_loss(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]: ...

    @property
    def seconds(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

class StoppedAt(Node):
    """
    Place at which a run stopped: particle and wall by their numbers in the case, or -1.
    """

    def __init__(self, *, cavity: int, particle: int, wall: int, time: float, speed: float) -> None: ...

    @property
    def cavity(self) -> int: ...

    @property
    def particle(self) -> int: ...

    @property
    def wall(self) -> int: ...

    @property
    def time(self) -> float: ...

    @property
    def speed(self) -> float: ...

    @staticmethod
    def fields() -> dict[str, Varies]: ...

@overload
def pack_case(problem: Problem, alone: bool, velocity: Sequence[float], outputs: Sequence[Sequence[float]]) -> bytes:
    """Return the bytes of a case with impact dampers, for a stepper."""

@overload
def pack_case(problem: DemProblem, alone: bool, velocity: Sequence[float], outputs: Sequence[Sequence[float]]) -> bytes:
    """Return the bytes of a case with particle dampers, for a stepper."""

class Stepper:
    """Dampers that are advanced step by step."""

    def __init__(self, packed: bytes) -> None: ...

    def advance(self, length: float, inputs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> Status:
        """
        Advance by a step with accelerations of the attachment or values of the loads.
        """

    def advance_to_velocity(self, length: float, velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> Status:
        """Advance by a step at whose end the attachment has this velocity."""

    @property
    def force(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]:
        """Mean force by damper [N]."""

    @property
    def moment(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]:
        """Mean moment by damper [N m]."""

    @property
    def work(self) -> float: ...

    @property
    def loss(self) -> float: ...

    @property
    def stored(self) -> float: ...

    @property
    def largest_overlap(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
        """
        Largest overlap by contact of impact dampers [m], or by particle damper over the radius.
        """

    @property
    def largest_approach_speed(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
        """
        Largest speed of approach by contact of impact dampers, or by particle damper [m/s].
        """

    @property
    def start_jump(self) -> float:
        """
        Change of the attachment's velocity in the first step if it is not followed by another [m/s]; else 0.
        """

    @property
    def energy_residual(self) -> float:
        """Largest imbalance of the energies so far over the energy put in."""

    @property
    def status(self) -> Status: ...

    @property
    def stopped(self) -> tuple[int, int, float]:
        """
        Damper, its contact or particle, and the value of the status: where the stepper stopped.
        """

    @property
    def restitution(self) -> float: ...

    @property
    def friction(self) -> float: ...

    @property
    def gravity(self) -> list[float]: ...

    @property
    def time(self) -> float: ...

    @property
    def inputs(self) -> int: ...

    @property
    def components(self) -> int: ...

    @property
    def velocity(self) -> list[float]:
        """Velocity of the attachment [m/s]."""

    @property
    def displacement(self) -> list[float]:
        """Displacement of the attachment [m]."""

    def set_gravity(self, gravity: Sequence[float]) -> None: ...

    def outputs(self, velocity: bool = False) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')]:
        """Displacements or velocities of the output points."""

    def save(self) -> bytes:
        """Return the state."""

    def restore(self, state: bytes) -> None:
        """Continue from a saved state."""

class Dem:
    """A simulation of particle dampers, which is advanced in portions."""

    def __init__(self, problem: DemProblem) -> None: ...

    def run(self, until: int, progress: Callable[[int], object] | None = None) -> bool:
        """
        Run until the sample of step `until` is taken; return False if it was stopped before.
        """

    def records(self) -> Records:
        """Return the samples taken since the last call."""

    def state(self) -> DemState:
        """Return the state at the last step whose forces are known."""

    def contacts(self, cavity: int) -> ContactList:
        """Return the contacts at the step where the last call of `run` ended."""

    def counts(self) -> DemCounts:
        """Return counts and extremes since the start."""

    def stopped(self) -> StoppedAt:
        """Return where the run stopped."""

    def save(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu')]:
        """Return all that a bitwise restart needs."""

    def restore(self, bytes: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> None:
        """Continue from a saved state."""

    def restart(self, bytes: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> None:
        """
        Continue a run of the same case from its end; counts and extremes begin anew.
        """

    def continue_from(self, bytes: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)], dt: float) -> None:
        """
        Start from the last sample of a run with the same particles and structure; dt is the step of that run.
        """

    @property
    def status(self) -> Status: ...

    @property
    def step(self) -> int:
        """The next step."""

    @property
    def serial_steps(self) -> int:
        """Number of steps that ran on a single thread because of contention."""

    @property
    def threads(self) -> int: ...

    @threads.setter
    def threads(self, arg: int, /) -> None: ...

worst_energy_residual: float = 0.01

energy_at_rest: float = 1e-10

speed_at_rest: float = 1e-09

def simulate(problems: Sequence[Problem], threads: int = 1, progress: Callable[[int], object] | None = None) -> list[Result]:
    """
    Run problems of the 1-D engine and return their results. `progress` is called with the number of finished runs; False stops.
    """
