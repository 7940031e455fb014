"""The scene of a run, from its folder. run.json may be another person's and name any file, so a file counts only if it lies in the folder of the run, or if it is a scene with the
checksum that run.json states: who wrote that has read the file before."""

import hashlib
import pathlib

from . import files
from .errors import Unreadable

MOST_OF_A_SCENE = 16 << 20  # bytes, as the program has it


def candidates(folder, said):
    """Existing files that the name `said` in run.json may mean: as it is, from the folders above the run's, and in its folder."""
    places = [pathlib.Path(said)] + [above / said for above in pathlib.Path(folder).absolute().parents] + [pathlib.Path(folder) / pathlib.PurePath(said).name]
    return [place for place in dict.fromkeys(places) if files.is_file(place)]


def belongs(folder, place, checksum):
    """Whether a file that run.json names lies in the folder of the run, or is a scene with this checksum."""
    try:
        files.below(folder, place)
        return True
    except Unreadable:
        pass
    try:
        return len(checksum) == 64 and place.suffix == ".toml" and hashlib.sha256(files.content(place, MOST_OF_A_SCENE)).hexdigest() == checksum
    except Unreadable:
        return False


def with_settings(scene, settings):
    """The document with the settings KEY=VALUE of the command line, as the program applies them; what does not fit is left out (the program has refused it)."""
    import tomllib
    for each in settings:
        key, _, text = each.partition("=")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text.strip()  # a word without quotation marks
        *path, last = key.strip().split(".")
        try:
            at = scene
            for part in path:
                at = at[int(part)] if isinstance(at, list) else at.setdefault(part, {})
            at[int(last) if isinstance(at, list) else last] = value
        except (LookupError, ValueError, TypeError, AttributeError):
            continue
    return scene


def unchanged(folder, run):
    """The scene of a run as a dictionary, with what --set changed; None unless its file is there and has the checksum that run.json (`run`, a dictionary) states."""
    try:
        import tomllib
        said = run["scene"]
        for place in candidates(folder, said["file"]):
            if belongs(folder, place, said["sha256"]):
                content = files.content(place, MOST_OF_A_SCENE)
                if hashlib.sha256(content).hexdigest() == said["sha256"]:
                    return with_settings(tomllib.loads(content.decode()), said.get("set", []))
    except (ImportError, LookupError, TypeError, ValueError, AttributeError, OSError, RecursionError, Unreadable):  # Python before 3.11; a damaged run.json
        pass
    return None
