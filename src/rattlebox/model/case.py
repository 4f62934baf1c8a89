"""The case: everything a run needs, in one object and one file."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from .base import Part, known_fields
from .dampers import ImpactDamper
from .errors import CaseError, Hint, translate
from .materials import materials
from .methods import AnyMethod, EventDriven, Output
from .modes import ModalModel, Vector
from .pairs import contact_pairs
from .signals import AnySignal, Harmonic, Record, Signal, as_signals
from .structures import AnyStructure, Shaker
from .units import PositiveTime


class Case(Part):
    """A structure, its loads, its dampers, and how long to look.

    Parameters
    ----------
    structure
        SDOF, Modal, Matrices, Fixed or Shaker.
    damper, dampers
        One ImpactDamper, several, or none.
    load, loads
        Forces on the structure: one signal, several (they add), or none.
    base
        Acceleration of the base: one signal, several, or none.
    duration
        Length of the run [s].
    method, output
        How it is computed, and at which times it is recorded.
    name, seed
        For the record; nothing in one run is random.

    Raises
    ------
    CaseError
        When something does not fit, with a message that says what and where.
    """

    held_as: ClassVar[tuple[str, ...]] = ("",)
    name: str = ""
    structure: AnyStructure
    dampers: Annotated[tuple[ImpactDamper, ...], BeforeValidator(as_signals)] = ()
    loads: Annotated[tuple[AnySignal, ...], BeforeValidator(as_signals)] = ()
    base: Annotated[tuple[AnySignal, ...], BeforeValidator(as_signals)] = ()
    duration: PositiveTime
    method: AnyMethod = Field(default_factory=EventDriven)
    output: Output = Field(default_factory=Output)
    seed: int = 0

    @model_validator(mode="before")
    @classmethod
    def _spellings(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        values = dict(values)
        for one, many in (("damper", "dampers"), ("load", "loads")):
            if one in values:
                if many in values:
                    raise Hint(f"give {one} or {many}, not both")
                values[many] = values.pop(one)
        return values

    @model_validator(mode="after")
    def _fits_together(self) -> Case:
        put = object.__setattr__
        put(self, "loads", tuple(signal.placed(("N",), "a load") for signal in self.loads))
        put(self, "base", tuple(signal.placed(("m/s^2",), "the base") for signal in self.base))
        modes = self.modes
        for signal in (*self.loads, *self.base, *self._motion()):
            if isinstance(signal, Record):
                self._check_record(signal)
        if self.loads and not modes.decay.size:
            raise Hint(f"a load cannot move a {self.structure.kind} structure", "put motion into Shaker or base")
        for signal in self.loads:
            modes.point(signal.point)
        if self.base and modes.participation is None:
            raise Hint("base motion needs the participation of each mode", "participation = [...] in the structure")
        if self.base and isinstance(self.structure, Shaker):
            raise Hint("a shaker is its own base", "add the signal to its motion")
        names: set[str] = set()
        for index, damper in enumerate(self.dampers):
            modes.point(damper.point)
            if damper.label(index) in names:
                raise Hint(f"two dampers are called {damper.label(index)!r}", "different names")
            names.add(damper.label(index))
            cavity = float(modes.shape(damper.point) @ modes.q0)
            half = 0.5 * damper.clearance
            for number, place in enumerate(damper.positions0, start=1):
                depth = abs(place - cavity) - half
                if depth > 4e-16 * (half + abs(cavity)):
                    raise Hint(
                        f"ball {number} of {damper.label(index)} would start {1e3 * depth:.4g} mm inside a wall",
                        "start between -1 and 1, or where the cavity is",
                    )
            for place, pair in enumerate(contact_pairs(self, index)):
                between = 0 < place < len(damper.balls)
                law = damper.ball_contact if between and damper.ball_contact is not None else damper.contact
                law.coefficients(pair)
                if law.restitution is not None:
                    law.restitution.coefficients(pair)
        return self

    def _check_record(self, record: Record) -> None:
        if record.times[0] > 0 or record.times[-1] < self.duration:
            raise Hint(
                f"the record covers {record.times[0]:.6g} s to {record.times[-1]:.6g} s, the run 0 to {self.duration:.6g} s",
                f'duration = "{record.times[-1]:.6g} s", or a longer record',
            )

    def _motion(self) -> tuple[Signal, ...]:
        return self.structure.motion if isinstance(self.structure, Shaker) else ()

    @cached_property
    def modes(self) -> ModalModel:
        """The structure in modal form."""
        return self.structure.modes()

    def base_acceleration(self) -> tuple[Signal, ...]:
        """Return the signals that accelerate the base [m/s^2]."""
        signals = []
        for signal in (*self.base, *self._motion()):
            signals.append(signal.acceleration() if isinstance(signal, Harmonic) and signal.unit == "m" else signal)
        return tuple(signals)

    def sample_times(self) -> Vector:
        """Return the times of the output, (T,) [s]."""
        return self.output.sample_times(self.duration)

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
            content = file.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise CaseError(f"{file}: cannot be read: {error}") from None
        return cls.from_toml(content, source=file.name, folder=file.parent)

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
        try:
            values: Any = tomllib.loads(content)
        except (ValueError, RecursionError) as error:  # ValueError: also an integer of thousands of digits
            raise CaseError(f"{source}: not TOML: {error}") from None
        try:
            values = _insert_materials(values)
            if folder is not None:
                values = _with_files(values, lambda file: str(folder / file))
            return cls.model_validate(values)
        except ValidationError as error:
            raise translate(error, source, known_fields()) from None
        except CaseError as error:
            raise CaseError(f"{source}: {error}") from None
        except Hint as error:
            raise CaseError(
                "\n  try: ".join(filter(None, [f"{source}: {error.complaint}", error.suggestion]))
            ) from None

    def to_toml(self) -> str:
        """Return the case as the text of a case file that reads back equal; files in it are named by their full path."""
        return self._toml(str)

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Write a case file that reads back equal; files in it are named as seen from its folder."""
        folder = Path(path).absolute().parent
        Path(path).write_text(self._toml(lambda file: _relative(file, folder)), encoding="utf-8")

    def _toml(self, name_of: Callable[[str], str]) -> str:
        import tomli_w

        data = self.model_dump(mode="json", exclude_none=True, exclude_defaults=False)
        return tomli_w.dumps(_tidy(_with_files(data, name_of)))

    @classmethod
    def json_schema(cls) -> dict[str, Any]:
        """Return the JSON Schema of case files."""
        schema = cls.model_json_schema(mode="validation")
        properties = schema["properties"]
        for one, many in (("damper", "dampers"), ("load", "loads")):
            properties[one] = properties[many]
        schema["properties"]["materials"] = {
            "type": "object",
            "description": "materials of this file, by name, used like those of the library",
            "additionalProperties": {"$ref": "#/$defs/Material"},
        }
        return schema


def _tidy(value: Any) -> Any:
    """Drop what is empty: TOML has no null."""
    if isinstance(value, dict):
        return {key: _tidy(item) for key, item in value.items() if item is not None and item not in ("", [], {})}
    if isinstance(value, list):
        return [_tidy(item) for item in value]
    return value


def _insert_materials(values: dict[str, Any]) -> dict[str, Any]:
    """Replace names from the file's own [materials] by their content."""
    own = values.pop("materials", None)
    if own is None:
        return values
    if not isinstance(own, dict) or not all(isinstance(m, dict) for m in own.values()):
        raise Hint("materials must be tables", "[materials.mine]")
    clash = set(own) & set(materials())
    if clash:
        raise Hint(f"material {sorted(clash)[0]!r} is in the library already", "another name")

    def insert(node: Any) -> Any:
        if isinstance(node, dict):
            return {
                key: {"name": item, **own[item]}
                if key in ("material", "wall") and isinstance(item, str) and item in own
                else insert(item)
                for key, item in node.items()
            }
        return [insert(item) for item in node] if isinstance(node, list) else node

    return dict(insert(values))


def _with_files(node: Any, name_of: Callable[[str], str]) -> Any:
    """The same with other names of files."""
    if isinstance(node, dict):
        return {
            key: name_of(item) if key == "file" and isinstance(item, str) else _with_files(item, name_of)
            for key, item in node.items()
        }
    return [_with_files(item, name_of) for item in node] if isinstance(node, list) else node


def _relative(file: str, folder: Path) -> str:
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # another drive
        return file
