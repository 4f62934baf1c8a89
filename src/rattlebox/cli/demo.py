"""`rattlebox demo`: one steel ball, two restitution models compared."""

from __future__ import annotations

from pathlib import Path

import rattlebox
from rattlebox._util.own_files import claim, list_files
from rattlebox._util.owned_folder import digest_of
from rattlebox.cli.folder import make_folder
from rattlebox.cli.terminal import terminal
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.contacts import Tsuji
from rattlebox.model.reference import reference_case
from rattlebox.model.restitutions import JacksonGreen
from rattlebox.plots.compare import plot_comparison
from rattlebox.results.summary import compare


def run_demo(out: Path) -> None:
    """Simulate both models, print the comparison, write the figure and the netCDF and case files.

    Parameters
    ----------
    out
        Folder for results, created if needed.
    """
    cases = {
        "constant alpha": reference_case(duration=5.0),
        "Jackson-Green": reference_case(Tsuji(restitution=JacksonGreen(), ending="zero_overlap"), duration=5.0),
    }
    stems = {name: name.lower().replace(" ", "_").replace("-", "_") for name in cases}
    files = [*(f"{stem}.{suffix}" for stem in stems.values() for suffix in ("nc", "toml")), "demo.png"]
    make_folder(out)
    console = terminal()
    with claim(out / file for file in files):
        runs = dict(zip(cases, simulate_many(list(cases.values())), strict=True))
        console.print(compare(runs))
        list_files(out, rattlebox.__version__, dict.fromkeys(files, ""))
        for name, run in runs.items():
            run.save(out / f"{stems[name]}.nc")
            cases[name].to_file(out / f"{stems[name]}.toml")
        plot_comparison(runs).savefig(out / "demo.png")
        list_files(out, rattlebox.__version__, {file: digest_of(out / file) for file in files})
    console.print(f"written to {out}: demo.png, and a netCDF and a case file of each model", soft_wrap=True)
