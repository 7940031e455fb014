"""Scenes as dictionaries: a scene file is TOML, which Python reads (tomllib) and this file writes."""

import datetime
import math
import pathlib
import re
import tomllib

SECTIONS_OF_SECTIONS = ("phases",)  # their tables get headings of their own, [phases.air]; all other tables within a section stand in a line


def load(path):
    """A scene file as a dictionary."""
    return loads(pathlib.Path(path).read_text())


def loads(text):
    """A scene as a dictionary. Throws tomllib.TOMLDecodeError."""
    return tomllib.loads(text)


def dump(scene, path):
    """Writes a dictionary as a scene file."""
    pathlib.Path(path).write_text(dumps(scene))


def dumps(scene):
    """A dictionary as the text of a scene file: `loads(dumps(scene)) == scene`, the keys in their order as far as TOML allows (keys of the top of the file stand before
    its sections). Numbers, texts, booleans, dates, paths, lists, tuples, dictionaries and NumPy's scalars and arrays; throws TypeError, with the key, for another type."""
    plain = {key: as_plain(value, str(key)) for key, value in scene.items()}
    lines = [f"{key_text(key)} = {value_text(value)}" for key, value in plain.items() if not is_section(value)]
    for key, value in plain.items():
        if isinstance(value, dict):
            lines += section([key], value)
        elif is_section(value):
            for each in value:
                lines += ["", f"[[{key_text(key)}]]", *(f"{key_text(k)} = {value_text(v)}" for k, v in each.items())]
    return "\n".join(lines).lstrip("\n") + "\n"


def section(path, table):
    """The lines of [path]."""
    nested = path[-1] in SECTIONS_OF_SECTIONS and len(path) == 1
    own = [f"{key_text(k)} = {value_text(v)}" for k, v in table.items() if not (nested and isinstance(v, dict))]
    below = [line for k, v in table.items() if nested and isinstance(v, dict) for line in section([*path, k], v)]
    return ["", f"[{'.'.join(map(key_text, path))}]", *own] * bool(own or not below) + below


def is_section(value):
    """Whether a value of the top of the file gets a heading: a dictionary, or a list of nothing but dictionaries."""
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value))


def as_plain(value, where):
    """The value with lists, dictionaries, texts and numbers of Python alone."""
    if hasattr(value, "tolist") and hasattr(value, "dtype"):  # an array or a scalar of NumPy
        value = value.tolist()
    if isinstance(value, dict):
        return {key: as_plain(v, f"{where}.{key}") for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_plain(v, f"{where}.{k}") for k, v in enumerate(value)]
    if isinstance(value, pathlib.PurePath):
        return str(value)
    if isinstance(value, (bool, int, float, str, datetime.date, datetime.time)):
        return value
    raise TypeError(f"{where}: TOML has no {type(value).__name__} ({value!r:.40})")


def key_text(key):
    """A key as TOML writes it."""
    if not isinstance(key, str):
        raise TypeError(f"a key of a scene is a text, not {key!r}")
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else string_text(key)


def value_text(value):
    """A value on one line of TOML."""
    value = as_plain(value, "value")
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, int):
        if not -2**63 <= value < 2**63:
            raise TypeError(f"TOML has no integer as large as {value}")
        return str(value)
    if isinstance(value, str):
        return string_text(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key_text(k)} = {value_text(v)}" for k, v in value.items()) + " }" if value else "{}"
    return value.isoformat()


def string_text(text):
    """A text in quotation marks, with what TOML cannot hold escaped."""
    short = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r", "\b": "\\b", "\f": "\\f"}
    escaped = (short.get(c) or (f"\\u{ord(c):04x}" if ord(c) < 0x20 or ord(c) == 0x7f else c) for c in text)
    return '"' + "".join(escaped) + '"'
