"""Texts from Jinja2 templates in the folder `templates` of a package."""

from __future__ import annotations

from collections.abc import Callable


def render(
    package: str, template: str, filters: dict[str, Callable[..., object]] | None = None, /, **values: object
) -> str:
    """Return a template of a package with its values, which are escaped; a value that is missing is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined  # takes longer to load than many a command to run

    environment = Environment(
        loader=PackageLoader(package),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters |= filters or {}
    return environment.get_template(template).render(values)
