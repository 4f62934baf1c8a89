"""What is said of bad input: where, which value, what is allowed, what to try."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import ValidationError


class CaseError(ValueError):
    """A case that cannot be run, with a message that fits one screen."""


class Hint(ValueError):
    """A complaint from a validator with a suggestion on its own line.

    Parameters
    ----------
    complaint
        What is wrong and what is allowed.
    suggestion
        What to try.
    """

    def __init__(self, complaint: str, suggestion: str = "") -> None:
        super().__init__(complaint)
        self.complaint = complaint
        self.suggestion = suggestion


def nearest(name: str, known: Iterable[str]) -> str:
    """Return "did you mean ...?" for the closest known names, or the list of them."""
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=2, cutoff=0.6)
    if close:
        return "did you mean " + " or ".join(repr(word) for word in close) + "?"
    return "known: " + ", ".join(known)


def _place(location: tuple[Any, ...]) -> str:
    words: list[str] = []
    for part in location:
        if isinstance(part, int):
            words[-1:] = [f"{words[-1] if words else ''}[{part}]"]
        elif part not in _TAGS and not str(part).startswith(("function-", "tagged-")):
            words.append(str(part))
    return ".".join(words)


_TAGS = {
    "sdof", "modal", "matrices", "fixed", "shaker", "half_sine", "harmonic", "record", "tsuji", "linear", "thornton",
    "constant", "table", "jackson_green", "johnson", "event_driven", "two_step", "newton", "float", "str",
}  # fmt: skip


def _shown(value: Any) -> str:
    try:
        repr(value)
    except ValueError:  # an integer of thousands of digits
        return "a number of thousands of digits"
    text = repr(value) if not isinstance(value, dict) else "{" + ", ".join(map(str, value)) + "}"
    return text if len(text) <= 60 else text[:57] + "..."


def _fields_near(location: tuple[Any, ...], fields: dict[str, set[str]]) -> set[str]:
    parts = [str(part) for part in location[:-1]]
    for part in reversed(parts):
        if part in fields:
            return fields[part]
    return fields.get("", set())


def translate(error: ValidationError, source: str | os.PathLike[str], fields: dict[str, set[str]]) -> CaseError:
    """Turn pydantic's findings into one message.

    Parameters
    ----------
    error
        What pydantic found.
    source
        The file or the class that was read.
    fields
        Known field names by the tag or field that holds them, for "did you mean".
    """
    blocks: list[str] = []
    findings = error.errors(include_url=False)
    for finding in findings[:4]:
        location = finding["loc"]
        place = _place(location) or "the case"
        raised = (finding.get("ctx") or {}).get("error")
        complaint, suggestion = finding["msg"], ""
        if isinstance(raised, Hint):
            complaint, suggestion = raised.complaint, raised.suggestion
        elif isinstance(raised, ValueError):
            complaint = str(raised)
        elif finding["type"] == "extra_forbidden":
            complaint = "there is no such field here"
            suggestion = nearest(
                str(location[-1]),
                _fields_near(
                    location,
                    {
                        "": fields.get(str(source), fields.get("", set())),
                        **{k: v for k, v in fields.items() if k},
                    },
                ),
            )
        elif finding["type"] == "missing":
            complaint = "this field is needed"
        elif finding["type"] in ("union_tag_invalid", "union_tag_not_found"):
            context = finding.get("ctx") or {}
            complaint = f"'kind' must be one of {context.get('expected_tags', '')}"
            if "tag" in context:
                tags = [tag.strip(" '") for tag in str(context.get("expected_tags", "")).split(",")]
                suggestion = nearest(str(context["tag"]), tags)
        head = f"{source}: {place}"
        if finding["type"] not in ("missing", "extra_forbidden") and not isinstance(finding["input"], dict):
            head += f" = {_shown(finding['input'])}"
        blocks.append("\n".join([head, f"  {complaint}", *([f"  try: {suggestion}"] if suggestion else [])]))
    if len(findings) > 4:
        blocks.append(f"and {len(findings) - 4} more")
    return CaseError("\n".join(blocks))
