"""Calibration of contact parameters: values with intervals from measurements."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, at
from rattlebox.model.units import parse, whole_number
from rattlebox.studies.calibration.by_simulation import Calibration
from rattlebox.studies.calibration.measurements import Contacts, Losses, read_data, source_of
from rattlebox.studies.calibration.restitution import restitution_of
from rattlebox.studies.calibration.space import Space
from rattlebox.studies.calibration.work import simulation_of
from rattlebox.studies.run.store import save_result

if TYPE_CHECKING:
    import xarray

KIND = "calibrate"
"""Kind of the result in its attribute `study`."""


def calibrate(
    data: Contacts | Losses | Sequence[Contacts] | Sequence[Losses],
    case: Case | None = None,
    parameters: Mapping[str, tuple[Any, Any]] | None = None,
    *,
    known: Mapping[str, tuple[float, float]] | None = None,
    runs: int = 64,
    checks: int = 8,
    log: Sequence[str] = (),
    seed: int = 0,
    budget: Any = None,
    workers: int | None = None,
    backend: Any = "threads",
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    r"""Calibrate contact parameters from measurements: values with 95 % intervals.

    `Drops` and `BounceTimes` give the restitution in closed form and need no case. `RingDown` and `ShakerLoss` are compared
    with simulations of a case over one to three of its parameters.

    Parameters
    ----------
    data
        One measurement, or several of single impacts, or several of losses.
    case
        Case with the damper of the measurement. Loads are ignored. For a ring-down with its structure, including the damping
        without particles; its duration is the length of a simulated decay. For losses on a shaker the structure is ignored.
    parameters
        Pairs (smallest, largest) by path: {"damper.contact.restitution": (0.5, 0.95), "damper.friction": (0.0, 0.6)}.
    known
        Parameters that are known from elsewhere: value and half of the width of its 95 % interval, by path, as
        {"damper.contact.restitution": (0.80, 0.02)}.
    runs
        Number of samples of the parameters in each of up to two rounds. Each has a random packing, or start, of its own.
    checks
        Number of further packings that are simulated at the result.
    log
        Paths whose range is sampled uniformly in the logarithm.
    seed
        Random seed of the samples.
    budget
        Longest predicted wall time, such as "10 min"; if more is predicted, nothing runs.
    workers, backend
        See `rb.sweep`.
    store
        Folder for the runs. The same call resumes after a stop.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished samples and of all; the
        calibration stops if it returns False. With True, the predicted time is printed if it is above 2 s or a budget is
        given.

    Returns
    -------
    xarray.Dataset
        Over `parameter`: `value`, `lower` and `upper` limit of the 95 % interval, in the SI `unit`; `attrs["warnings"]`
        lists what limits their use. From single impacts also, over `impact`: `approach_speed` [m/s], `restitution` and the
        number `data_set` of its measurement; `exponent` of a power law over the speed, with half of its interval.
        From losses also `is_lower_bounded` and `is_upper_bounded`, whether the data bound a parameter within its range;
        `correlation` over `parameter` and `other`; over `datum`: `measured` with its standard uncertainty `error`, `fitted`
        by the response surface, `check` and `check_deviation` of the further packings, and `scatter` of one packing; over
        `sample`: `simulated`, and the parameters; over `parameter` and `place`: `profile`, chi^2 above its minimum; and
        `region`, the same over the first two parameters. Attributes: `chi2`, `degrees_of_freedom` and `p_value` of the fit;
        `undetermined`, which parameters the data do not determine or separate.

    Raises
    ------
    CaseError
        If an argument is not valid, there are fewer than two data or fewer data than parameters, more than half of the
        runs have no value, or the predicted time exceeds the budget.
    StoreError
        If the store holds another study.
    Stopped
        After Ctrl-C.

    Notes
    -----
    Restitution from heights is sqrt(h_1/h_0), and from flights T_2/T_1; the interval is that of Student's t.

    For losses, a polynomial of first to third degree in the parameters (the degree with the smallest leave-one-out error) is
    fitted to the simulated values of each datum, and

    .. math:: \chi^2 = (y - f)^T (D + S)^{-1} (y - f)

    with the measured values y, the polynomials f, the variances D of the measurement, and the covariance S of the
    leave-one-out errors, which contain the scatter of random packings: the measured damper is one of them. The interval of a
    parameter holds the values at which the smallest chi^2 over all other parameters is above its minimum by less than the
    95 % quantile of F(1, n). S is scaled so that its inverse is unbiased (Hartlap et al.). The uncertainties of the data are
    assumed to be independent of each other.

    The model of the case is assumed to be right in all else: size and number of particles, cavity, damping of the structure.
    Their errors are in the result. Effective values of friction and restitution at the speeds of the measurement follow.

    References
    ----------
    G. E. P. Box, K. B. Wilson (1951), On the experimental attainment of optimum conditions, Journal of the Royal Statistical
    Society B 13, 1-45, doi:10.1111/j.2517-6161.1951.tb00067.x (response surface).
    D. M. Allen (1974), The relationship between variable selection and data augmentation and a method for prediction,
    Technometrics 16, 125-127, doi:10.1080/00401706.1974.10489157 (leave-one-out errors).
    J. Hartlap, P. Simon, P. Schneider (2007), Why your model parameter confidences might be too optimistic, Astronomy &
    Astrophysics 464, 399-404, doi:10.1051/0004-6361:20066170 (inverse of an estimated covariance).
    D. J. Venzon, S. H. Moolgavkar (1988), A method for computing profile-likelihood-based confidence intervals, Journal of
    the Royal Statistical Society C 37, 87-94, doi:10.2307/2347496.

    Examples
    --------
    >>> import rattlebox as rb
    >>> drops = rb.Drops(height="300 mm", rebound=["192 mm", "189 mm", "194 mm", "188 mm", "191 mm"])
    >>> result = rb.calibrate(drops)
    >>> f"{result.value.item():.3f} ({result.lower.item():.3f} to {result.upper.item():.3f})"
    '0.797 (0.791 to 0.804)'
    """
    contacts, losses = read_data(data)
    if contacts:
        for name, value in {"case": case, "parameters": parameters, "known": known, "store": store}.items():
            if value is not None:
                raise Hint("drops and bounces give the restitution without simulations", f"no {name}", [name])
        return restitution_of(contacts).assign_attrs(study=KIND, data=[source_of(each) for each in contacts])
    if not isinstance(case, Case) or not case.dampers:
        raise Hint(
            "losses are compared with simulations, which need a case with a damper",
            "rb.calibrate(data, case, parameters)",
            ["case"],
        )
    calibration = Calibration(
        case=case,
        space=Space.of(case, parameters, log, known),
        simulations=[simulation_of(each, case) for each in losses],
        runs=whole_number(runs, "runs", 1),
        checks=whole_number(checks, "checks", 2),
        seed=whole_number(seed, "seed", 0),
        where={"backend": backend, "workers": workers},
        store=None if store is None else Path(store),
        progress=progress,
    )
    calibration.validate()
    calibration.check_budget(None if budget is None else _seconds(budget))
    result = calibration.result().assign_attrs(data=[source_of(each) for each in losses])
    return save_result(result, KIND, store)


def _seconds(budget: Any) -> float:
    """Return the budget [s]."""
    with at("budget"):
        seconds, _ = parse(budget, ("s",))
        if not seconds > 0:
            raise Hint(f"{seconds:g} s is not greater than zero", '"10 min"')
    return seconds
