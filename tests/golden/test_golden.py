"""Both engines give their golden results.

`record.py` in this folder stores new results after an intended change.
"""

from __future__ import annotations

import pytest

import rattlebox as rb

from . import cases, compute, quantities, store

OTHERS = [pytest.param(level, marks=pytest.mark.slow) for level in ("v1", "v3", "native")]


@pytest.mark.parametrize("level", ["v4", *OTHERS])
def test_golden_results(level: str) -> None:
    """Each instruction set reproduces the stored values to 1e-11 and the stored bits, also with threads and restarts."""
    if level not in quantities.levels():
        pytest.skip(f"{level} is not built, or this processor cannot run it")
    found = compute.compute(level, compute.with_variants(list(cases.CASES)))
    made_with = store.made_with(level)
    wrong, no_bits = [], []
    for name, each in found.items():
        stored = store.read(compute.case_of(name))
        if not stored:
            wrong.append(f"{name}: no golden results are stored")
            continue
        if name in cases.VALUES:
            worst = [
                d
                for d in store.deviations(stored["values"], each, compute.impacts_compared(name))
                if not d.size <= store.TOLERANCE
            ]
            wrong += [f"values of {name}: {deviation.text}" for deviation in worst[:3]]
        wanted = stored["bits"].get(level)
        if wanted is None or wanted["made_with"] != made_with:
            no_bits.append(name)
            continue
        digests = store.digests(each)
        differing = [quantity for quantity in wanted["digests"] if digests.get(quantity) != wanted["digests"][quantity]]
        if differing:
            wrong.append(f"bits of {name}: {', '.join(differing)}")
    assert not wrong, f"{len(wrong)} differences with {level}:\n" + "\n".join(wrong)
    if no_bits:
        pytest.skip(
            f"values agree; bits are not compared in {len(no_bits)} of {len(found)} runs, because none are stored for "
            f"{level} with {made_with}"
        )


@pytest.mark.slow
@pytest.mark.parametrize("name", cases.ENSEMBLES)
def test_golden_statistics(name: str) -> None:
    """Means over an ensemble of chaotic runs have 95 % intervals that overlap with the stored ones.

    Without a change of the physics two such intervals are disjoint once in about 200 comparisons.
    """
    runs = rb.simulate_many(cases.ENSEMBLES[name]())
    found = store.statistics([quantities.measures(quantities.quantities(run)) for run in runs])
    wrong = store.apart(store.read(name, store.DATA / "statistics")["measures"], found)
    assert not wrong, "\n".join(wrong)
