"""The cases of a sweep: every combination of the values of the keys that are varied, each with the name of its folder."""

import dataclasses
import hashlib
import itertools
import math
import re

from ..errors import SceneError

MOST_CASES = 100_000


@dataclasses.dataclass(frozen=True)
class Case:
    """One run: the values of the varied keys as texts by key, all settings KEY=VALUE of its command line, and the name of its folder."""
    values: dict
    settings: tuple
    folder: str
    options: tuple = ()


def varied(text):
    """(key, values as texts) of KEY=a:b:n (n values from a to b, both with it), KEY=a:b:n:log (equal ratios) or KEY=v1,v2,...; commas within brackets and quotation marks do not
    divide. Throws SceneError."""
    key, equals, said = text.partition("=")
    if not key or not equals or not said:
        raise SceneError(f"--vary {text}: expected KEY=FROM:TO:NUMBER or KEY=VALUE,VALUE,..., as in time.end=0.01:0.05:5")
    found = re.fullmatch(r"([^:,\"'\[\]{}]+):([^:,]+):([^:,]+)(?::([^:,]+))?", said)
    values = spaced(text, *found.groups()) if found else divided(said)
    if any(not value.strip() for value in values):
        raise SceneError(f"--vary {text}: a value is empty")
    if len(set(values)) < len(values):
        raise SceneError(f"--vary {text}: a value stands twice")
    return key, [value.strip() for value in values]


def spaced(text, first, last, number, way):
    """The texts of `number` values from first to last."""
    try:
        a, b, n = float(first), float(last), int(number)
        if not (math.isfinite(a) and math.isfinite(b)):
            raise ValueError
    except ValueError:
        raise SceneError(f"--vary {text}: expected FROM:TO:NUMBER with two numbers and a whole one, found {first}:{last}:{number}") from None
    if n < 1 or n > MOST_CASES or (n == 1 and a != b):
        raise SceneError(f"--vary {text}: expected 2 values or more (and at most {MOST_CASES}), found {n}")
    if way not in (None, "log"):
        raise SceneError(f'--vary {text}: after FROM:TO:NUMBER only "log" may stand, found "{way}"')
    if way and not (a * b > 0):
        raise SceneError(f"--vary {text}: equal ratios need two numbers of one sign that are not zero")
    share = [k / max(n - 1, 1) for k in range(n)]
    values = [a * (b / a) ** s for s in share] if way else [a + (b - a) * s for s in share]
    values[-1] = b
    whole = re.fullmatch(r"[+-]?\d+", first.strip()) and re.fullmatch(r"[+-]?\d+", last.strip()) and all(value.is_integer() for value in values)
    return [str(int(value)) if whole else format(value, ".12g") if float(format(value, ".12g")) != 0 or value == 0 else repr(value) for value in values]


def divided(text):
    """The parts of a text between its commas, where commas within brackets and quotation marks do not count."""
    parts, depth, quote, part = [], 0, "", ""
    for c in text:
        if quote:
            quote = "" if c == quote else quote
        elif c in "\"'":
            quote = c
        elif c in "[{":
            depth += 1
        elif c in "]}":
            depth -= 1
        if c == "," and not depth and not quote:
            parts.append(part)
            part = ""
        else:
            part += c
    return parts + [part]


def combinations(varies, settings=()):
    """The cases of all combinations, in order, the last key fastest. `varies`: texts as for `varied`; `settings`: KEY=VALUE for all. Throws SceneError."""
    keys = [varied(text) for text in varies]
    names = [key for key, _ in keys]
    for name in names:
        if names.count(name) > 1:
            raise SceneError(f"--vary {name}: the key stands twice")
    if math.prod(len(values) for _, values in keys) > MOST_CASES:
        raise SceneError(f"more than {MOST_CASES} combinations")
    cases, taken = [], set()
    for values in itertools.product(*(values for _, values in keys)):
        chosen = dict(zip(names, values))
        folder = folder_of(chosen)
        if folder in taken:  # two values that differ in characters that a name cannot have
            folder += "-" + hashlib.sha256(repr(chosen).encode()).hexdigest()[:8]
        taken.add(folder)
        cases.append(Case(chosen, (*settings, *(f"{key}={value}" for key, value in chosen.items())), folder))
    return cases


def folder_of(values):
    """A folder's name that tells the values: it does not depend on which other values are swept, so that a sweep can be made larger later."""
    name = ",".join(re.sub(r"[^\w.+-]", "_", key) + "=" + re.sub(r"[^\w.+-]", "_", value) for key, value in values.items())
    return name if len(name) <= 120 else name[:100] + "-" + hashlib.sha256(name.encode()).hexdigest()[:12]
