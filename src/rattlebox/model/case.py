"""Cases: complete descriptions of a run, as objects and as files."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationError, field_validator, model_validator

from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.exceptions import CaseError, DataError, ResourceError
from rattlebox._util.frozen import complete
from rattlebox._util.html import code_block, paragraph
from rattlebox._util.narrow import instance

from .also_accepts import AlsoAccepts
from .any_signal import AnySignal
from .any_structure import AnyStructure
from .as_written import with_texts
from .base import Part, vocabulary
from .case_tree import relative, shortened, with_files, without_empty
from .computable_laws import check_laws, check_particle_laws, check_stop_law
from .dampers import ImpactDamper
from .elementwise import Vector
from .errors import Hint, at, translate
from .files import read_text, read_toml
from .harmonics import Harmonic, SineSweep
from .materials import Material, materials
from .matrices import Matrices
from .methods import AnyMethod, Dem, EventDriven, Newton, Output
from .modes import ModalModel
from .particle_case import direction_of_base
from .particle_damper import ParticleDamper
from .paths import replaced
from .shocks import Shock
from .signals import Sampled, Signal, Unit, as_several, signals_in
from .stops import Stop
from .structures import Shaker
from .tuned_mass import TunedMass, with_tuned_masses
from .units import MOST_MEMORY, PositiveTime, Whole


def _kind_of_damper(value: object) -> str:
    """Return the kind of a damper; by default it follows from the fields."""
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    has_particles = isinstance(value, dict) and not value.keys().isdisjoint(("particles", "cavity", "packing"))
    return str(kind or ("particle" if has_particles else "impact"))


AnyDamper = Annotated[
    Annotated[ImpactDamper, Tag("impact")] | Annotated[ParticleDamper, Tag("particle")],
    Discriminator(_kind_of_damper),
]


_Place = tuple[str | int, ...]


def _placed(signals: Iterable[Signal], *field: str) -> Iterator[tuple[_Place, Signal]]:
    """Yield the place in the case of each signal of a field, and the signal."""
    for index, signal in enumerate(signals):
        yield (*field, index), signal


class Case(Part):
    """A structure, its loads and dampers, and the settings of a run.

    Parameters
    ----------
    structure
        SDOF, Modal, Matrices, Beam, Plate, ShearBuilding, Fixed or Shaker.
    damper, dampers
        One ImpactDamper or ParticleDamper, several of one kind, or none.
    tuned_mass, tuned_masses
        One TunedMass, several, or none; with or without dampers.
    stop, stops
        One Stop, several, or none; with or without impact dampers.
    load, loads
        Forces on the structure: one signal, several (they add), or none.
    base
        Acceleration of the base: one signal, several, or none.
    duration
        Length of the run [s].
    method
        Numerical method; default EventDriven, or Dem with particle dampers.
    output
        Times of the output.
    name
        Label that is stored with the result.
    seed
        Label that is stored with the result, an integer from 0 to 2^63 - 1. A run itself uses no random numbers.

    Raises
    ------
    CaseError
        If a value is invalid, or values are inconsistent.

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="1 kg", frequency="10 Hz", damping_ratio=0.01, displacement="1 mm")
    >>> case = rb.Case(structure=structure, duration="1 s")
    >>> run = rb.simulate(case)
    """

    field_names: ClassVar[tuple[str, ...]] = ("",)
    aliases: ClassVar[dict[str, str]] = {
        "damper": "dampers",
        "tuned_mass": "tuned_masses",
        "stop": "stops",
        "load": "loads",
    }
    name: str = ""
    structure: AnyStructure
    dampers: Annotated[tuple[AnyDamper, ...], BeforeValidator(as_several), AlsoAccepts()] = ()
    tuned_masses: Annotated[tuple[TunedMass, ...], BeforeValidator(as_several), AlsoAccepts()] = ()
    stops: Annotated[tuple[Stop, ...], BeforeValidator(as_several), AlsoAccepts()] = ()
    loads: Annotated[tuple[AnySignal, ...], signals_in("N"), AlsoAccepts()] = ()
    base: Annotated[tuple[AnySignal, ...], signals_in("m/s^2"), AlsoAccepts()] = ()
    duration: PositiveTime
    method: AnyMethod = Field(default_factory=EventDriven)
    output: Output = Field(default_factory=Output)
    seed: Annotated[Whole, Field(ge=0, le=2**63 - 1)] = 0  # the range of integers in result files

    @model_validator(mode="before")
    @classmethod
    def _expand_aliases(cls, values: object) -> Any:
        return cls.expand_aliases(values) if isinstance(values, dict) else values

    @model_validator(mode="after")
    def _check_consistency(self) -> Case:
        complete(
            self,
            loads=self._signals_in_unit("loads", "N", "a load"),
            base=self._signals_in_unit("base", "m/s^2", "the base"),
        )
        if self.particle_dampers and "method" not in self.model_fields_set:
            complete(self, method=Dem())
        self._check_signals()
        self._check_directions()
        self._check_size()
        names: set[str] = set()
        for index, damper in enumerate(self.dampers):
            with at("dampers", index):
                for each in damper.each():
                    label = each.label(len(names))
                    if label in names:
                        raise Hint(f"two dampers are called {label!r}", "different names")
                    names.add(label)
                if isinstance(damper, ImpactDamper):
                    self._check_clearance(damper)
                    self._check_starts(damper)
                    check_laws(damper, self.modes, self.method)
                else:
                    check_particle_laws(damper)
        self._check_stops(names)
        return self

    def _signals_in_unit(self, field: str, unit: Unit, place: str) -> tuple[Signal, ...]:
        """Return the signals of a field in its unit."""
        signals = []
        for index, signal in enumerate(getattr(self, field)):
            with at(field, index):
                signals.append(signal.placed((unit,), place))
        return tuple(signals)

    def _motions(self) -> Iterator[tuple[_Place, Signal]]:
        """Yield the place and signal of each motion of the base, or of a shaker, which has no other base."""
        yield from _placed(self.base, "base")
        yield from _placed(self.shaker_motion, "structure", "motion")

    def _check_signals(self) -> None:
        modes = self.modes
        for numbers in (modes.decay, modes.stiffness, modes.q0, modes.p0, *modes.shapes.values()):
            if not np.isfinite(numbers).all():
                raise Hint("the modes are not finite", "masses and stiffnesses of usual sizes", ["structure"])
        for place, signal in (*_placed(self.loads, "loads"), *self._motions()):
            with at(*place):
                if isinstance(signal, Sampled):
                    self._check_record(signal)
                if place[0] != "loads" and signal.point is not None:
                    raise Hint("a motion of the base acts on the whole base, not at a point", "no point", ["point"])
        if self.loads and not modes.decay.size:
            raise Hint(
                f"a load cannot move a {self.structure.kind} structure",
                "motion of a shaker, or base",
                ["loads", 0],
            )
        for index, signal in enumerate(self.loads):
            with at("loads", index, "point"):
                modes.point(signal.point)
            with at("loads", index):
                modes.shape(signal.point, signal.direction)
        if self.base and modes.participation is None:
            if isinstance(self.structure, Matrices):
                raise Hint(
                    "a base motion needs the influence, the motion of each degree of freedom with the base along x, y and z",
                    "three rows of numbers, 1 for a degree of freedom that moves with the base",
                    ["structure", "influence"],
                )
            raise Hint(
                "a base motion needs the participation of each mode",
                "one number for each mode, phi^T M r in kg^1/2",
                ["structure", "participation"],
            )
        if self.base and isinstance(self.structure, Shaker):
            raise Hint("a shaker is its own base", "add the signal to its motion", ["base"])

    def _check_directions(self) -> None:
        """Check that dampers, method, output and directions of motion are consistent."""
        if self.particle_dampers:
            self._check_particles()
            self._check_snapshots()
            return
        if self.output.walls:
            raise Hint(
                "walls are recorded of a particle damper, and the case has none", "walls = false", ["output", "walls"]
            )
        if self.output.snapshots is not None:
            raise Hint(
                "snapshots need a particle damper, and the case has none", "rate or times", ["output", "snapshots"]
            )
        if isinstance(self.method, Dem):
            raise Hint(
                "dem computes particle dampers, and the case has none"
                if not self.dampers
                else "dem computes particle dampers, not impact dampers",
                'kind = "event_driven", or a ParticleDamper',
                ["method"],
            )
        motions = list(self._motions())
        for place, signal in motions:
            if signal.direction != motions[0][1].direction:
                raise Hint(
                    "without particle dampers all motions are along one line",
                    "the same direction for all, or none",
                    [*place, "direction"],
                )
        if self.base and self.modes.spatial:
            raise Hint(
                f"the point {min(self.modes.spatial)!r} moves in 3-D, and the base of a case without particle dampers"
                " has no direction",
                "points that move along one line, with one participation for each mode",
                ["base"],
            )

    def _check_particles(self) -> None:
        """Raise if the parts of a case with particle dampers are inconsistent."""
        first = self.particle_dampers[0]
        if self.impact_dampers:
            raise Hint(
                "impact dampers and particle dampers cannot be in one case",
                'damper.in_space("x") in place of each ImpactDamper, a ball in a box of the 3-D engine',
                ["dampers"],
            )
        if not isinstance(self.method, Dem):
            raise Hint(f"{self.method.kind} computes impact dampers only", 'kind = "dem"', ["method"])
        if self.output.times is not None:
            times = self.sample_times()
            even = np.linspace(0.0, self.duration, times.size)
            if np.abs(times - even).max() > 1e-6 * even[1]:
                raise Hint(
                    "particles move in equal steps: output times must be evenly spaced, together with 0 and the end",
                    "a rate",
                    ["output", "times"],
                )
        for index, damper in enumerate(self.dampers):
            damper = instance(damper, ParticleDamper)
            with at("dampers", index):
                if damper.gravity != first.gravity:
                    raise Hint(
                        f"gravity must be the same for all dampers of a case; another one has {list(first.gravity)} m/s^2",
                        "the same gravity",
                        ["gravity"],
                    )
                if self.base or self.shaker_motion:
                    damper.check_base("a load in place of the base motion")
                for number, point in enumerate(damper.points or (damper.point,)):
                    with at(*(("points", number) if damper.points else ("point",))):
                        self.modes.space_shape(point, damper.direction)
        if self.base and not self.modes.spatial and len({damper.direction for damper in self.particle_dampers}) > 1:
            raise Hint(
                "a structure whose points move along lines has one direction, but its dampers have several",
                "mode shapes of three components, or the same direction",
                ["dampers"],
            )
        for place, signal in self._motions():
            with at(*place):
                direction_of_base(self.particle_dampers, signal)

    def _check_snapshots(self) -> None:
        """Raise if a snapshot is after the end of the run."""
        times = self.output.snapshots if isinstance(self.output.snapshots, tuple) else ()
        if late := [time for time in times if time > self.duration * (1 + 1e-9)]:
            raise Hint(
                f"the snapshot at {late[0]:.6g} s is after the end of the run at {self.duration:.6g} s",
                "times up to the end, or a longer duration",
                ["output", "snapshots"],
            )

    def _check_size(self) -> None:
        """Raise if the output would exceed the memory."""
        samples = self.duration * (self.output.rate or 0.0)
        columns = 20 + 6 * self.modes.decay.size + 10 * sum(len(damper.balls) for damper in self.impact_dampers)
        columns += 50 * len(self.particle_dampers)
        if 8 * samples * columns > MOST_MEMORY:
            raise ResourceError(
                f"{samples:.3g} samples would take {8e-9 * samples * columns:.0f} GB",
                f'rate = "{MOST_MEMORY / (80 * columns * self.duration):.1g} Hz", or times',
                ["output", "rate"],
            )

    def _check_record(self, record: Sampled) -> None:
        if not record.covers(self.duration):
            times, _ = record.polyline()
            first, last = times[0], times[-1]
            enough = f'duration = "{last:.10g} s", or a longer record' if last > 0 else "a longer record"
            raise Hint(
                f"the record covers {first:.10g} s to {last:.10g} s, the run 0 to {self.duration:.10g} s",
                enough if record.covers(last) else record.start_advice,
                record.where,
            )

    def _check_clearance(self, damper: ImpactDamper) -> None:
        if isinstance(self.method, Newton) and damper.clearance <= 1e-14 * damper.row:
            raise Hint(
                "hard impacts need a clearance greater than zero: balls in contact with both walls never fly",
                'gap = "1 um", or the EventDriven method, whose contacts have a duration',
                ["gap"],
            )

    def _check_starts(self, damper: ImpactDamper) -> None:
        """Raise if a ball starts inside a wall of the cavity."""
        with at("point"):
            self.modes.shape(damper.point)
        half = 0.5 * damper.clearance
        for number, place in enumerate(damper.positions0, start=1):
            depth = abs(place) - half
            if depth > 4e-16 * half:
                raise Hint(
                    f"ball {number} would start {1e3 * depth:.4g} mm inside a wall of the cavity",
                    f"start between -1 and 1, or a length up to {1e3 * half:.6g} mm from the centre of the cavity",
                    ["start"],
                )

    def _check_stops(self, names: set[str]) -> None:
        """Raise if a stop cannot be computed; `names` are those of the dampers."""
        for index, stop in enumerate(self.stops):
            with at("stops", index):
                if self.particle_dampers:
                    raise Hint(
                        "stops are computed with impact dampers, not with particle dampers",
                        "an ImpactDamper with balls of the same mass in place of the particles, or no stop",
                    )
                if not self.modes.decay.size:
                    raise Hint(f"a {self.structure.kind} structure does not move against a stop", "an SDOF, or modes")
                with at("point"):
                    point = self.modes.point(stop.point)
                if stop.other is not None:
                    with at("other"):
                        if self.modes.point(stop.other, "other") == point:
                            raise Hint("a point cannot meet itself", "another point, or none for the ground")
                stop.check(self.modes)
                if isinstance(self.method, Newton) and stop.side == "both" and not stop.gap > 0:
                    raise Hint(
                        "hard impacts need room between stops on both sides: the point would never move",
                        'gap = "1 um", or the EventDriven method, whose contacts have a duration',
                        ["gap"],
                    )
                check_stop_law(stop, self.modes, self.method)
                for each in stop.each(index):
                    if each.name in names:
                        raise Hint(f"two dampers or stops are called {each.name!r}", "different names", ["name"])
                    names.add(each.name)

    @property
    def impact_dampers(self) -> tuple[ImpactDamper, ...]:
        """The impact dampers, identical ones (`ImpactDamper.number`) one by one."""
        return tuple(each for damper in self.dampers if isinstance(damper, ImpactDamper) for each in damper.each())

    @property
    def each_stop(self) -> tuple[Stop, ...]:
        """The stops, those on both sides (`Stop.side`) one by one."""
        return tuple(each for index, stop in enumerate(self.stops) for each in stop.each(index))

    @property
    def contact_names(self) -> list[str]:
        """Damper and place of each contact of a 1-D run, counted over all impact dampers; then the names of the stops."""
        names = []
        for index, damper in enumerate(self.impact_dampers):
            between = (f"ball {k} - {k + 1}" for k in range(1, len(damper.balls)))
            names += [f"{damper.label(index)} ({place})" for place in ("trailing wall", *between, "leading wall")]
        return [*names, *(stop.name for stop in self.each_stop)]

    def cavity_displacement(self, damper: ImpactDamper) -> Any:
        """Return the displacement of the cavity of an impact damper at the start [m], an array in a batch of variants."""
        shape, displacement = self.modes.shape(damper.point), self.modes.q0
        axes = max(shape.ndim, displacement.ndim)  # 1, or more in a batch of variants
        pair = [part.reshape(*part.shape, *(1,) * (axes - part.ndim)) for part in (shape, displacement)]
        return np.sum(pair[0] * pair[1], axis=0)

    @cached_property
    def particle_dampers(self) -> tuple[ParticleDamper, ...]:
        """The particle dampers, identical ones (`ParticleDamper.number`) one by one."""
        return tuple(each for damper in self.dampers if isinstance(damper, ParticleDamper) for each in damper.each())

    @property
    def cell_groups(self) -> list[tuple[ParticleDamper, Vector]]:
        """The cavities that are drawn together: a damper, and the places of its cells relative to the point, (k, 3) [m]."""
        dampers = [damper for damper in self.dampers if isinstance(damper, ParticleDamper)]
        return [(damper, group) for damper in dampers for group in damper.groups()]

    @property
    def shaker_motion(self) -> tuple[Signal, ...]:
        """The signals of the motion of a shaker; empty for other structures."""
        return self.structure.motion if isinstance(self.structure, Shaker) else ()

    @cached_property
    def modes(self) -> ModalModel:
        """The structure in modal form, with its tuned masses."""
        with np.errstate(all="ignore"):  # _check_signals raises for non-finite numbers
            return with_tuned_masses(self.structure.modes(), self.tuned_masses)

    def base_acceleration(self) -> tuple[Signal, ...]:
        """Return the signals that accelerate the base [m/s^2]."""
        signals = []
        for signal in (*self.base, *self.shaker_motion):
            signals.append(signal.acceleration() if isinstance(signal, Harmonic) and signal.unit == "m" else signal)
        return tuple(signals)

    @property
    def harmonics(self) -> dict[str, Harmonic]:
        """Harmonic loads and motions by their path; the first one defines the cycle of the case."""
        signals = {"loads": self.loads, "base": self.base, "structure.motion": self.shaker_motion}
        return {
            f"{name}[{number}]": signal
            for name, group in signals.items()
            for number, signal in enumerate(group)
            if isinstance(signal, Harmonic)
        }

    def sample_times(self, start: float = 0.0) -> Vector:
        """Return the times of the output that are known before the run, (T,) [s].

        Parameters
        ----------
        start
            First time, of a run that continues another one [s].

        Returns
        -------
        (T,) float
            Times from `start` to the end [s].
        """
        if self.output.is_chosen:
            return self.output.sample_times(self.duration, start=start)
        signals = (*self.loads, *self.base_acceleration())
        even = self.output.sample_times(self.duration, self._fastest(), start)
        pulses = [s.start + np.linspace(0, s.duration, 21) for s in signals if isinstance(s, Shock)]
        times = np.unique(np.concatenate([even, *pulses]))
        return times[(times >= start) & (times <= self.duration)]

    def even_samples(self, start: float = 0.0) -> int:
        """Return the number of equal intervals between samples from `start` [s] on, for a run in equal steps.

        If the rate does not divide the duration, the next larger rate that does is used.
        """
        return self.output.sample_times(self.duration, self._fastest(), start).size - 1

    def _fastest(self) -> float:
        """Return the highest frequency of modes, harmonics and sweeps [Hz]."""
        signals = (*self.loads, *self.base_acceleration())
        frequencies = [signal.frequency for signal in signals if isinstance(signal, Harmonic)]
        sweeps = [signal for signal in signals if isinstance(signal, SineSweep)]
        frequencies += [max(sweep.first_frequency, sweep.last_frequency) for sweep in sweeps]
        frequencies += list(np.sqrt(self.modes.stiffness) / (2 * np.pi))
        return max(frequencies, default=0.0)

    # ---- files

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Case:
        """Read a case file.

        Parameters
        ----------
        path
            A TOML file. Files named in it are relative to its folder.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        CaseError
            If the file cannot be read, or a value is invalid.
        """
        file = Path(path)
        try:
            content = read_text(file)
        except DataError as error:
            raise error.restated(CaseError) from None
        return cls.from_toml(content, source=str(file), folder=file.parent)

    @classmethod
    def from_toml(cls, content: str, *, source: str = "case", folder: Path | None = None) -> Case:
        """Read a case from the text of a case file.

        Parameters
        ----------
        content
            Text in TOML.
        source
            Name of the file in messages.
        folder
            Folder of files named in it; default the current folder.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        CaseError
            If a value is invalid.
        """
        return cls.from_dict(read_toml(content, source), source=source, folder=folder)

    @classmethod
    def from_dict(cls, given: dict[str, Any], *, source: str = "case", folder: Path | None = None) -> Case:
        """Return the case of the parsed content of a case file.

        Parameters
        ----------
        given
            Tables of the file.
        source
            Name of the file in messages.
        folder
            Folder of files named in it; default the current folder.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        CaseError
            If a value is not allowed.
        """
        case, _ = case_and_materials(given, source=source, folder=folder)
        return case

    def __repr__(self) -> str:
        counts = Counter(
            type(part).__name__ for part in (*self.dampers, *self.tuned_masses, *self.stops, *self.loads, *self.base)
        )
        parts = ", ".join([type(self.structure).__name__, *(f"{n} {kind}" for kind, n in counts.items())])
        return f"<Case{f' {self.name!r}' if self.name else ''}: {parts}; {self.duration:g} s, {self.method.kind}>"

    def _repr_html_(self) -> str:
        return paragraph(repr(self)[1:-1]) + code_block(self.short_toml())

    def short_toml(self, most: int = 8000, name_of: Callable[[str], str] = str) -> str:
        """Return the case as the text of a case file, with long lists shortened, for reading only.

        Parameters
        ----------
        most
            Largest number of characters; the rest is omitted.
        name_of
            Function of the full path of a file that returns the name to write.

        Returns
        -------
        str
            Text in TOML.
        """
        text = self._toml(name_of, shortened)
        return text if len(text) <= most else f"{text[:most]}\n... {len(text) - most} more characters"

    def replaced(self, values: Mapping[str, object]) -> Case:
        """Return a copy of the case with other values.

        A new value removes alternatives that exclude it: a damping ratio replaces a damping.

        Parameters
        ----------
        values
            New values by path, in the notation of case files:
            `case.replaced({"damper.friction": 0.5, "duration": "2 s"})`.

        Returns
        -------
        Case
            The new case.

        Raises
        ------
        CaseError
            If a path does not exist, or the new case is invalid.
        """
        return replaced(self, values)

    def without_dampers(self) -> Case:
        """Return the case of the same structure without its dampers, to compare with.

        Tuned masses and stops stay.

        Returns
        -------
        Case
            The new case. A method for particles is replaced by the default method without them.

        Raises
        ------
        CaseError
            If the structure needs the dampers, such as for the directions of two motions of its base.
        """
        changes: dict[str, object] = {"dampers": ()}
        if self.particle_dampers:
            output = self.output.model_copy(update={"snapshots": None, "walls": False})
            changes |= {"method": EventDriven(), "output": output}
        return self.replaced(changes)

    def to_toml(self, name_of: Callable[[str], str] = str) -> str:
        """Return the text of a case file of this case, with the full paths of other files.

        Parameters
        ----------
        name_of
            Function of the full path of a file that returns the name to write, such as `os.path.basename`.

        Returns
        -------
        str
            Text in TOML; `Case.from_toml` reads an equal case from it.
        """
        return self._toml(name_of)

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Write a case file of this case, with the paths of other files relative to its folder.

        Quantities keep the text from which they were read: "5 mm" stays "5 mm". A quantity that has no text, or has been
        changed since, is written in SI units.

        Parameters
        ----------
        path
            File to write; the new file replaces an existing one when it is complete.

        Raises
        ------
        DataError
            If the file cannot be written.
        ResourceError
            If no space is left on the disk.
        """
        folder = Path(path).absolute().parent
        text = self._toml(lambda file: relative(file, folder), as_written=True)
        with atomic_write(path, "make room and write the case again") as name:
            name.write_text(text, encoding="utf-8")

    def _toml(
        self, name_of: Callable[[str], str], change: Callable[[Any], Any] = lambda data: data, as_written: bool = False
    ) -> str:
        import tomli_w

        data = self.model_dump(mode="json", exclude_none=True, exclude_defaults=False)
        if as_written:
            data = with_texts(self, data)
        return tomli_w.dumps(change(without_empty(with_files(data, name_of))))

    @classmethod
    def json_schema(cls) -> dict[str, Any]:
        """Return the JSON Schema of case files.

        Returns
        -------
        dict
            Schema in JSON types.
        """
        schema = cls.model_json_schema(mode="validation")
        properties = schema["properties"]
        properties["materials"] = {
            "type": "object",
            "description": "materials of this file, by name, used like those of the library",
            "additionalProperties": {"$ref": "#/$defs/Material"},
        }
        return schema


def case_and_materials(
    given: dict[str, Any], *, source: str = "case", folder: Path | None = None
) -> tuple[Case, dict[str, Material]]:
    """Return the case of the parsed content of a case file, and the materials that the file defines, by name."""
    if not given:
        raise CaseError(f"{source}: the file is empty", "rattlebox demo, which writes two case files")
    if "case" in given and "structure" not in given:
        raise CaseError(f"{source}: this is a study of a case, not a case", f"rattlebox sweep {source}")
    try:
        library = _Library.model_validate({"materials": given.get("materials", {})})
        values = {key: value for key, value in given.items() if key != "materials"}
        if folder is not None:
            values = with_files(values, lambda file: str(folder / file))
        return Case.model_validate(values, context=library.materials), library.materials
    except ValidationError as error:
        raise translate(error, source, vocabulary(), given) from None


class _Library(Part):
    """The materials of a case file."""

    field_names: ClassVar[tuple[str, ...]] = ("",)
    materials: dict[str, Material] = Field(default_factory=dict)

    @field_validator("materials", mode="before")
    @classmethod
    def _named(cls, own: object) -> Any:
        if not isinstance(own, dict):
            return own
        for name in own:
            if name in materials():
                raise Hint("the library already has a material of this name", "another name", [name])
        return {name: {"name": name, **item} if isinstance(item, dict) else item for name, item in own.items()}


def first_contacts(case: Case) -> list[int]:
    """Return the number of the first contact of each impact damper and stop in `Case.contact_names`."""
    counts = [*(len(damper.balls) + 1 for damper in case.impact_dampers), *(1 for _ in case.each_stop)]
    return [0, *np.cumsum(counts).tolist()][:-1]
