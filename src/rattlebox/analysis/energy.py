"""Energy balance of a run, and measures of the energy that a damper dissipates in each cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, first_harmonic, labelled, positive, sampled, trapezoid_weights

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import Run

T = TypeVar("T", float, FloatArray, "xarray.DataArray")


def energy_shares(run: Run) -> xarray.DataArray:
    """Return the distribution of the energy input over loss channels and motion at the end of a run.

    Parameters
    ----------
    run
        A run.

    Returns
    -------
    xarray.DataArray
        Shares over `channel`: dissipated in the structure ("viscous"), in contacts by normal damping ("normal") and plastic
        flow ("plastic"), in 3-D runs by "sliding" and "rolling", and remaining in "motion". Their sum is one to within the
        energy residual; NaN without energy input.

    Notes
    -----
    L_k / (E(0) + W) with the energy L_k lost in channel k, the initial energy of motion E(0) and the work W of load, base
    and gravity; see `rattlebox.results.Ledger`.
    """
    shares = run.ledger.shares
    channel = ("channel", list(shares), {"units": "", "long_name": "channel of the energy"})
    return labelled("share", list(shares.values()), "1", "share of the energy put in", channel=channel)


def specific_damping_capacity(dissipated: T, stored: T) -> T:
    r"""Return the energy dissipated in a cycle over the largest energy stored in it.

    Parameters
    ----------
    dissipated, stored
        Energies [J]: numbers, lists, arrays or DataArrays that broadcast.

    Returns
    -------
    float, array or DataArray
        Specific damping capacity.

    Raises
    ------
    ValueError
        If an energy is not finite, or the stored energy is not above zero.

    Notes
    -----
    .. math:: \psi = \frac{D}{U}

    with the energy :math:`D` dissipated in a cycle and the largest stored energy :math:`U`.

    References
    ----------
    E. E. Ungar and E. M. Kerwin (1962), Loss factors of viscoelastic systems in terms of energy concepts, J. Acoust. Soc.
    Am. 34, 954-957, doi:10.1121/1.1918227.

    Examples
    --------
    >>> specific_damping_capacity(0.2, 0.5)
    0.4
    """
    if isinstance(dissipated, (list, tuple)) or isinstance(stored, (list, tuple)):
        return specific_damping_capacity(np.asarray(dissipated, float), np.asarray(stored, float))
    if not np.all(np.isfinite(dissipated)) or not np.all(np.isfinite(stored)):
        raise ValueError("dissipated and stored energies must be finite; try: remove the other cycles")
    if not np.all(np.asarray(stored) > 0):
        raise ValueError(f"stored energy is as small as {np.min(stored):g} J, but must be above zero")
    return dissipated / stored


def loss_factor(dissipated: T, stored: T) -> T:
    r"""Return the loss factor, the specific damping capacity over 2 pi.

    Parameters
    ----------
    dissipated, stored
        Energies [J], as for `specific_damping_capacity`.

    Returns
    -------
    float, array or DataArray
        Loss factor.

    Raises
    ------
    ValueError
        If an energy is not finite, or the stored energy is not above zero.

    Notes
    -----
    .. math:: \eta = \frac{D}{2 \pi U}

    with the energy :math:`D` dissipated in a cycle and the largest stored energy :math:`U`.

    References
    ----------
    E. E. Ungar and E. M. Kerwin (1962), Loss factors of viscoelastic systems in terms of energy concepts, J. Acoust. Soc.
    Am. 34, 954-957, doi:10.1121/1.1918227.

    Examples
    --------
    >>> round(loss_factor(0.2, 0.5), 4)
    0.0637
    """
    return specific_damping_capacity(dissipated, stored) / (2 * np.pi)


def complex_power(time: ArrayLike, force: ArrayLike, velocity: ArrayLike, *, frequency: float) -> xarray.Dataset:
    r"""Compute the power that a damper absorbs in harmonic motion, and its effective mass.

    Parameters
    ----------
    time : (N,) array_like
        Increasing times [s] that cover at least one cycle.
    force : (N,) array_like
        Force that drives the damper [N]: minus the force of the balls on their cavity. With forty samples in each contact
        the error of the power is about 0.2 %; hard impacts have no finite force.
    velocity : (N,) array_like
        Velocity of the point at which the force acts [m/s].
    frequency
        Frequency of the motion [Hz].

    Returns
    -------
    xarray.Dataset
        `active_power` [W], `reactive_power` [W], `effective_mass` [kg] and `loss_factor`, the ratio of active power to
        the magnitude of reactive power.

    Raises
    ------
    ValueError
        If less than one cycle is covered, or a sample is not finite.

    Notes
    -----
    .. math:: P = \tfrac{1}{2} F^* V

    with the complex amplitudes :math:`F` of the force and :math:`V` of the velocity over the last whole number of cycles.
    The real part is the absorbed power; the imaginary part is :math:`-\pi f m |V|^2`, with the effective mass :math:`m`.
    The amplitudes are least-squares fits of a mean, a cosine and a sine, which are exact for harmonic samples at any times.

    References
    ----------
    N. Meyer, R. Seifried (2021), Toward a design methodology for particle dampers by analyzing their energy dissipation,
    Computational Particle Mechanics 8, 681-699, doi:10.1007/s40571-020-00363-0.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.linspace(0, 1, 101)
    >>> result = complex_power(time, 2 * np.cos(20 * time), np.cos(20 * time), frequency=20 / (2 * np.pi))
    >>> round(float(result.active_power), 9)
    1.0
    """
    import xarray

    t, f, v = sampled(time, 3, force=force, velocity=velocity)
    frequency = positive("frequency", frequency, "Hz")
    # Parts of a cycle would leak the mean and other harmonics into the amplitudes.
    cycles = np.floor((t[-1] - t[0]) * frequency + 1e-9)
    if cycles < 1:
        raise ValueError(
            f"time covers {(t[-1] - t[0]) * frequency:.3g} cycles of {frequency:g} Hz, at least 1 is needed"
        )
    weights = trapezoid_weights(t, max(t[-1] - cycles / frequency, t[0]))
    f_amplitude, v_amplitude = first_harmonic(t, np.stack([f, v], axis=-1), weights, frequency)
    # Ratios to a velocity of rounding errors would look like results.
    if not abs(v_amplitude) > 1e-9 * np.abs(v).max():
        raise ValueError(f"velocity has no component at {frequency:g} Hz; try: the frequency of the motion")
    power = f_amplitude.conjugate() * v_amplitude / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        loss_factor = float(np.divide(power.real, abs(power.imag)))
    mass = -2 * power.imag / (2 * np.pi * frequency * abs(v_amplitude) ** 2)

    def scalar(value: float, units: str, long_name: str) -> Any:
        return (), value, {"units": units, "long_name": long_name}

    return xarray.Dataset(
        {
            "active_power": scalar(power.real, "W", "absorbed power"),
            "reactive_power": scalar(power.imag, "W", "reactive power"),
            "effective_mass": scalar(mass, "kg", "effective mass"),
            "loss_factor": scalar(loss_factor, "1", "loss factor"),
        },
        attrs={"frequency": frequency, "cycles": int(cycles)},
    )
