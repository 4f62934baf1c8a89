"""Messages about invalid input, with place, value, allowed values and advice."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rattlebox._util.exceptions import CaseError, DataError, RattleboxError, ResourceError

from .synonyms import ABSENT, MEANT

if TYPE_CHECKING:
    from pydantic import ValidationError

Vocabulary = Mapping[str, Mapping[str, Mapping[str, str]]]
"""Names of fields with an example or "", by the field that holds the part and by the kind of the part."""

_LIMIT = 4  # errors in a message
_EXAMINED = 100  # errors that are compared with each other and with all known names; others are only counted
_SPELLINGS = {
    "loads": "load",
    "dampers": "damper",
    "tuned_masses": "tuned_mass",
    "stops": "stop",
    "balls": "ball",
    "radius": "diameter",
}
_NOTHING = object()
NOT_POSITIVE = "must be greater than zero"
NEGATIVE = "must not be negative"


class Hint(CaseError):
    """CaseError of a validator; `at` and `translate` add the place in the case and the file."""


@contextmanager
def at(*place: str | int) -> Iterator[None]:
    """Add a place in the case to an error that is raised in the block."""
    try:
        yield
    except (Hint, DataError, ResourceError) as error:
        raise error.restated(place=(*place, *error.place)) from None


def one_of(advice: str, **alternatives: Any) -> None:
    """Raise unless exactly one of the alternatives is not None."""
    given = [name for name, value in alternatives.items() if value is not None]
    if not given:
        raise Hint(f"{' or '.join(alternatives)} is needed", advice)
    if len(given) > 1:
        raise Hint(f"give {' or '.join(given)}, not both", advice)


def several(number: int, thing: str) -> str:
    """Return "1 particle", "2 particles"."""
    return f"{number} {thing}" + "s" * (number != 1)


def nearest(name: str, known: Iterable[str], *, listed: bool = False) -> str:
    """Return "did you mean ...?" with synonyms or the closest known names; without any, or if `listed`, list all names."""
    known = sorted(known)
    close = _close(name, known)
    parts = ["did you mean " + " or ".join(repr(word) for word in close) + "?"] if close else []
    if listed or not close:
        parts.append("known: " + ", ".join(known))
    return " ".join(parts)


def _folded(name: object) -> str:
    """Return a name as synonyms are written."""
    return str(name).lower().replace("-", "_").replace(" ", "_")


def _close(name: str, known: Sequence[str]) -> list[str]:
    """Return the known names of which a name is a synonym, or else those with a similar spelling."""
    meant = [word for word in (*MEANT.get(name, ()), *MEANT.get(_folded(name), ())) if word.split(".")[0] in known]
    same = [word for word in known if word.lower() == name.lower()]  # Kg is closer to kg than to g.
    similar = list(dict.fromkeys(meant)) or same or difflib.get_close_matches(name, known, n=2, cutoff=0.6)
    folded = {} if similar else {word.lower(): word for word in known}
    return similar or [folded[word] for word in difflib.get_close_matches(name.lower(), folded, n=2, cutoff=0.6)]


def translate(
    error: ValidationError, source: str | os.PathLike[str], vocabulary: Vocabulary, given: object = None
) -> RattleboxError:
    """Translate the errors of pydantic into one error of Rattlebox."""
    findings = _without_echoes(
        _misspelt_fields_first(error.errors(include_url=False), str(source), vocabulary), vocabulary
    )
    kinds = {type(_raised(finding)) for finding in findings}
    kind = kinds.pop() if len(kinds) == 1 else CaseError
    kind = kind if kind in (DataError, ResourceError) else CaseError
    parts: dict[str, RattleboxError] = {}
    for finding in findings[:_EXAMINED]:
        location = (*finding["loc"], *getattr(_raised(finding), "place", ()))
        if finding["type"] == "union_tag_invalid":
            location += ("kind",)
        missing = finding["type"] == "missing"
        words, value = _as_written(given, location, len(finding["loc"]) - missing)
        place = ".".join(words)
        head = f"{source}: {place}" if place else f"{source}:"
        if not missing and value is not _NOTHING and not _holds_tables(value):
            head += f" = {_shown(value)}"
        complaint, suggestion = _complaint_and_suggestion(finding, value, str(source), vocabulary, place)
        suggestion = suggestion or _plain_advice(finding)
        part = kind(complaint, suggestion, words, head=head, allowed=_allowed(finding, str(source), vocabulary))
        parts.setdefault(str(part), part)
    count = len(parts) + len(findings[_EXAMINED:])
    if count == 1:
        return next(iter(parts.values()))
    texts = list(parts)
    return kind("\n".join(texts if count <= _LIMIT else [*texts[:_LIMIT], f"and {count - _LIMIT} more"]))


def _allowed(finding: Any, source: str, vocabulary: Vocabulary) -> Sequence[str]:
    """Return the names of fields, kinds or values of which one is needed."""
    what = finding["type"]
    if what == "extra_forbidden":
        return sorted(_fields(finding["loc"][:-1], source, vocabulary))
    if what in (*_TAGS, *_TABLES):
        return [kind for kind in _kinds(finding["loc"], source, vocabulary) if kind]
    return _choices(finding) if what == "literal_error" else ()


def _choices(finding: Any) -> list[str]:
    """Return the texts of which a field accepts one."""
    expected = str((finding.get("ctx") or {}).get("expected", "")).replace(" or ", ", ").split(", ")
    return [word.strip("'") for word in expected]


def _raised(finding: Any) -> Any:
    return (finding.get("ctx") or {}).get("error")


def _misspelt_fields_first(findings: Sequence[Any], source: str, vocabulary: Vocabulary) -> list[Any]:
    """Replace the error of a whole part by the unknown fields in it, which are the likelier cause."""
    result: list[Any] = []
    for finding in findings:
        values = finding["input"]
        whole = isinstance(_raised(finding), Hint) and not _raised(finding).place and isinstance(values, dict)
        known = _fields(finding["loc"], source, vocabulary) if whole else set()
        wrong = [name for name in values if name not in known] if known else []
        result += [
            {"type": "extra_forbidden", "loc": (*finding["loc"], name), "input": values[name]} for name in wrong
        ] or [finding]
    return result


def _without_echoes(findings: Sequence[Any], vocabulary: Vocabulary) -> list[Any]:
    """Remove errors about missing fields that are present under a similar name."""
    extra = [finding["loc"] for finding in findings if finding["type"] == "extra_forbidden"][:_EXAMINED]
    return [
        finding
        for finding in findings
        if finding["type"] != "missing"
        or not any(loc[:-1] == finding["loc"][:-1] and _close(str(loc[-1]), [str(finding["loc"][-1])]) for loc in extra)
    ]


def _as_written(given: Any, location: Sequence[Any], sure: int) -> tuple[list[str], Any]:
    """Return the steps to the place in the names of the input, and its value.

    Names before index `sure` that the input lacks are tags of pydantic and are omitted.
    """
    words: list[str] = []
    node, tag = given, None
    for number, part in enumerate(location):
        if isinstance(part, int):
            if isinstance(node, (list, tuple)) and part < len(node):
                node, tag = node[part], None
                words[-1:] = [f"{words[-1] if words else ''}[{part}]"]
            continue  # The input has one item in place of a list.
        if part == _get(node, "kind") and part != tag:
            tag = part
            continue
        name = next((name for name in (part, _SPELLINGS.get(part, part)) if _has(node, name)), None)
        if name is not None:
            words.append(name)
            node, tag = _get(node, name), None
        elif number >= sure:
            words.append(str(part))
            node = _NOTHING
    return words, node if words else _NOTHING


def _has(node: object, name: object) -> bool:
    return name in node if isinstance(node, Mapping) else _get(node, name) is not None


def _get(node: object, name: object) -> Any:
    if isinstance(node, Mapping):
        return node.get(name)
    return getattr(node, name, None) if _is_table(node) and isinstance(name, str) else None


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping) or hasattr(type(value), "model_fields")


def _holds_tables(value: object) -> bool:
    return _is_table(value) or (isinstance(value, (list, tuple)) and any(map(_is_table, value)))


def _shown(value: object) -> str:
    try:
        text = repr(value)
    except ValueError:  # Python does not convert integers with more than 4300 digits.
        return "a number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:28]}...{text[-28:]}"


def _kinds(location: Sequence[Any], source: str, vocabulary: Vocabulary) -> Mapping[str, Mapping[str, str]]:
    """Return the kinds that a place accepts, with their fields; only that of the input, if it is known."""
    for number in range(len(location) - 1, -1, -1):
        if location[number] in vocabulary:
            kinds = vocabulary[location[number]]
            below = location[number + 1 :]
            return next(({part: kinds[part]} for part in below if part in kinds), kinds)
    return vocabulary.get(source, vocabulary.get("", {}))


def _fields(location: Sequence[object], source: str, vocabulary: Vocabulary) -> set[str]:
    return set().union(*_kinds(location, source, vocabulary).values())


def _absent(name: object, known: set[str], vocabulary: Vocabulary) -> tuple[str, str] | None:
    """Return that a property of particles, contacts or cavities does not exist, and what to do; None for other names."""
    holders = [set().union(*vocabulary.get(holder, {}).values()) for holder in _DAMPER_FIELDS]
    if not any(known <= fields for fields in holders):
        return None
    what, instead = ABSENT.get(_folded(name).removeprefix("wall_").removeprefix("particle_"), ("", ""))
    return (f"there is no such property: {what}", instead) if what else None


_DAMPER_FIELDS = (
    "damper",
    "dampers",
    "particles",
    "ball",
    "balls",
    "cavity",
    "contact",
    "friction",
    "rolling",
    "packing",
)
"""Fields that hold dampers and their parts."""
_PLAIN = {
    "missing": "this field is needed",
    "float_type": "a number is needed",
    "float_parsing": "a number is needed",
    "int_type": "an integer is needed",
    "int_parsing": "an integer is needed",
    "int_parsing_size": "an integer of usual size is needed",
    "int_from_float": "an integer is needed",
    "string_type": "text is needed",
    "bool_type": "true or false is needed",
    "bool_parsing": "true or false is needed",
    "list_type": "a list is needed",
    "tuple_type": "a list is needed",
    "finite_number": "a finite number is needed",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than_equal": "must be at most {le:g}",
    "less_than": "must be less than {lt:g}",
    "literal_error": "must be {expected}",
}
_TABLES = ("model_type", "model_attributes_type", "dict_type")
_TAGS = ("union_tag_not_found", "union_tag_invalid")


def _table_of(name: str, vocabulary: Vocabulary, kind: str | None = None) -> str:
    """Return an example of a table of this name; "" if it has no kinds."""
    kind = kind or next(iter(vocabulary.get(name, ())), "")
    return f'{_SPELLINGS.get(name, name)} = {{ kind = "{kind}", ... }}' if kind else ""


def _example_of(location: Sequence[Any], source: str, vocabulary: Vocabulary) -> str:
    """Return an example of a value of this name; "" if there is none."""
    parts = _kinds(location[:-1], source, vocabulary).values()
    example = next((part[location[-1]] for part in parts if part.get(location[-1])), "")
    return example and f"{location[-1]} = {example}"


def _plain_advice(finding: Any) -> str:
    """Return what to try for a value of a field that has no example."""
    context = finding.get("ctx") or {}
    limit = context.get("ge", context.get("le"))
    value = next((text for start, text in _VALUES.items() if finding["type"].startswith(start)), "")
    if finding["type"] == "literal_error":
        value = f'"{_choices(finding)[0]}"'
    elif limit is not None:
        value = f"{limit}"  # all digits of a large limit
    name = next((part for part in reversed(finding["loc"]) if isinstance(part, str)), "")
    if value:
        return f"{name} = {value}" if name else value
    if "gt" in context:
        return f"a number above {context['gt']:g}" if context["gt"] else "a positive number"
    return f"a number below {context['lt']:g}" if "lt" in context else "a value that the reference of case files lists"


_VALUES = {
    "float": "1.5",
    "finite": "1.5",
    "int": "1",
    "string": '"text"',
    "bool": "true",
    "list": "[...]",
    "tuple": "[...]",
}
"""Values of a field without an example, by the beginning of the type of the error."""


def _complaint_and_suggestion(
    finding: Any, value: Any, source: str, vocabulary: Vocabulary, place: str
) -> tuple[str, str]:
    """Return what is wrong with a value, and what to try."""
    # An error of our own validators has its words already.
    raised, what, context = _raised(finding), finding["type"], finding.get("ctx") or {}
    if isinstance(raised, RattleboxError):
        if raised.complaint in (NEGATIVE, NOT_POSITIVE) and str(value).startswith("-"):
            positive = str(value)[1:]
            return raised.complaint, f'"{positive}"' if isinstance(value, str) else positive
        return (raised.without_suggestion if raised.head else raised.complaint), raised.suggestion
    if isinstance(raised, ValueError):
        return str(raised), ""
    # An unknown field: one that never exists, or a misspelt one.
    location = finding["loc"]
    if what == "extra_forbidden":
        known = _fields(location[:-1], source, vocabulary)
        absent = _absent(location[-1], known, vocabulary)
        return absent or ("there is no such field here", nearest(str(location[-1]), known))
    # A part of a wrong class, or a table without a known kind.
    kinds = [kind for kind in _kinds(location, source, vocabulary) if kind]
    if what in (*_TAGS, *_TABLES) and _is_table(value) and not isinstance(value, Mapping):
        return f"{type(value).__name__} does not belong here", f"one of kind {' or '.join(kinds)}" if kinds else ""
    if what in (*_TAGS, *_TABLES) and callable(value) and "record" in kinds:
        return "a function cannot be stored in a case file", "rb.Record(times=t, values=f(t)) with many times t"
    if what in _TAGS:
        apart = f"wall_{location[-1]}" if location else ""
        if what == "union_tag_not_found" and "wall" in value and apart in _fields(location[:-1], source, vocabulary):
            return f"laws at walls have a separate field, {apart}", f"{location[-1]} = ... and {apart} = ..."
        if what == "union_tag_not_found":
            return f"'kind' is needed: {', '.join(kinds)}", f'kind = "{kinds[0]}"' if kinds else ""
        absent = _absent(value, _fields(location, source, vocabulary), vocabulary)
        return absent or ("there is no such kind here", nearest(str(value), kinds, listed=True))
    if what in _TABLES:
        kind = value if isinstance(value, str) and value in kinds else next(iter(kinds), None)
        name = place.rpartition(".")[2].partition("[")[0]
        if isinstance(value, (list, tuple)):
            return "one table is needed, not a list", f"[{name}] in single brackets"
        return "a table is needed", _table_of(name, vocabulary, kind) or f"{name} = {{ ... }}"
    # A missing value gets an example.
    if what == "missing":
        if isinstance(location[-1], int):
            return "one more is needed", "as many as the field has"
        return _PLAIN[what], _table_of(location[-1], vocabulary) or _example_of(location, source, vocabulary)
    # What is left are texts, lists and numbers out of range.
    if what == "literal_error" and isinstance(value, str):
        close = difflib.get_close_matches(value, _choices(finding), n=1)
        return _PLAIN[what].format(**context), f'"{close[0]}"' if close else ""
    if what in ("list_type", "tuple_type") and isinstance(value, (str, int, float)) and not isinstance(value, bool):
        return _PLAIN[what], "[" + (f'"{value}"' if isinstance(value, str) else f"{value!r}") + "]"
    if what == "greater_than":
        return f"must be greater than {format(context['gt'], 'g') if context['gt'] else 'zero'}", ""
    while len(location) > 1 and isinstance(location[-1], int):  # the example of a list
        location = location[:-1]
    has_example = what == "finite_number" or what.endswith(("_type", "_parsing"))
    advice = _example_of(location, source, vocabulary) if has_example else ""
    return _PLAIN[what].format(**context) if what in _PLAIN else finding["msg"], advice
