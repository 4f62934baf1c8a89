"""Stores golden results, and prints what changes and by how much.

    python tests/golden/record.py [--level bits|values|statistics ...] [--dry-run] CASE ... | --all

CASE is the name of a case or of an ensemble, or a pattern such as "dem *"; --list prints them. Without --level all three
are recorded. Bits are recorded for all instruction sets that this machine can run; those of others are removed when the
bits change, because they are out of date. Values are those of the best instruction set. Build all instruction sets first.
"""

from __future__ import annotations

import argparse
import fnmatch
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import rattlebox as rb
from golden import cases, compute, quantities, store

LEVELS = ("bits", "values", "statistics")
_changed: set[str] = set()


def record_runs(names: Sequence[str], what: Sequence[str], dry: bool) -> None:
    """Record bits and values of cases."""
    found = {level: store.complete(compute.compute(level, names)) for level in quantities.levels()}
    for name in names:
        stored = store.read(name)
        old_bits, values = stored.get("bits", {}), stored.get("values", {})
        bits = old_bits
        if "bits" in what:
            bits = {
                level: {"made_with": store.made_with(level), "digests": store.digests(each[name])}
                for level, each in found.items()
            }
            changes = [text for level in bits for text in _changed_bits(level, old_bits.get(level), bits[level])]
            if not any(level in old_bits and old_bits[level]["digests"] != bits[level]["digests"] for level in bits):
                bits = {**old_bits, **bits}
            removed = [level for level in old_bits if level not in bits]
            reason = "out of date, and it is not built or cannot run here"
            changes += [f"bits of {level} are removed: {reason}" for level in removed]
            _print(name, changes)
        if "values" in what and name in cases.VALUES:
            best = next(iter(found.values()))[name]
            impacts = compute.impacts_compared(name)
            deviations = store.deviations(values, best, impacts) if values else ()
            _print(name, [f"values: {deviation.text}" for deviation in deviations] if values else ["values: new"])
            values = store.values(best, impacts)
        if not dry:
            store.write(name, {"bits": bits, "values": values})


def _changed_bits(level: str, old: dict[str, dict[str, str]] | None, new: dict[str, dict[str, str]]) -> list[str]:
    if old is None:
        return [f"bits of {level}: new"]
    names = [name for name, digest in new["digests"].items() if old["digests"].get(name) != digest]
    gone = [f"{name} (no longer computed)" for name in old["digests"] if name not in new["digests"]]
    made = (
        [f"made with {new['made_with']} instead of {old['made_with']}"] if new["made_with"] != old["made_with"] else []
    )
    return [f"bits of {level}: {', '.join([*made, *names, *gone])}"] if names or gone or made else []


def record_statistics(name: str, dry: bool) -> None:
    """Record the statistics of an ensemble."""
    runs = rb.simulate_many(cases.ENSEMBLES[name]())
    for run in runs:
        store.complete({name: quantities.quantities(run)})
    new = store.statistics([quantities.measures(quantities.quantities(run)) for run in runs])
    old = store.read(name, store.DATA / "statistics").get("measures", {})
    apart = store.apart(old, new) if old else []
    changed = [
        f"{key}: {value['mean']:.6g} ± {value['half_width']:.2g}" for key, value in new.items() if value != old.get(key)
    ]
    _print(f"ensemble {name}", [*changed, *(f"intervals do not overlap: {text}" for text in apart)])
    if not dry:
        store.write(name, {"measures": new}, store.DATA / "statistics")


def _print(name: str, changes: Sequence[str]) -> None:
    _changed.update([name] if changes else [])
    for change in changes:
        print(f"{name}: {change}", flush=True)


def main() -> None:
    """Record the requested results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="*")
    parser.add_argument("--level", action="append", choices=LEVELS)
    parser.add_argument("--all", action="store_true", help="all cases and ensembles")
    parser.add_argument("--dry-run", action="store_true", help="print the changes, store nothing")
    parser.add_argument("--list", action="store_true", help="print the names")
    options = parser.parse_args()
    if options.list:
        print("\n".join([*cases.CASES, *(f"{name} (ensemble)" for name in cases.ENSEMBLES)]))
        return
    patterns = ["*"] if options.all else options.case
    what = options.level or LEVELS
    names = [name for name in cases.CASES if any(fnmatch.fnmatch(name, pattern) for pattern in patterns)]
    ensembles = [name for name in cases.ENSEMBLES if any(fnmatch.fnmatch(name, pattern) for pattern in patterns)]
    if not names and not ensembles:
        parser.error("no case or ensemble of this name; --list prints the names, --all takes all of them")
    if names and {"bits", "values"} & set(what):
        record_runs(names, what, options.dry_run)
    for name in ensembles if "statistics" in what else ():
        record_statistics(name, options.dry_run)
    print(f"{len(_changed)} changed")


if __name__ == "__main__":
    main()
