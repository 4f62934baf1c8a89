"""Response from a map against simulation
======================================

For users who ask how exact a response from a loss map is: a ball and a bed of 200 balls, each on two structures.

Maps of both dampers give the frequency responses; stepped sines of the same structures give them in full. The peaks agree
within 10 %, at a thousandth of the processor time.

:doc:`/how-to/map_on_structure` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "map", "response"]

import time

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

ONE_MODE = rb.SDOF(mass="2 kg", frequency="150 Hz", damping_ratio=0.003)
K = np.array([[2, -1, 0], [-1, 2, -1], [0, -1, 1]]) * 1.4656e6  # N/m
THREE_MODES = rb.Matrices(
    M=np.diag([3.0, 2.0, 2.0]).tolist(),
    C=(6.37e-6 * K).tolist(),  # 0.3 % of critical damping in the second mode
    K=K.tolist(),
    points={"foot": 0, "middle": 1, "top": 2},
)
STRUCTURES = {"one mode": ONE_MODE, "three modes": THREE_MODES}
BALL = rb.ImpactDamper(
    ball=rb.Sphere(diameter="20 mm", material="steel"),
    gap="0.2 mm",
    velocity="0.1 m/s",
    contact=rb.Tsuji(restitution=0.6),
)
BED = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter="4 mm", count=200),
    cavity=rb.Box(size=("40 mm", "40 mm", "10 mm")),
    contact=rb.Tsuji(restitution=0.7),
    friction=0.3,
    direction="z",
    packing=rb.Settled(seed=1),
    softening="auto",
)
DAMPERS = {"ball": BALL, "bed": BED}
CYCLES = {"ball": (300, 100), "bed": (100, 60)}  # to skip, and to evaluate
FREQUENCIES = {"ball": ["140 Hz", "155 Hz"], "bed": ["146 Hz", "152 Hz"]}
AMPLITUDES = {"ball": rb.geomspace("0.05 mm", "2 mm", 51), "bed": rb.geomspace("0.4 mm", "1.2 mm", 10)}
LEVELS = {"ball": {"one mode": "10 N", "three modes": "15 N"}, "bed": {"one mode": "44 N", "three modes": "60 N"}}
STEPS = 1 + np.array([-0.01, -0.006, -0.003, 0.0, 0.003, 0.006])  # frequencies over that of the peak


def options(name):
    """Return the method of a damper: hard impacts for the ball."""
    return {"method": rb.Newton()} if name == "ball" else {}


def loss_map(name):
    """Return the map of a damper."""
    motion = rb.Harmonic(amplitude="0.1 mm", frequency="150 Hz", **({} if name == "ball" else {"direction": "z"}))
    shaker = rb.Case(structure=rb.Shaker(motion=motion), damper=DAMPERS[name], duration="1 s", **options(name))
    return rb.loss_map(shaker, AMPLITUDES[name], FREQUENCIES[name], cycles=CYCLES[name])


def compare(name, loss, which):
    """Return the responses of a structure near its peak from the map, and from simulation."""
    structure, level = STRUCTURES[which], LEVELS[name][which]
    places = {} if which == "one mode" else {"point": "top"}
    from_map = {"level": level, **({"at": "top", "load_point": "top"} if places else {})}
    peak = rb.response_from_map(structure, loss, **from_map).peak_frequency.item()
    case = rb.Case(
        structure=structure,
        damper=DAMPERS[name].model_copy(update=places),
        load=rb.Harmonic(amplitude=level, frequency=peak, **places),
        duration="1 s",
        **options(name),
    )
    hertz = peak * STEPS
    simulated = rb.frequency_response(case, hertz.tolist(), direction="up", cycles=CYCLES[name])
    smooth = np.union1d(hertz, np.linspace(hertz[0], hertz[-1], 101))
    return rb.response_from_map(structure, loss, frequencies=smooth.tolist(), **from_map), simulated


def draw(axes, name, which, from_map, simulated):
    """Draw the response from the map, the 95 % interval of its peak, and the simulated one."""
    hertz, one = from_map.frequency.values, from_map.isel(at=0, number=0, level=0)
    axes.plot(hertz, 1e3 * one.amplitude.max("solution"), label="map")
    half = 1e3 * one.peak_interval.item()
    axes.errorbar(one.peak_frequency, 1e3 * one.peak, yerr=half, color=rb.plots.SERIES_COLOURS[0], capsize=4)
    axes.plot(simulated.frequency, 1e3 * simulated.amplitude.values.ravel(), "o", label="simulated")
    axes.margins(x=0.03)
    axes.set(
        title=f"{name}, {which}, {LEVELS[name][which]}",
        xlabel="Frequency (Hz)",
        ylabel="Amplitude (mm)",
        ylim=(0, None),
    )


@rb.plots.figure_style("page")
def main():
    """Compare the responses of both dampers on both structures, and draw them."""
    figure, panels = plt.subplots(2, 2, figsize=(8, 6), layout="constrained")
    for row, name in zip(panels, DAMPERS, strict=True):
        before = time.process_time()
        loss = loss_map(name)
        loss.to_netcdf(f"{name}.nc")  # the file for colleagues
        print(f"map of the {name}: {time.process_time() - before:.0f} s of processor time")
        for axes, which in zip(row, STRUCTURES, strict=True):
            from_map, simulated = compare(name, loss, which)
            draw(axes, name, which, from_map, simulated)
            at_peak = from_map.sel(frequency=from_map.peak_frequency.item())
            peak, full = from_map.peak.item(), simulated.amplitude.max().item()
            half = 100 * from_map.peak_interval.item() / peak
            print(
                f"{name} on {which}: peak {1e3 * peak:.3f} mm ± {half:.1f} % from the map, {1e3 * full:.3f} mm simulated: "
                f"{100 * (peak / full - 1):+.1f} %"
            )
            assert abs(peak / full - 1) < 0.1
            assert not at_peak.flags.any() and at_peak.first_harmonic_share.min() > 0.95
            assert (0.5 * simulated.amplitude**2 / simulated.rms**2).max() > 0.95
    panels[0, 0].legend()
    figure.savefig("map_against_simulation.png", dpi=200)


if __name__ == "__main__":
    main()
