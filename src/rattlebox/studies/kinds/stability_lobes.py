"""Stability of cutting: depth of cut up to which a tool with dampers does not chatter, over speed and amplitude."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import KW_ONLY, replace
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, InstanceOf
from pydantic.dataclasses import dataclass

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount
from rattlebox.analysis.chatter import SampledResponse
from rattlebox.analysis.chatter import stability_lobes as lobes_of
from rattlebox.analysis.describing_function import MassTable, damping_of_modes
from rattlebox.analysis.signals import FloatArray
from rattlebox.model.case import Case
from rattlebox.model.damper_base import Damper
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.modes import ModalModel
from rattlebox.model.stops import refuse_stops
from rattlebox.model.structures import Shaker, StructurePart
from rattlebox.model.tuned_mass import TunedMass
from rattlebox.model.units import Number, parse
from rattlebox.studies.grid.sampling import numbers_in
from rattlebox.studies.kinds.loss_map import LossMap
from rattlebox.studies.maps.lobe_words import answer
from rattlebox.studies.maps.map_response import (
    HEAVY,
    LEAST_SHARE,
    LossTable,
    Transfer,
    first_harmonic_share,
)
from rattlebox.studies.maps.response_from_map import DamperPoints, default_frequencies, modes_of, points_of_dampers
from rattlebox.studies.maps.tool_response import ComplexArray, LoadedTool, Tool, space_shape
from rattlebox.studies.run.store import save_finished, save_result
from rattlebox.studies.run.study import CONFIG, Count, Cycles, Study, Values, study_function
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray


_LEAST_COEFFICIENT, _MOST_COEFFICIENT = 1e6, 1e12
"""Smallest and largest cutting coefficient that is accepted [N/m^2]; those of materials are 1e8 to 1e10."""
_SPEEDS = 'speeds = rb.linspace("500 rpm", "6000 rpm", 200)'
"""Example of speeds in messages."""
_MAP_SIZE = (24, 8)
"""Numbers of amplitudes and frequencies of a map that is computed for a damper."""
_MAP_RANGE = (0.8, 1.8)
"""Range of the frequencies of such a map over the chatter frequency of the structure alone."""
_RATIOS = 41
"""Number of frequencies at which the motion of dampers away from the tip is compared with that of the tip."""
_WIDER = 1.25
"""Margin of its amplitudes around those of the tip."""
_MOST_WAVES = 1e6
"""Largest number of waves between two teeth: 1e6 lobes differ from the limit of all speeds by less than a millionth."""


def _rpm(value: object) -> float:
    """Return a spindle speed [rpm]."""
    speed, unit = parse(value, ("rad/s",))
    if unit is None:
        raise Hint("speeds have no unit, and rpm and rad/s differ by 9.55", _SPEEDS, ["speeds"])
    return speed * 30 / math.pi


def _rising(values: FloatArray, name: str, advice: str) -> FloatArray:
    """Return values; raise unless they are greater than zero and rising."""
    if not values.size or np.any(values <= 0) or np.any(np.diff(values) <= 0):
        raise Hint(f"{name} must be greater than zero and rising", advice, [name])
    return values


def _as_case(value: object) -> Any:
    return Case(structure=value, duration="1 s") if isinstance(value, StructurePart) else value


CaseOrStructure = Annotated[InstanceOf[Case], BeforeValidator(_as_case)]


@dataclass(frozen=True, config=CONFIG)
class StabilityLobes(Study):
    r"""Compute the depth of cut up to which a tool does not chatter, over the spindle speed and the amplitude of vibration.

    The limit of a linear tool follows from its frequency response. Dampers act in the first harmonic like their apparent
    mass, which depends on the amplitude of vibration, and so does the limit. Where it rises with the amplitude, chatter
    grows to the amplitude whose limit is the depth of cut, and stays there: it is contained.

    Parameters
    ----------
    case
        Structure of the tool, or a case with a structure, tuned masses, and possibly a damper. Loads are ignored.
    damper
        Loss map of a damper: dataset from `rb.loss_map`, or its file or store. Or a damper, whose map is computed, with the
        method of the case. Or a `TunedMass`, or a list of these, also with one of the former, which may be in a tuned mass
        (`point="tuned mass"`). Default: that of the case.
    cutting_coefficient
        Ks, the cutting force over the area of the chip, text with a unit: "2000 N/mm^2".
    directional_factor
        Projection of force and motion on the direction of the tool: its motion along the thickness of the chip, times the
        force along this motion, over both in full. It can be negative.
    speeds
        Spindle speeds, text with a unit: `rb.linspace("500 rpm", "6000 rpm", 200)`. Without them there is only the limit
        over all speeds.
    teeth
        Number of equally spaced teeth.
    teeth_in_cut
        Mean number of teeth that cut at once; default all. For milling, teeth times the angle of engagement over 360 deg.
    point
        Point of the tool that cuts; default the only one.
    direction
        Direction of its motion, if the point moves in 3-D.
    amplitudes
        Amplitudes of vibration of that point: numbers [m], text with a unit, or `rb.geomspace`. Default: those of the map.
        A damper without a map needs them.
    at
        Point of the dampers, or a tuple of points; default that of the damper, else `point`.
    number
        Number of identical dampers at each point; default that of the damper, else 1.
    frequencies, cycles
        For the map of a damper: its frequencies, default 8 from 0.8 to 1.8 times the chatter frequency of the structure
        alone; and numbers of cycles as in `rb.loss_map`.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over `amplitude` [m] (0 without a map: the linear limit): `limit` [m], the depth of cut that is stable at all speeds,
        its `limit_frequency` [Hz], `minimum_real_part` [m/N] of the directional response, `dynamic_stiffness` [N/m], the
        smallest force over displacement, `limit_interval`, half of the 95 % interval that follows from that of the map, NaN
        if it has none, `interpolation_error`, the relative change with half of the map, and `first_harmonic_share`, see
        `rb.response_from_map`. Over `amplitude` and `speed` [rpm]: `depth` [m], the limit at the speed, `chatter_frequency`
        [Hz], and `waves`, the number of whole waves between two teeth, which numbers the lobes; -1 if there is none.
        `bare_limit`, `bare_limit_frequency`, `bare_minimum_real_part` and `bare_depth` of the structure alone. What the map
        does not cover is NaN. Attributes: `answer`, the result in words, and `warnings`.

    Raises
    ------
    CaseError
        If an argument is not valid, the tool has no damping, or the map covers no motion.

    Notes
    -----
    With the directional response G at the tip, :math:`K_s` and the mean number of teeth in cut n, a vibration of the angular
    frequency :math:`\omega` neither grows nor decays at

    .. math:: b = \frac{-1}{2 n K_s \operatorname{Re} G}, \qquad T = \frac{\pi + 2 \arg(-G) + 2 \pi k}{\omega}

    where Re G < 0, with the period T of the teeth and whole numbers k. The depth at a speed is the smallest b of all its
    roots. With a map, G is that of the structure with the apparent masses of the dampers, at an amplitude of the tip that is
    prescribed; of several motions the one with the smallest limit counts. One of them is that of balls at rest without
    gravity, where no wall reaches them. The theory holds for continuous cutting of a tool that does not leave the chip, for
    chatter with one frequency, and for light dampers; see `rb.response_from_map` for its limits with impacts.

    References
    ----------
    J. Tlusty, M. Polacek (1963), The stability of machine tools against self-excited vibrations in machining, ASME
    International Research in Production Engineering, 465-474.
    A. Gelb, W. E. Vander Velde (1968), Multiple-Input Describing Functions and Nonlinear System Design, McGraw-Hill.

    Examples
    --------
    >>> import rattlebox as rb
    >>> bar = rb.SDOF(mass="3 kg", frequency="180 Hz", damping_ratio=0.01)
    >>> lobes = rb.stability_lobes(bar, cutting_coefficient="2000 N/mm^2", speeds=rb.linspace("500 rpm", "9000 rpm", 5))
    >>> print(lobes.attrs["answer"])
    The structure alone is stable at all spindle speeds up to a depth of cut of 38.76 µm; deeper cuts chatter at 181.8 Hz.
    The deepest stable cut at the given speeds is 0.5679 mm, at 9000 rpm, the highest of them.
    """

    kind: ClassVar[str] = "stability_lobes"
    figure: ClassVar[str] = "rattlebox.plots.stability_lobes:plot_stability_lobes"
    report: ClassVar[str] = "rattlebox.report.kinds.stability_lobes:KIND"
    files: ClassVar[tuple[str, ...]] = ("damper",)

    case: CaseOrStructure
    damper: Any = None
    cutting_coefficient: float | str | tuple[float, str] | None = None
    directional_factor: Number = 1.0
    speeds: Values | None = None
    _: KW_ONLY
    teeth: Count = 1
    teeth_in_cut: Annotated[Number, Field(gt=0)] | None = None
    point: str | None = None
    direction: Any = None
    amplitudes: Values | None = None
    at: Any = None
    number: Count | None = None
    frequencies: Values | None = None
    cycles: Cycles | None = None

    @property
    def works(self) -> tuple[Work, ...]:
        """Runs of the map of a damper; none with a map that is computed already."""
        return (self._map.work,) if self._runs_map else ()

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        refuse_stops(self.case.stops, "the lobes are those of a tool that moves freely", "the case without stops")
        _ = self._coefficient, self._speeds, self._bare, self._damper
        if self.directional_factor == 0:
            raise Hint("directional_factor = 0: the tool does not feel the force", "a factor, such as 0.7")
        if self.teeth_in_cut is not None and self.teeth_in_cut > self.teeth:
            raise Hint(
                f"teeth_in_cut = {self.teeth_in_cut:g} is more than the number of teeth, {self.teeth}",
                f"teeth = {math.ceil(self.teeth_in_cut)}, or teeth_in_cut = {self.teeth}",
            )
        # A tool without damping chatters at every depth, and one that is not held as well.
        elastic = (self._tool.tip != 0) & (np.asarray(self._model.stiffness) > 0)
        for model, shape in ((self._bare_model, self._bare.tip), (self._model, self._tool.tip)):
            undamped = (shape != 0) & (model.stiffness > 0) & (model.decay <= 0)
            if undamped.any() and model.coupling is None:
                raise Hint(
                    f"mode {int(np.flatnonzero(undamped)[0]) + 1} has no damping, so that every depth of cut chatters",
                    "damping_ratio = 0.01 in the structure",
                )
        if not elastic.any():
            raise Hint(f"no elastic mode moves the point {self._tool.point!r}", "another point or direction")
        if np.any((self._bare.tip != 0) & (self._bare_model.stiffness <= 0)):
            raise Hint(
                f"the point {self._bare.point!r} moves freely, in a mode without stiffness, and chatters at every depth of "
                "cut; a tool must be held",
                "the modes of the tool in its holder, without those of a rigid body",
            )
        passes = 60 / (self._speeds * self.teeth) * self._bare_samples.smallest_real_part()[1] / (2 * math.pi)
        if np.any(passes > _MOST_WAVES):
            raise Hint(
                f"speeds begin at {self._speeds[0]:.3g} rpm, where a vibration has {passes[0]:.1g} waves between two teeth; "
                f"more than {_MOST_WAVES:.0e} are not computed, since the depth there is the limit of all speeds",
                f'speeds from "{1.05 * self._speeds[0] * passes[0] / _MOST_WAVES:.2g} rpm" on',
            )
        if self._runs_map:
            self._map.validate()
        elif self._damper is None and self.amplitudes is not None:
            raise Hint(
                "amplitudes need a damper or its map: the limit of a linear tool has no amplitude", "damper = map"
            )

    # ---- arguments

    @cached_property
    def _coefficient(self) -> float:
        """Cutting coefficient times mean number of teeth in cut [N/m^2]."""
        given, advice = self.cutting_coefficient, 'cutting_coefficient = "2000 N/mm^2"'
        if given is None:
            raise Hint("a cutting coefficient is needed, the cutting force over the area of the chip", advice)
        try:
            value, _ = parse(given, ("Pa",))
        except Hint:
            raise Hint(f"cutting_coefficient = {given!r}: a force over an area is needed", advice) from None
        if not _LEAST_COEFFICIENT <= value <= _MOST_COEFFICIENT:
            raise Hint(
                f"cutting_coefficient = {given!r} is {value:g} N/m^2; materials have 1e8 to 1e10 N/m^2",
                f'"{value:g} N/mm^2"' if 100 <= value < _LEAST_COEFFICIENT else advice,
            )
        return value * (self.teeth if self.teeth_in_cut is None else self.teeth_in_cut)

    @cached_property
    def _speeds(self) -> FloatArray:
        """Spindle speeds [rpm]."""
        if self.speeds is None:
            return np.zeros(0)
        return _rising(numbers_in(self.speeds, _rpm), "speeds", _SPEEDS)

    @cached_property
    def _damper(self) -> Any:
        """Loss map, damper or None; tuned masses are part of the model."""
        _, others = TunedMass.among(self.damper)
        if len(others) > 1 or len(self.case.dampers) > 1:
            owner = "damper lists" if len(others) > 1 else "the case has"
            raise Hint(
                f"{owner} several dampers, but one map holds one kind of damper", "one, with number = 2", ["damper"]
            )
        if others and self.case.dampers:
            raise Hint(
                "the case has a damper, and another one is given",
                "case.without_dampers(), or no damper beside the case",
                ["damper"],
            )
        return next(iter((*others, *self.case.dampers)), None)

    @cached_property
    def _tuned(self) -> tuple[TunedMass, ...]:
        return TunedMass.among(self.damper)[0]

    @cached_property
    def _bare_model(self) -> ModalModel:
        return modes_of(self.case.structure)

    @cached_property
    def _model(self) -> ModalModel:
        """Modes with tuned masses."""
        tuned = (*self.case.tuned_masses, *self._tuned)
        return self.case.model_copy(update={"tuned_masses": tuned}).modes if tuned else self._bare_model

    @cached_property
    def _bare(self) -> Tool:
        return Tool.of(self._bare_model, self.point, self.direction, self.directional_factor)

    @cached_property
    def _tool(self) -> Tool:
        return Tool.of(self._model, self._bare.point, self.direction, self.directional_factor)

    @cached_property
    def _own_amplitudes(self) -> FloatArray | None:
        """Given amplitudes of the tip [m]."""
        if self.amplitudes is None:
            return None
        values = numbers_in(self.amplitudes, lambda value: parse(value, ("m",))[0])
        return _rising(values, "amplitudes", 'amplitudes = ["5 um", "20 um"]')

    @cached_property
    def _map(self) -> LossMap:
        """Study of the loss map of a damper."""
        damper, amplitudes = self._damper, self._own_amplitudes
        if amplitudes is None:
            raise Hint(
                "the map of a damper is computed for amplitudes of the tip, and none are given",
                'amplitudes = rb.geomspace("1 um", "100 um", 12), or a loss map',
                ["amplitudes"],
            )
        points = self._points_of_dampers
        _, chatter = self._bare_samples.smallest_real_part()
        hertz = chatter / (2 * math.pi)
        frequencies = self.frequencies
        if frequencies is None:
            frequencies = np.geomspace(hertz * _MAP_RANGE[0], hertz * _MAP_RANGE[1], _MAP_SIZE[1]).tolist()
        # The amplitude of a damper away from the tip differs from that of the tip by the ratio of the motions, which for
        # one in a tuned mass changes much with the frequency.
        shapes = np.array([space_shape(self._model, name) for name in points])
        among = np.geomspace(hertz * _MAP_RANGE[0], hertz * _MAP_RANGE[1], _RATIOS)
        ratio = np.abs(self._tool.motion_ratio(2 * math.pi * among, shapes))
        ends = amplitudes[0] * ratio.min() / _WIDER, amplitudes[-1] * ratio.max() * _WIDER
        motion: dict[str, Any] = {"amplitude": ends[1], "frequency": hertz, "unit": "m"}
        if damper.base_direction is not None:
            motion["direction"] = self.direction or damper.base_direction
        if not damper.has_equal_cells:
            raise Hint(
                "the cells of the damper are in different fields, but one map holds for all of them",
                "cells at the same arm, without offsets",
                ["damper", "offsets"],
            )
        case = Case(
            structure=Shaker(motion=Harmonic(**motion)),
            dampers=(damper.each()[0].model_copy(update={"point": None}),),
            duration=self.case.duration,
            **({"method": self.case.method} if self.case.dampers or "method" in self.case.model_fields_set else {}),
        )
        return LossMap(case, np.geomspace(*ends, _MAP_SIZE[0]).tolist(), frequencies, cycles=self.cycles)

    @cached_property
    def _points_of_dampers(self) -> tuple[str, ...]:
        own = self._damper.point if self._runs_map else None  # datasets have attributes of any name
        if own is not None and self.at is None and own not in self._model.shapes:
            raise Hint(
                f"the damper is at {own!r}, and the tool has no point of this name",
                f'at = "{self._tool.point}", or damper = [rb.TunedMass(...), damper] for a damper in a tuned mass',
                ["damper", "point"],
            )
        (names,) = points_of_dampers(self.at or own or self._tool.point, self._model)
        return names

    # ---- computation

    @cached_property
    def _bare_samples(self) -> SampledResponse:
        return SampledResponse.of(self._bare.response, self._bare.frequencies(self._speeds * self.teeth))

    def compute(self) -> xarray.Dataset:
        """Compute the limits; see `Study.compute`."""
        bare = self._limits(self._bare, [self._bare_samples], [0.0])
        if self._damper is None:
            samples = SampledResponse.of(self._tool.response, self._tool.frequencies(self._speeds * self.teeth))
            found, about = self._limits(self._tool, [samples], [0.0]), dict[str, Any]()
        else:
            found, about = self._with_map()
        result = self._dataset(bare, found, about)
        result.attrs["answer"] = "\n".join(answer(result))
        if self._runs_map:  # the store holds the runs of the map
            return save_result(result, self.kind, self.store)
        return save_finished(result, self.kind, self.store, self._manifest)

    @property
    def _runs_map(self) -> bool:
        return isinstance(self._damper, Damper)

    @property
    def _manifest(self) -> dict[str, Any]:
        """Description that distinguishes this study from others."""
        names = (
            "cutting_coefficient",
            "directional_factor",
            "teeth",
            "teeth_in_cut",
            "point",
            "direction",
            "at",
            "number",
        )
        return {name: str(getattr(self, name)) for name in names} | {
            "case": self.case.to_toml(),
            "damper": self.damper if isinstance(self.damper, str) else type(self.damper).__name__,
            "speeds": self._speeds.tolist(),
            "amplitudes": [] if self._own_amplitudes is None else self._own_amplitudes.tolist(),
        }

    def _limits(self, tool: Tool, samples: list[SampledResponse], amplitudes: object) -> _Limits:
        """Return the limits of a tool for the response at each amplitude."""
        period = 60 / (self._speeds * self.teeth)
        smallest, lobes = [], []
        for each in samples:
            smallest.append(each.smallest_real_part())
            lobes.append(lobes_of(each, period))
        real, omega = np.array(smallest).T
        stiffest = [each.largest() for each in samples]
        with np.errstate(divide="ignore"):
            return _Limits(
                np.asarray(amplitudes, float),
                np.where(np.isnan(real), np.inf, -0.5 / (self._coefficient * real)),
                omega / (2 * math.pi),
                real,
                abs(tool.factor) / np.array(stiffest),
                np.array([each.depth for each in lobes]).reshape(len(samples), -1) / self._coefficient,
                np.array([each.omega for each in lobes]).reshape(len(samples), -1) / (2 * math.pi),
                np.array([each.waves for each in lobes]).reshape(len(samples), -1),
            )

    def _with_map(self) -> tuple[_Limits, dict[str, Any]]:
        """Return the limits with the dampers of a map at each amplitude, and what is known about them."""
        source = self._damper
        table = LossTable.read(self._map.evaluate(self.run_work(self._map.work)) if self._runs_map else source)
        points = DamperPoints(self._model, self._points_of_dampers, table, self._damper_direction)
        number = self.number or (source.number if self._runs_map else 1)
        loaded = LoadedTool(self._tool, points.shapes, table.masses, number, table.clearance, 0.0)
        amplitudes = self._own_amplitudes
        if amplitudes is None:
            amplitudes = loaded.amplitudes_of_tip(self._bare_samples.smallest_real_part()[1])
        hertz = default_frequencies(None, table.masses, self._model, points.shapes, number)
        omega = 2 * math.pi * np.unique(np.concatenate([hertz, self._tool.natural()]))
        omega = omega[table.masses.covers(omega / (2 * math.pi))]
        samples = [SampledResponse.of(replace(loaded, amplitude=float(each)), omega) for each in amplitudes]
        found = self._limits(self._tool, samples, amplitudes)
        warnings: list[str] = []
        # Nothing is known outside of the map. The structure alone estimates whether a smaller depth may be there.
        unknown = self._unknown(samples, found)
        if unknown.all():
            low, high = table.masses.amplitude[[0, -1]]
            unit = "m/s^2" if table.masses.is_acceleration else "m"
            raise Hint(
                f"the map covers {table.masses.frequency[0]:.4g} to {table.masses.frequency[-1]:.4g} Hz and amplitudes from "
                f"{amount(low, unit)} to {amount(high, unit)}, which do not contain the chatter of this tool",
                f"a map around {amount(float(self._bare_samples.smallest_real_part()[1] / (2 * math.pi)), 'Hz')}",
                ["damper"],
            )
        if count := int(np.count_nonzero(unknown)):
            warnings.append(
                f"at {count} of {counted(unknown.size, 'amplitude')} a smaller depth may lie outside of the frequencies or "
                "amplitudes of the map, and the limit is NaN: compute a larger map"
            )
        beyond = self._beyond(table, found) & ~unknown[:, None]
        if beyond.any():
            warnings.append(
                f"at {np.count_nonzero(beyond)} of {beyond.size} amplitudes and speeds the chatter frequency may lie "
                "outside of the map, and the depth is NaN: compute a map with more frequencies"
            )
        found = found.without(unknown, beyond | unknown[:, None])
        about = self._errors(table, loaded, samples, found)
        about["first_harmonic_share"] = self._share(table, loaded, points, number, found)
        warnings += list(_map_warnings(table, about, loaded, points, number, found))
        return found, about | {"warnings": warnings, "map_case": table.case, "number": number}

    @property
    def _damper_direction(self) -> Any:
        return self.direction if self._model.spatial else None

    def _unknown(self, samples: list[SampledResponse], found: _Limits) -> NDArray[np.bool_]:
        """Return at which amplitudes the limit may lie where the map does not cover the motion."""
        bare = self._bare_samples.values.real
        low, high = samples[0].omega[[0, -1]]
        outside = (self._bare_samples.omega < low) | (self._bare_samples.omega > high)
        with np.errstate(invalid="ignore", divide="ignore"):
            smallest = np.where(bare < 0, -0.5 / (self._coefficient * bare), np.inf)
        unknown = smallest[outside].min(initial=math.inf) < found.limit
        for k, each in enumerate(samples):
            missing = each.omega[np.isnan(each.values.real)]
            alone = self._bare.response(missing).real
            with np.errstate(divide="ignore"):
                inside = np.where(alone < 0, -0.5 / (self._coefficient * alone), np.inf)
            unknown[k] |= bool(inside.min(initial=math.inf) < found.limit[k]) or math.isinf(found.limit[k])
        return np.asarray(unknown)

    def _beyond(self, table: LossTable, found: _Limits) -> NDArray[np.bool_]:
        """Return at which amplitudes and speeds the structure alone has a smaller depth outside of the map."""
        low, high = 2 * math.pi * table.masses.frequency[[0, -1]]

        def outside(omega: FloatArray) -> ComplexArray:
            values = self._bare.response(omega)
            return np.where((omega > low) & (omega < high), np.nan, values)

        samples = SampledResponse(outside, self._bare_samples.omega, outside(self._bare_samples.omega))
        depth = lobes_of(samples, 60 / (self._speeds * self.teeth)).depth / self._coefficient
        return np.asarray((depth < found.depth) | ~np.isfinite(found.depth))

    def _errors(
        self, table: LossTable, loaded: LoadedTool, samples: list[SampledResponse], found: _Limits
    ) -> dict[str, FloatArray]:
        """Return the effect of the interval and of the resolution of the map on the limit."""

        def relative(other: MassTable) -> FloatArray:
            """Return the relative change of the limit with another table."""
            changes = []
            for each, size in zip(samples, found.amplitude, strict=True):
                real = replace(loaded, table=other, amplitude=float(size))(each.omega).real
                changes.append(np.nanmin(each.values.real, initial=0.0) / np.nanmin(real, initial=0.0) - 1)
            return np.array(changes)

        with np.errstate(divide="ignore", invalid="ignore"):
            thinned = [np.abs(relative(other)) for other in table.thinned]
            shifted = [relative(other) for other in table.shifted]
        interval = found.limit * np.hypot(*shifted) if shifted else np.full(found.limit.shape, np.nan)
        error = np.max(thinned, axis=0) if thinned else np.full(found.limit.shape, np.nan)
        return {"limit_interval": interval, "interpolation_error": np.where(np.isnan(found.limit), np.nan, error)}

    def _share(
        self, table: LossTable, loaded: LoadedTool, points: DamperPoints, number: int, found: _Limits
    ) -> FloatArray:
        """Return the share of the motion of the dampers in the first harmonic at the limit, over the amplitude."""
        model = self._model
        damping = np.diag(2 * model.decay) + (0.0 if model.coupling is None else model.coupling)
        _, ratio = damping_of_modes(table.masses, model.stiffness, damping, points.shapes, number)
        shares = np.full(found.limit.shape, np.nan)
        for k in np.flatnonzero(np.isfinite(found.limit)):
            hertz, here = found.limit_frequency[[k]], replace(loaded, amplitude=float(found.amplitude[k]))
            if here.can_rest(2 * math.pi * hertz)[0]:
                shares[k] = 1.0
                continue
            moved = here.motions(2 * math.pi * hertz)
            squared = 1.0 if table.masses.is_acceleration else (2 * math.pi * hertz[0]) ** 2
            each = (np.abs(moved) / squared)[None]  # (L, F, S, P)
            transfer = Transfer(
                model, hertz, points.shapes, self._tool.tip, np.zeros(len(points.points)), self._tool.tip
            )
            shares[k] = np.nanmin(first_harmonic_share(transfer, table, number, each, ratio), initial=1.0)
            if table.harmonics is None or table.variation is None:
                shares[k] = np.nan
        return shares

    def _dataset(self, bare: _Limits, found: _Limits, about: dict[str, Any]) -> xarray.Dataset:
        import xarray

        missing = np.full(found.limit.shape, np.nan)
        over, both = ("amplitude",), ("amplitude", "speed")
        speeds = self._speeds
        data: dict[str, Any] = {}

        def add(name: str, dims: tuple[str, ...], values: object, units: str, long_name: str) -> None:
            data[name] = dims, values, {"units": units, "long_name": long_name}

        add("limit", over, found.limit, "m", "depth of cut that is stable at all speeds")
        add("limit_frequency", over, found.limit_frequency, "Hz", "chatter frequency at that depth")
        add("minimum_real_part", over, found.real, "m/N", "smallest real part of the directional response")
        add("dynamic_stiffness", over, found.stiffness, "N/m", "smallest force over displacement at the tip")
        add(
            "limit_interval", over, about.get("limit_interval", missing), "m", "half of the 95 % interval, from the map"
        )
        add("interpolation_error", over, about.get("interpolation_error", missing), "1", "change with half of the map")
        add(
            "first_harmonic_share", over, about.get("first_harmonic_share", missing), "1", "share of the first harmonic"
        )
        if speeds.size:
            add("depth", both, found.depth, "m", "stable depth of cut")
            add("chatter_frequency", both, found.frequency, "Hz", "chatter frequency")
            add("waves", both, found.waves, "1", "whole waves between two teeth")
            add("bare_depth", ("speed",), bare.depth[0], "m", "stable depth of cut of the structure alone")
        add("bare_limit", (), bare.limit[0], "m", "depth of cut that is stable at all speeds, structure alone")
        add("bare_limit_frequency", (), bare.limit_frequency[0], "Hz", "chatter frequency of the structure alone")
        add("bare_minimum_real_part", (), bare.real[0], "m/N", "smallest real part of the structure alone")
        coords: dict[str, Any] = {
            "amplitude": (over, found.amplitude, {"units": "m", "long_name": f"amplitude, {self._tool.point}"})
        }
        if speeds.size:
            coords["speed"] = "speed", speeds, {"units": "rpm", "long_name": "spindle speed"}
        attrs = {
            "title": "Stability lobes",
            "study": self.kind,
            "case": self.case.model_copy(update={"tuned_masses": (*self.case.tuned_masses, *self._tuned)}).to_toml(),
            "system": self._system(),
            "point": self._tool.point,
            "cutting_coefficient": self._coefficient / (self.teeth_in_cut or self.teeth),
            "directional_factor": self.directional_factor,
            "teeth": self.teeth,
            "teeth_in_cut": float(self.teeth_in_cut or self.teeth),
            "warnings": "\n".join(about.get("warnings", [])),
            "map_case": about.get("map_case", ""),
        }
        return xarray.Dataset(data, coords, attrs)

    def _system(self) -> str:
        """Return a phrase about the dampers; empty without."""
        tuned = (*self.case.tuned_masses, *self._tuned)
        words = [f"{'a' if len(tuned) == 1 else len(tuned)} tuned mass{'es' * (len(tuned) > 1)}"] if tuned else []
        return joined([*words, *(["the dampers of the map"] if self._damper is not None else [])]) if tuned else ""


stability_lobes = study_function(StabilityLobes)


@plain_dataclass(frozen=True, eq=False)
class _Limits:
    """Limits over A amplitudes, and over these and N speeds; see `StabilityLobes`."""

    amplitude: FloatArray
    limit: FloatArray
    limit_frequency: FloatArray
    real: FloatArray
    stiffness: FloatArray
    depth: FloatArray
    frequency: FloatArray
    waves: NDArray[np.int64]

    def without(self, amplitudes: NDArray[np.bool_], cells: NDArray[np.bool_]) -> _Limits:
        """Return the limits with NaN at some amplitudes and at some amplitudes and speeds."""
        names = ("limit", "limit_frequency", "real", "stiffness")
        changed: dict[str, Any] = {name: np.where(amplitudes, np.nan, getattr(self, name)) for name in names}
        changed |= {name: np.where(cells, np.nan, getattr(self, name)) for name in ("depth", "frequency")}
        return replace(self, **changed, waves=np.where(cells, -1, self.waves))


def _map_warnings(
    table: LossTable, about: dict[str, Any], loaded: LoadedTool, points: DamperPoints, number: int, found: _Limits
) -> Iterator[str]:
    """Yield warnings about limits of the method that the result exceeds."""
    heavy = number * table.mass * float((points.shapes**2).sum(axis=1).max())
    if heavy > HEAVY:
        yield (
            f"the mass of the dampers is {100 * heavy:.3g} % of the effective mass for an impact, above {100 * HEAVY:g} %: "
            "impacts are weaker than in the map"
        )
    share = about["first_harmonic_share"]
    if low := int(np.count_nonzero(share < LEAST_SHARE)):
        yield (
            f"at {low} of {counted(share.size, 'amplitude')} less than {100 * LEAST_SHARE:g} % of the motion of the dampers "
            "is in the first harmonic: simulate"
        )
    if table.is_doubtful.any():
        size = found.amplitude.size
        near = 0
        for k in np.flatnonzero(np.isfinite(found.limit)):
            omega = 2 * math.pi * found.limit_frequency[[k]]
            moved = np.abs(replace(loaded, amplitude=float(found.amplitude[k])).motions(omega))
            each = moved / (1.0 if table.masses.is_acceleration else omega[0] ** 2)
            known = np.isfinite(each)
            doubt = table.interpolate(table.is_doubtful.astype(float), found.limit_frequency[[k]], each)
            near += bool((doubt[known] > 0).any())
        if near:
            names = table.limits.replace(" ", ", ")
            yield f"{near} of {counted(size, 'limit')} use runs of the map that exceeded a validity limit ({names})"
