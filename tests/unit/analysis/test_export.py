"""The package is one name of rattlebox, and costs nothing until it is used."""

import subprocess
import sys

import rattlebox as rb


def test_analysis_is_a_public_name():
    """Every function can be reached from rattlebox and is described."""
    assert "analysis" in dir(rb)
    for name in rb.analysis.__all__:
        assert (getattr(rb.analysis, name).__doc__ or "").strip()


def test_import_loads_nothing_heavy():
    """Neither rattlebox nor its analysis loads xarray or scipy.signal before a function is called."""
    code = (
        "import sys, rattlebox; early = 'rattlebox.analysis' in sys.modules; rattlebox.analysis.settling_time; "
        "print(early, [name for name in ('xarray', 'scipy.signal', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False []"
