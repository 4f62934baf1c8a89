"""Provenance of a run: version, machine, method and seed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache


@dataclass(frozen=True, slots=True)
class Provenance:
    """Origin of a run; `continues` names the run that it continues, or is empty."""

    version: str = ""
    method: str = ""
    seed: int = 0
    created: str = ""
    platform: str = ""
    continues: str = ""

    @classmethod
    def now(cls, method: str = "", seed: int = 0, continues: str = "") -> Provenance:
        """Return the provenance of a run on this machine at the current time."""
        import platform
        from datetime import UTC, datetime

        return cls(
            version=_version(),
            method=method,
            seed=int(seed),
            created=datetime.now(UTC).isoformat(timespec="seconds"),
            platform=f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
            continues=continues,
        )


def with_version(version: str) -> str:
    """Return the words that name the version which resumes what it began; "" if it is the present one."""
    return "" if version in ("", _version()) else f" with Rattlebox {version}"


@cache
def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("rattlebox")
    except PackageNotFoundError:
        return "unknown"
