"""The case: everything a run needs, in one object and one file."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationError, field_validator, model_validator

from rattlebox._util.atomic_io import atomic_write
from rattlebox._util.exceptions import CaseError, DataError, ResourceError
from rattlebox._util.html import code_block, paragraph

from .also_takes import AlsoTakes
from .any_signal import AnySignal
from .any_structure import AnyStructure
from .base import Part, vocabulary
from .dampers import ImpactDamper
from .elementwise import Vector
from .errors import Hint, at, translate
from .files import existing, read_toml
from .harmonics import Harmonic, SineSweep
from .materials import Material, materials
from .matrices import Matrices
from .methods import AnyMethod, Dem, EventDriven, Newton, Output
from .modes import ModalModel
from .pairs import contact_pairs
from .particle_case import check_particle_case
from .particle_damper import ParticleDamper
from .paths import replaced
from .shocks import Shock
from .signals import Sampled, Signal, Unit, as_several, signals_in
from .structures import Shaker
from .tuned_mass import TunedMass, with_tuned_masses
from .units import PositiveTime, Whole

_LONG = 12  # items of a list
_LONG_TEXT = 300  # characters
_MEMORY = 16e9  # bytes
_NOT_COMPUTABLE = "cannot be computed for bodies of these sizes, masses and moduli"
_USUAL = "numbers of usual sizes"


def _kind_of_damper(value: Any) -> str:
    """A damper with particles needs no kind in a file."""
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    in_space = isinstance(value, dict) and not value.keys().isdisjoint(("particles", "cavity", "packing"))
    return str(kind or ("particle" if in_space else "impact"))


AnyDamper = Annotated[
    Annotated[ImpactDamper, Tag("impact")] | Annotated[ParticleDamper, Tag("particle")],
    Discriminator(_kind_of_damper),
]


class Case(Part):
    """A structure, its loads, its dampers, and how long to look.

    Parameters
    ----------
    structure
        SDOF, Modal, Matrices, Beam, Plate, ShearBuilding, Fixed or Shaker.
    damper, dampers
        One ImpactDamper or ParticleDamper, several of one kind, or none.
    tuned_mass, tuned_masses
        One TunedMass, several, or none; beside the dampers or in their place.
    load, loads
        Forces on the structure: one signal, several (they add), or none.
    base
        Acceleration of the base: one signal, several, or none.
    duration
        Length of the run [s].
    method, output
        How it is computed, EventDriven or, with particle dampers, Dem if left out; and at which times it is recorded.
    name, seed
        For the record; nothing in one run is random. A seed is an integer from 0 to 2^63 - 1, as files of runs hold.

    Raises
    ------
    CaseError
        When something does not fit, with a message that says what and where.
    """

    held_as: ClassVar[tuple[str, ...]] = ("",)
    spellings: ClassVar[dict[str, str]] = {"damper": "dampers", "tuned_mass": "tuned_masses", "load": "loads"}
    name: str = ""
    structure: AnyStructure
    dampers: Annotated[tuple[AnyDamper, ...], BeforeValidator(as_several), AlsoTakes()] = ()
    tuned_masses: Annotated[tuple[TunedMass, ...], BeforeValidator(as_several), AlsoTakes()] = ()
    loads: Annotated[tuple[AnySignal, ...], signals_in("N"), AlsoTakes()] = ()
    base: Annotated[tuple[AnySignal, ...], signals_in("m/s^2"), AlsoTakes()] = ()
    duration: PositiveTime
    method: AnyMethod = Field(default_factory=EventDriven)
    output: Output = Field(default_factory=Output)
    seed: Annotated[Whole, Field(ge=0, le=2**63 - 1)] = 0  # what files of runs hold

    @model_validator(mode="before")
    @classmethod
    def _spellings(cls, values: Any) -> Any:
        return cls.in_full(values) if isinstance(values, dict) else values

    @model_validator(mode="after")
    def _fits_together(self) -> Case:
        put = object.__setattr__
        put(self, "loads", self._placed("loads", "N", "a load"))
        put(self, "base", self._placed("base", "m/s^2", "the base"))
        if self.particle_dampers and "method" not in self.model_fields_set:
            put(self, "method", Dem())
        self._check_signals()
        self._check_directions()
        self._check_size()
        names: set[str] = set()
        for index, damper in enumerate(self.dampers):
            with at("dampers", index):
                if damper.label(index) in names:
                    raise Hint(f"two dampers are called {damper.label(index)!r}", "different names")
                names.add(damper.label(index))
                if isinstance(damper, ImpactDamper):
                    self._check_play(damper)
                    self._check_places(damper)
                    self._check_laws(damper, index)
                else:
                    self._check_entries(damper)
        return self

    def _placed(self, field: str, unit: Unit, place: str) -> tuple[Signal, ...]:
        """The signals of a field in the unit that it takes."""
        signals = []
        for index, signal in enumerate(getattr(self, field)):
            with at(field, index):
                signals.append(signal.placed((unit,), place))
        return tuple(signals)

    def _check_signals(self) -> None:
        modes = self.modes
        for numbers in (modes.decay, modes.stiffness, modes.q0, modes.p0, *modes.shapes.values()):
            if not np.isfinite(numbers).all():
                raise Hint("its modes are no finite numbers", "masses and stiffnesses of usual sizes", ["structure"])
        for field, signals in (("loads", self.loads), ("base", self.base), ("motion", self.shaker_motion)):
            for index, signal in enumerate(signals):
                with at(*(("structure",) if field == "motion" else ()), field, index):
                    if isinstance(signal, Sampled):
                        self._check_record(signal)
                    if field != "loads" and signal.point is not None:
                        raise Hint("the base moves as a whole and has no point", "leave point out", ["point"])
        if self.loads and not modes.decay.size:
            raise Hint(
                f"a load cannot move a {self.structure.kind} structure", "motion of a shaker, or base", ["loads", 0]
            )
        for index, signal in enumerate(self.loads):
            with at("loads", index, "point"):
                modes.point(signal.point)
            with at("loads", index):
                modes.shape(signal.point, signal.direction)
        if self.base and modes.participation is None:
            if isinstance(self.structure, Matrices):
                raise Hint(
                    "how do the degrees of freedom move with the base along x, y and z?",
                    "three rows of numbers, 1 where one moves with it",
                    ["structure", "influence"],
                )
            raise Hint(
                "base motion needs the participation of each mode", "one number each", ["structure", "participation"]
            )
        if self.base and isinstance(self.structure, Shaker):
            raise Hint("a shaker is its own base", "add the signal to its motion", ["base"])

    def _check_directions(self) -> None:
        """Look at the kinds of dampers and at what moves where."""
        if self.particle_dampers:
            check_particle_case(self)
            self._check_snapshots()
            return
        if self.output.snapshots is not None:
            raise Hint("snapshots are of particles in space, and there are none", "rate", ["output", "snapshots"])
        if isinstance(self.method, Dem):
            raise Hint(
                "dem computes particles in space, and there is no damper with particles"
                if not self.dampers
                else "dem computes particles in space, not impact dampers",
                'kind = "event_driven", or a ParticleDamper',
                ["method"],
            )
        for field, signals in (("base", self.base), ("motion", self.shaker_motion)):
            for index, signal in enumerate(signals):
                if signal.direction is not None:
                    place = (*(("structure",) if field == "motion" else ()), field, index, "direction")
                    raise Hint("without particle dampers all motion is along one line", "leave direction out", place)
        if self.base and self.modes.spatial:
            raise Hint(
                f"the point {min(self.modes.spatial)!r} moves in space, where the base of a case without particle dampers"
                " has no direction",
                "points that move along one line, with one participation for each mode",
                ["base"],
            )

    def _check_snapshots(self) -> None:
        """Refuse snapshots after the end."""
        times = self.output.snapshots if isinstance(self.output.snapshots, tuple) else ()
        if late := [time for time in times if time > self.duration * (1 + 1e-9)]:
            raise Hint(
                f"a snapshot is asked for at {late[0]:.6g} s, after the end of the run at {self.duration:.6g} s",
                "times up to the end, or a longer duration",
                ["output", "snapshots"],
            )

    def _check_size(self) -> None:
        """Refuse an output that no memory holds."""
        samples = self.duration * (self.output.rate or 0.0)
        columns = 20 + 6 * self.modes.decay.size + 10 * sum(len(damper.balls) for damper in self.impact_dampers)
        columns += 50 * len(self.particle_dampers)
        if 8 * samples * columns > _MEMORY:
            raise ResourceError(
                f"{samples:.3g} samples would take {8e-9 * samples * columns:.0f} GB",
                f'rate = "{_MEMORY / (80 * columns * self.duration):.1g} Hz", or times',
                ["output", "rate"],
            )

    def _check_record(self, record: Sampled) -> None:
        if not record.covers(self.duration):
            times, _ = record.polyline()
            first, last = times[0], times[-1]
            enough = f'duration = "{last:.10g} s", or a longer record' if last > 0 else "a longer record"
            raise Hint(
                f"the record covers {first:.10g} s to {last:.10g} s, the run 0 to {self.duration:.10g} s",
                enough if record.covers(last) else "a record that begins at 0 s",
                record.where,
            )

    def _check_play(self, damper: ImpactDamper) -> None:
        if isinstance(self.method, Newton) and damper.clearance <= 1e-14 * damper.row:
            raise Hint(
                "hard impacts need some play: what the walls hold on both sides never flies",
                'gap = "1 um", or the EventDriven method, whose contacts carry it',
                ["gap"],
            )

    def _check_places(self, damper: ImpactDamper) -> None:
        """Refuse balls that start inside a wall of the cavity, which may be displaced at the start."""
        with at("point"):
            shape = self.modes.shape(damper.point)
        cavity = float(shape @ self.modes.q0)
        half = 0.5 * damper.clearance
        for number, place in enumerate(damper.positions0, start=1):
            depth = abs(place - cavity) - half
            if depth > 4e-16 * (half + abs(cavity)):
                where = "" if cavity == 0 else f", which is displaced by {1e3 * cavity:.4g} mm at the start"
                raise Hint(
                    f"ball {number} would start {1e3 * depth:.4g} mm inside a wall of the cavity" + where,
                    "start between -1 and 1"
                    if cavity == 0
                    else f'start = "{1e3 * cavity:.6g} mm" is its centre, with {1e3 * half:.6g} mm on each side',
                    ["start"],
                )

    def _check_laws(self, damper: ImpactDamper, index: int) -> None:
        """Let every law look at the pair of bodies that it is used for."""
        for number, pair in enumerate(contact_pairs(self, index)):
            between = 0 < number < len(damper.balls) and damper.ball_contact is not None
            law = damper.ball_contact if between and damper.ball_contact is not None else damper.contact
            with at("ball_contact" if between else "contact"), _computable():
                _, values = law.coefficients(pair)
                _check_finite(values)
                if law.impact_restitution is not None:
                    with at("restitution"):
                        _, values = law.impact_restitution.coefficients(pair)
                        _check_finite(values)

    def _check_entries(self, damper: ParticleDamper) -> None:
        """Let every law look at the pairs of bodies that it is used for."""
        for entry in damper.contact_table.entries:
            with at(*entry.place), _computable():
                _check_finite(damper.softened(entry)[1])
                _check_finite(damper.softened_friction(entry)[1])
                _check_finite(damper.rolling_of(entry).coefficients())
                if entry.contact.impact_restitution is not None:
                    with at("restitution"):
                        _check_finite(entry.contact.impact_restitution.coefficients(entry.pair)[1])

    @property
    def impact_dampers(self) -> tuple[ImpactDamper, ...]:
        """The dampers that are impact dampers."""
        return tuple(damper for damper in self.dampers if isinstance(damper, ImpactDamper))

    @property
    def particle_dampers(self) -> tuple[ParticleDamper, ...]:
        """The dampers that hold particles in space."""
        return tuple(damper for damper in self.dampers if isinstance(damper, ParticleDamper))

    @property
    def shaker_motion(self) -> tuple[Signal, ...]:
        """The signals that a shaker moves by."""
        return self.structure.motion if isinstance(self.structure, Shaker) else ()

    @cached_property
    def modes(self) -> ModalModel:
        """The structure in modal form, with its tuned masses."""
        with np.errstate(all="ignore"):  # non-finite numbers are refused when the case is checked
            return with_tuned_masses(self.structure.modes(), self.tuned_masses)

    def base_acceleration(self) -> tuple[Signal, ...]:
        """Return the signals that accelerate the base [m/s^2]."""
        signals = []
        for signal in (*self.base, *self.shaker_motion):
            signals.append(signal.acceleration() if isinstance(signal, Harmonic) and signal.unit == "m" else signal)
        return tuple(signals)

    def sample_times(self) -> Vector:
        """Return the times of the output that are known before the run, (T,) [s]."""
        if self.output.is_chosen:
            return self.output.sample_times(self.duration)
        signals = (*self.loads, *self.base_acceleration())
        even = self.output.sample_times(self.duration, self._fastest())
        pulses = [s.start + np.linspace(0, s.duration, 21) for s in signals if isinstance(s, Shock)]
        times = np.unique(np.concatenate([even, *pulses]))
        return times[times <= self.duration]

    def even_samples(self) -> int:
        """Return how many equal parts the samples divide the duration into, for a run in equal steps.

        A rate that does not divide it is raised a little.
        """
        return self.output.sample_times(self.duration, self._fastest()).size - 1

    def _fastest(self) -> float:
        """Highest frequency of modes, harmonics and sweeps [Hz]."""
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

        Raises
        ------
        CaseError
            When the file cannot be read or the case does not fit.
        """
        file = Path(path)
        try:
            existing(file)
            content = file.read_text(encoding="utf-8-sig")
        except DataError as error:
            raise CaseError(str(error)) from None
        except OSError as error:
            raise CaseError(f"{file}: cannot be read: {error.strerror}") from None
        except UnicodeDecodeError:
            raise CaseError(f"{file}: not text in UTF-8\n  try: a TOML file, saved as UTF-8") from None
        return cls.from_toml(content, source=str(file), folder=file.parent)

    @classmethod
    def from_toml(cls, content: str, *, source: str = "case", folder: Path | None = None) -> Case:
        """Read a case from the text of a case file.

        Parameters
        ----------
        content
            TOML.
        source
            What messages call it.
        folder
            Where files named in it are looked for; default the current folder.

        Raises
        ------
        CaseError
            When the case does not fit.
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

        Raises
        ------
        CaseError
            If a value is not allowed.
        """
        if not given:
            raise CaseError(f"{source}: there is nothing in it\n  try: rattlebox demo, which writes two case files")
        if "case" in given and "structure" not in given:
            raise CaseError(f"{source}: this is a study of a case, not a case\n  try: rattlebox sweep {source}")
        try:
            library = _Library.model_validate({"materials": given.get("materials", {})})
            values = {key: value for key, value in given.items() if key != "materials"}
            if folder is not None:
                values = _with_files(values, lambda file: str(folder / file))
            return cls.model_validate(values, context=library.materials)
        except ValidationError as error:
            raise translate(error, source, vocabulary(), given) from None

    def __repr__(self) -> str:
        counts = Counter(type(part).__name__ for part in (*self.dampers, *self.tuned_masses, *self.loads, *self.base))
        parts = ", ".join([type(self.structure).__name__, *(f"{n} {kind}" for kind, n in counts.items())])
        return f"<Case{f' {self.name!r}' if self.name else ''}: {parts}; {self.duration:g} s, {self.method.kind}>"

    def _repr_html_(self) -> str:
        return paragraph(repr(self)[1:-1]) + code_block(self.short_toml())

    def short_toml(self, most: int = 8000) -> str:
        """Return the case as the text of a case file, with long lists shortened, for reading only.

        Parameters
        ----------
        most
            Largest number of characters; the rest is left out.
        """
        text = self._toml(str, _shortened)
        return text if len(text) <= most else f"{text[:most]}\n... {len(text) - most} more characters"

    def replaced(self, values: Mapping[str, Any]) -> Case:
        """Return a case with other values in places; this one stays as it is.

        What excludes a value goes: a case with damping becomes one with a damping ratio when that is given.

        Parameters
        ----------
        values
            New values by path, as studies name them and as one would write them in the case:
            `case.replaced({"damper.friction": 0.5, "duration": "2 s"})`.

        Raises
        ------
        CaseError
            When a path leads nowhere, or the new case does not fit, with the reason.
        """
        return replaced(self, values)

    def to_toml(self) -> str:
        """Return the case as the text of a case file that reads back equal; files in it are named by their full path."""
        return self._toml(str)

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Write a case file that reads back equal; files in it are named as seen from its folder."""
        folder = Path(path).absolute().parent
        text = self._toml(lambda file: _relative(file, folder))
        with atomic_write(path, "make room and write the case again") as name:
            name.write_text(text, encoding="utf-8")

    def _toml(self, name_of: Callable[[str], str], change: Callable[[Any], Any] = lambda data: data) -> str:
        import tomli_w

        data = self.model_dump(mode="json", exclude_none=True, exclude_defaults=False)
        return tomli_w.dumps(change(_tidy(_with_files(data, name_of))))

    @classmethod
    def json_schema(cls) -> dict[str, Any]:
        """Return the JSON Schema of case files."""
        schema = cls.model_json_schema(mode="validation")
        properties = schema["properties"]
        properties["materials"] = {
            "type": "object",
            "description": "materials of this file, by name, used like those of the library",
            "additionalProperties": {"$ref": "#/$defs/Material"},
        }
        return schema


@contextmanager
def _computable() -> Iterator[None]:
    """Complain where formulas divide by zero or leave double precision."""
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            yield
    except ArithmeticError:
        raise Hint(_NOT_COMPUTABLE, _USUAL) from None


def _check_finite(values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        if not np.isfinite(value).all():
            raise Hint(f"{_NOT_COMPUTABLE}: its {name.replace('_', ' ')} is no finite number", _USUAL)


def _tidy(value: Any) -> Any:
    """Drop what is empty: TOML has no null."""
    if isinstance(value, dict):
        return {key: _tidy(item) for key, item in value.items() if item is not None and item not in ("", [], {})}
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    return value


def _shortened(value: Any) -> Any:
    """Return tables and lists with a note in place of all but the first items of long lists and of long texts."""
    if isinstance(value, dict):
        return {key: _shortened(item) for key, item in value.items()}
    if isinstance(value, list):
        items = value if len(value) <= _LONG else [*value[:3], f"... {len(value)} in all"]
        return [_shortened(item) for item in items]
    return f"{value[:_LONG_TEXT]}..." if isinstance(value, str) and len(value) > _LONG_TEXT else value


class _Library(Part):
    """The materials of a case file."""

    held_as: ClassVar[tuple[str, ...]] = ("",)
    materials: dict[str, Material] = Field(default_factory=dict)

    @field_validator("materials", mode="before")
    @classmethod
    def _named(cls, own: Any) -> Any:
        if not isinstance(own, dict):
            return own
        for name in own:
            if name in materials():
                raise Hint("a material of this name is in the library", "another name", [name])
        return {name: {"name": name, **item} if isinstance(item, dict) else item for name, item in own.items()}


def _with_files(node: Any, name_of: Callable[[str], str]) -> Any:
    """The same with other names of files."""
    if isinstance(node, dict):
        return {
            key: _renamed(item, name_of) if key == "file" else _with_files(item, name_of) for key, item in node.items()
        }
    return [_with_files(item, name_of) for item in node] if isinstance(node, list) else node


def _renamed(file: Any, name_of: Callable[[str], str]) -> Any:
    """The name of a file, or a table of them, with other names."""
    if isinstance(file, dict):
        return {key: _renamed(item, name_of) for key, item in file.items()}
    return name_of(file) if isinstance(file, str) else file


def _relative(file: str, folder: Path) -> str:
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # another drive
        return file
