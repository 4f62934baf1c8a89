"""One parameter of a case, and how values for it are read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from rattlebox._util.exceptions import CaseError
from rattlebox.model.base import Part, vocabulary
from rattlebox.model.case import Case
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.errors import Hint, translate
from rattlebox.model.materials import Material
from rattlebox.model.paths import Place, get_field, place_of, unit_of
from rattlebox.model.restitutions import Constant
from rattlebox.model.signals import Signal
from rattlebox.model.units import parse, plain

from .grid import Column
from .sampling import Spaced


@dataclass(frozen=True, eq=False)
class Values:
    """What a parameter takes along one dimension: numbers in SI with their unit, or objects and None."""

    parameter: Parameter
    array: Column
    unit: str | None


class Parameter:
    """A place in a case that a path leads to.

    Parameters
    ----------
    case
        The case.
    path
        Names of fields and numbers in lists.
    source
        What messages call the place that the values come from.
    materials
        Known by name besides the library.

    Raises
    ------
    CaseError
        When the path leads nowhere.
    """

    def __init__(self, case: Case, path: Any, source: str, materials: dict[str, Material]) -> None:
        if not isinstance(path, str):
            raise Hint(f"{path!r} is no path", '"damper.gap"')
        self.path, self.source, self.materials = path, source, materials
        self.place: Place = place_of(case, path)
        node: Any = case
        for number, step in enumerate(self.place):
            if isinstance(node, Part):
                self.part, self.name, self.inner = node, str(step), self.place[number + 1 :]
            node = get_field(node, str(step)) if isinstance(node, Part) else node[step]
        self.now = node
        self.is_start = isinstance(self.part, ImpactDamper) and self.name == "start"
        self.unit = "1" if self.is_start else unit_of(case, path)

    def check_beside(self, others: Iterable[Parameter]) -> None:
        """Refuse to vary what varies already, or what excludes it.

        Raises
        ------
        Hint
            When it does.
        """
        for other in others:
            if other.place == self.place:
                raise Hint(f"{self.path} varies twice" + (f", also as {other.path}" if other.path != self.path else ""))
            pairs = self.part.alternatives if other.place[:-1] == self.place[:-1] else ()
            if (other.name, self.name) in pairs or (self.name, other.name) in pairs:
                raise Hint(f"{other.path} and {self.path} exclude each other", "one of them")

    def read(self, value: Any, which: int | str | None = None) -> Any:
        """Read a value as the case would; `which` tells messages which one it is.

        Raises
        ------
        CaseError
            When the case would not take it.
        """
        given = {self.name: _put(get_field(self.part, self.name), self.inner, value)}
        try:
            result = getattr(
                _field(type(self.part), self.name).model_validate(given, context=self.materials), self.name
            )
        except ValidationError as error:
            told = str(translate(error, "\0", vocabulary(), given))
            inside = self.name + "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in self.inner)
            said = self.said(which)
            raise CaseError(told.replace(f"\0: {inside}", said).replace("\0:", f"{said}:")) from None
        for step in self.inner:
            result = result[step]
        return result

    def number(self, value: Any, which: int | str | None = None) -> tuple[float, str] | None:
        """Read a value as a number in SI with its unit; None when it is none.

        Raises
        ------
        CaseError
            When the case would not take it.
        """
        if isinstance(self.part, Signal) and self.name == "amplitude":
            try:
                parse(value, (self.unit or "1",))
            except Hint as hint:
                raise self.wrong(hint.complaint, hint.suggestion, which, value) from None
        result = self.read(value, which)
        if isinstance(result, tuple) and len(result) == 1:  # one stands for a list of one
            (result,) = result
        if isinstance(result, Constant) and result.maximum == 1:
            result = result.e
        bare = None if isinstance(value, bool) else plain(value)
        if isinstance(result, Part) and isinstance(bare, Real):  # which stands for the part
            result = bare
        if isinstance(result, str) and self.is_start:
            return parse(result, ("m",))[0], "m"
        if isinstance(result, bool) or not isinstance(result, Real):
            return None
        return float(result), self.unit or "1"

    def ends(self, low: Any, high: Any, names: Sequence[str | int] = (0, 1)) -> tuple[float, float, str]:
        """Read the ends of a range, in one unit; `names` are what messages call them."""
        if self.unit is None:
            raise self.wrong("its values are no numbers", "a list of values")
        start, stop = self.number(low, names[0]), self.number(high, names[1])
        if start is None or stop is None:
            raise self.wrong("its values are no numbers", "a list of values")
        if start[1] != stop[1]:
            raise self.mixed()
        return start[0], stop[0], start[1]

    def values(self, given: Any) -> Values:
        """Read a list of values.

        Parameters
        ----------
        given
            Spaced values, or a list or an array of whatever the case takes. Of many plain numbers only the smallest and the
            largest are shown to the case.

        Raises
        ------
        CaseError
            When there are none, or the case would not take one of them.
        """
        if isinstance(given, Spaced):
            start, stop, unit = self.ends(given.start, given.stop, given.names)
            try:
                return Values(self, given.values(start, stop), unit)
            except Hint as hint:
                raise self.wrong(hint.complaint, hint.suggestion) from None
        if isinstance(given, (str, bytes, Mapping, Set, Part)) or not hasattr(given, "__iter__"):
            raise self.not_a_list(given)
        numbers = _as_numbers(given)
        if numbers is not None and numbers.size:
            bad = np.flatnonzero(~np.isfinite(numbers))
            if bad.size:
                raise self.wrong("a finite number is needed", "", int(bad[0]), float(numbers[bad[0]]))
            found = [self.number(float(numbers[which]), int(which)) for which in (numbers.argmin(), numbers.argmax())]
            if found[0] is not None:
                return Values(self, numbers, found[0][1])
        try:
            items = given.tolist() if isinstance(given, np.ndarray) and given.ndim else list(given)
        except TypeError:  # an array without dimensions
            raise self.not_a_list(given) from None
        if not items:
            raise self.wrong("there are no values", "a list of at least one")
        found = [self.number(item, which) for which, item in enumerate(items)]
        quantities = [number for number in found if number is not None]
        if len(quantities) < len(found):
            return Values(self, objects([self.read(item) for item in items]), None)
        if len({unit for _, unit in quantities}) > 1:
            raise self.mixed()
        return Values(self, np.array([number for number, _ in quantities]), quantities[0][1])

    def said(self, which: int | str | None = None) -> str:
        """Return what messages call the parameter, or one of its values."""
        shown = "" if which is None else f"[{which}]" if isinstance(which, int) else f", {which}"
        return f"{self.source}: {self.path}{shown}"

    def wrong(self, complaint: str, suggestion: str = "", which: int | str | None = None, *value: Any) -> CaseError:
        """Return a complaint about the parameter, or about one of its values."""
        shown = "".join(f" = {item!r:.60}" for item in value)
        return CaseError(f"{self.said(which)}{shown}\n  {Hint(complaint, suggestion)}")

    def mixed(self) -> CaseError:
        """Return a complaint about start positions of both kinds."""
        return self.wrong("fractions of the gap and lengths do not mix", "all of one kind")

    def not_a_list(self, given: Any) -> CaseError:
        """Return a complaint about one value."""
        suggestion = f"[{given!r}]" if isinstance(given, (str, int, float)) else ""
        return self.wrong("a list of values is needed", suggestion, None, given)


@cache
def _field(part: type[Part], name: str) -> type[BaseModel]:
    """A model of one field of a part."""
    info = part.model_fields[name]
    config = ConfigDict(arbitrary_types_allowed=True, allow_inf_nan=False)
    fields: dict[str, Any] = {name: (info.annotation, info)}
    return create_model("Value", __config__=config, **fields)


def _put(node: Any, inner: Place, value: Any) -> Any:
    """The same with another value inside."""
    if not inner:
        return value
    copy: Any = dict(node) if isinstance(node, dict) else list(node)
    copy[inner[0]] = _put(copy[inner[0]], inner[1:], value)
    return copy


def _as_numbers(given: Any) -> NDArray[np.float64] | None:
    """The values as one row, if all are plain numbers."""
    if isinstance(given, (list, tuple, range)):
        if not all(isinstance(item, (int, float, np.number)) and not isinstance(item, bool) for item in given):
            return None
    elif not hasattr(given, "__array__") or hasattr(given, "magnitude"):
        return None
    try:
        array = np.asarray(given)
    except OverflowError:
        return None
    return array.astype(float) if array.ndim == 1 and array.dtype.kind in "iuf" else None


def objects(items: Sequence[Any]) -> Column:
    """Return an array of objects, each left as it is."""
    array = np.empty(len(items), dtype=object)
    for number, item in enumerate(items):
        array[number] = item
    return array
