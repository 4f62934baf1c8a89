"""Loose, dense and full beds
==========================

For engineers who know how full a cavity is: what loose, compacted and full beds of the same cavity hold.

Beds of steel balls fill a cylinder to 90 %, or completely. Balls fill less of it than their bed does, because 38 to 43 % of
a bed far from walls is voids.

:doc:`/how-to/fills` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "inputs"]

import matplotlib.pyplot as plt

import rattlebox as rb

FRICTIONS = (0.0, 0.3, 1.0)


# %%
# A fill is a share of the cavity's volume that the bed takes up, with its voids.


def cylinder(bed_fill, packing, friction=0.3, **size):
    """Return a damper whose bed fills a part of a cylinder."""
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", bed_fill=bed_fill),
        cavity=rb.Cylinder(**({"diameter": "30 mm", "length": "40 mm"} | size)),
        contact=rb.Tsuji(restitution=0.7),
        friction=friction,
        packing=packing,
    )


# %%
# The same cylinder poured and shaken down, and a wider one to measure the density far from walls.


@rb.plots.figure_style("page")
def main():
    """Measure the beds, draw the figure and check the numbers."""
    beds = {
        "poured, 90 %": rb.measure_bed(cylinder(0.9, rb.Settled(seed=1))),
        "shaken down, 90 %": rb.measure_bed(cylinder(0.9, rb.Compacted(seed=1))),
        "shaken down, full": rb.measure_bed(cylinder(1, rb.Compacted(seed=1))),
    }
    for name, bed in beds.items():
        print(f"{name}: {bed.count} balls, of the cavity {bed.fill_ratio:.3f} are balls and {bed.bed_fill:.2f} bed")
    wide = {"diameter": "48 mm", "length": "48 mm"}
    poured = [rb.measure_bed(cylinder(0.8, rb.Settled(seed=1), friction, **wide)) for friction in FRICTIONS]
    shaken = rb.measure_bed(cylinder(0.8, rb.Compacted(seed=1), **wide))
    for friction, bed in zip(FRICTIONS, poured, strict=True):
        print(f"poured with friction {friction}: {bed.bulk_density:.3f} ± {bed.bulk_error:.3f} far from walls")
    print(f"shaken down: {shaken.bulk_density:.3f} ± {shaken.bulk_error:.3f} far from walls")
    draw(beds, poured, shaken)
    check(beds, poured, shaken)


# %%
# Bars show both fills of each bed; the curve shows how friction keeps a poured bed loose.


def draw(beds, poured, shaken):
    """Draw fills and densities."""
    figure, panels = plt.subplots(1, 2, figsize=(7.5, 3), layout="constrained")
    for shift, part in ((-0.2, "bed_fill"), (0.2, "fill_ratio")):
        places = [k + shift for k in range(len(beds))]
        values = [100 * getattr(bed, part) for bed in beds.values()]
        panels[0].bar(places, values, width=0.4, label=part, color=rb.plots.SERIES_COLOURS[int(shift > 0)])
    panels[0].set_xticks(range(len(beds)), [name.replace(", ", "\n") for name in beds])
    panels[0].set(ylabel="Part of the cavity (%)", ylim=(0, 125))
    panels[0].legend(ncols=2, loc="upper left")
    densities, errors = [bed.bulk_density for bed in poured], [bed.bulk_error for bed in poured]
    panels[1].errorbar(FRICTIONS, densities, errors, fmt="o-", ms=4, capsize=3, label="poured")
    panels[1].axhspan(
        shaken.bulk_density - shaken.bulk_error,
        shaken.bulk_density + shaken.bulk_error,
        color="0.85",
        label="shaken down",
    )
    panels[1].set(xlabel="Coefficient of friction", ylabel="Volume fraction far from walls")
    panels[1].margins(x=0.03)
    panels[1].legend()
    figure.savefig("fills.png", dpi=200)


# %%
# The numbers of the page.


def check(beds, poured, shaken):
    """Raise if a number has changed."""
    assert [bed.count for bed in beds.values()] == [399, 417, 450]
    assert all(bed.full_count == 450 for bed in beds.values())
    for bed, known in zip((*poured, shaken), (0.64, 0.60, 0.57, 0.62), strict=True):
        assert abs(bed.bulk_density - known) < bed.bulk_error + 0.01


if __name__ == "__main__":
    main()
