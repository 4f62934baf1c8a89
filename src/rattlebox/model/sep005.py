"""Time histories in the form of SEP005: dictionaries that the packages of SDyPy exchange."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .errors import Hint, nearest
from .signals import UNIT_NAMES, UNITS, Unit
from .units import factor_of

_EXAMPLE = '{"name": "tip", "data": [...], "fs": 1000.0, "unit_str": "m/s^2"}'
_QUANTITIES: dict[str, Unit] = {"a": "m/s^2", "f": "N", "d": "m"}
_OTHERS = {"v": "a velocity", "e": "a strain", "s": "a stress"}
_SAME = 1e-6  # relative difference of time steps that count as the same
_LISTED = 12  # channels in a message


def fields_of_sep005(given: object, name: str | None, unit: object) -> dict[str, Any]:
    """Return the fields of a record for a dictionary of SEP005, or for that of a name in a list.

    References
    ----------
    SDyPy enhancement proposal 5: data format for time series.
    """
    channel = _chosen(given, name)
    label = _text(channel, "name")
    where = f"the channel {label[:60]!r}" if label else "the channel"
    if "data" not in channel:
        key = next((key for key in channel if str(key).lower() == "data"), None)
        advice = f"'data' in place of {key!r}" if key else _EXAMPLE
        raise Hint(f"{where} has no data; its keys are {_listed(channel)}", advice)
    values = _vector(channel["data"], f"{where}: data")
    return {
        "times": _times(channel, values.size, where),
        "values": values,
        "unit": _unit(channel, where, unit),
        "name": label,
    }


def _chosen(given: object, name: str | None) -> Mapping[str, Any]:
    if isinstance(given, Mapping):
        channels: list[Any] = [given]
    elif isinstance(given, Sequence) and not isinstance(given, (str, bytes)):
        channels = list(given)
    else:
        channels = [None]
    if not channels or not all(isinstance(each, Mapping) for each in channels):
        raise Hint("a dictionary of SEP005, or a list of them, is needed", _EXAMPLE)
    names = [_text(each, "name") for each in channels]
    if name is None:
        if len(channels) > 1:
            raise Hint(f"{len(channels)} channels are given: {_listed(names)}", f"channel = {names[0]!r}")
        return dict(channels[0])
    if names.count(name) != 1:
        count = "no channel is" if name not in names else f"{names.count(name)} channels are"
        raise Hint(
            f"{count} called {name[:60]!r}; there are {_listed(names)}",
            nearest(name[:60], [each[:60] for each in names[:_LISTED]]),
        )
    return dict(channels[names.index(name)])


def _text(channel: Mapping[str, Any], key: str) -> str:
    """Return a text of a channel; "" if there is none."""
    value = channel.get(key)
    if value is not None and not isinstance(value, str):
        raise Hint(f"{key} of a channel is {value!r:.60}, not text", _EXAMPLE)
    return (value or "").strip()


def _vector(value: object, where: str) -> Any:
    """Return a row of finite numbers."""
    try:
        given = np.asarray(value)
        if given.dtype.kind not in "fiuO":  # text, time stamps and complex numbers would be converted
            raise TypeError
        array = given.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise Hint(f"{where} has items that are no numbers", "a list of numbers without gaps") from None
    if array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.ndim != 1 or array.size < 2:
        raise Hint(f"{where} has the shape {array.shape}", "one row of at least two numbers")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise Hint(f"{where} has {array[bad[0]]} at index {int(bad[0])}", "a list of numbers without gaps")
    return array


def _times(channel: Mapping[str, Any], count: int, where: str) -> Any:
    """Return the times: those given, or of the sampling frequency."""
    rate = channel.get("fs")
    if rate is not None:
        try:
            rate = float(rate)
        except (TypeError, ValueError, OverflowError):
            raise Hint(
                f"{where} has fs = {channel['fs']!r:.60}", "the sampling frequency in Hz, such as 1000.0"
            ) from None
        if not (np.isfinite(rate) and rate > 0):
            raise Hint(f"{where} has fs = {rate:g} Hz", "a sampling frequency greater than zero")
    if channel.get("time") is None:
        if rate is None:
            raise Hint(f"{where} has neither time nor fs", '"fs": 1000.0, the sampling frequency in Hz')
        return np.arange(count) / rate
    times = _vector(channel["time"], f"{where}: time")
    if times.size != count:
        raise Hint(f"{where} has {times.size} times, but {count} values", "as many of both")
    step = float(times[-1] - times[0]) / (count - 1)
    if rate is not None and abs(step * rate - 1) > max(_SAME, 1e-3 / (count - 1)):
        raise Hint(f"{where} has fs = {rate:g} Hz, but times at steps of {step:g} s", "time or fs alone")
    return times


def _unit(channel: Mapping[str, object], where: str, unit: object) -> Any:
    """Return the unit that the channel states; that of the user must agree with it."""
    text, quantity = _text(channel, "unit_str"), _text(channel, "quantity")
    stated = factor_of(text, UNITS) if text else None
    if quantity in _OTHERS:
        raise Hint(
            f"{where} is {_OTHERS[quantity]} (quantity {quantity!r})", "an acceleration, a force or a displacement"
        )
    if text and stated is None and unit is None:
        raise Hint(
            f"{where} has unit_str = {text[:60]!r}, which is no unit of {' or '.join(UNIT_NAMES.values())}",
            'unit = "m/s^2", and scale = ..., the factor from the numbers to that unit',
        )
    if stated and quantity in _QUANTITIES and _QUANTITIES[quantity] != stated[1]:
        raise Hint(
            f"{where} has unit_str = {text!r}, but quantity {quantity!r}, {UNIT_NAMES[_QUANTITIES[quantity]]}",
            "unit_str and quantity that agree",
        )
    if stated and isinstance(unit, str) and factor_of(unit, UNITS) not in (None, stated):
        raise Hint(f"{where} has unit_str = {text!r}, not {unit!r}", "unit left out", ["unit"])
    if not text and unit is None:
        raise Hint(f"{where} has no unit_str", 'unit = "m/s^2"')
    return unit if stated is None else text if unit is None else unit


def _listed(names: Any) -> str:
    names = [str(name)[:60] for name in names]
    return ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")
