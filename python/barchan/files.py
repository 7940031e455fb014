"""Files of a run, which may be another person's: a file that a list names lies below the folder of the list, only regular files are opened, and none that memory cannot hold."""

import json
import os
import pathlib
import stat
import xml.etree.ElementTree as ElementTree

from .errors import Unreadable

MOST_OF_A_TABLE = 1 << 30     # bytes, of a .csv
MOST_OF_A_DOCUMENT = 1 << 28  # bytes, of a .json or a list of files


def named(where, name):
    """The file that a list (the file `where`) names: a relative path below the folder of the list. Throws Unreadable."""
    path = pathlib.PurePath(name or "")
    if not path.parts or path.is_absolute() or ".." in path.parts:
        raise Unreadable(f"{where}: it names {str(name)[:200]!r}; expected a file below the folder of the list")
    return pathlib.Path(where).parent / path


def below(folder, file):
    """The file itself, which is in this folder or below it when its links are followed. Throws Unreadable."""
    try:
        inside = pathlib.Path(file).resolve().is_relative_to(pathlib.Path(folder).resolve())
    except (OSError, RuntimeError, ValueError) as error:  # RuntimeError: links in a circle
        raise Unreadable(f"{file}: {error}") from error
    if not inside:
        raise Unreadable(f"{file}: is a link to a file outside of {folder}; expected a file of the run")
    return pathlib.Path(file)


def is_file(path):
    """Whether there is a file of this name, which may be no name that a file can have."""
    try:
        return pathlib.Path(path).is_file()
    except (OSError, ValueError):  # too long; a zero in it
        return False


def opened(path):
    """A regular file that is open to be read as bytes: no pipe, on which one waits for ever, no device and no folder. Throws Unreadable."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:  # ValueError: a zero in the name
        raise Unreadable(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise Unreadable(f"{path}: is not a file")
    return os.fdopen(descriptor, "rb")


def content(path, most):
    """The bytes of a file of at most so many. Throws Unreadable."""
    with opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > min(most, memory()):
            raise Unreadable(f"{path}: {size} bytes are too many; expected at most {min(most, memory())}")
        try:
            return file.read(size)
        except (OSError, MemoryError) as error:
            raise Unreadable(f"{path}: {error or 'there is not enough memory'}") from error


def text(path, most=MOST_OF_A_DOCUMENT):
    """The text of a file. Throws Unreadable."""
    try:
        return content(path, most).decode().replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise Unreadable(f"{path}: {error}") from error


def document(path):
    """What a .json file says. Throws Unreadable."""
    try:
        return json.loads(text(path))
    except (ValueError, RecursionError) as error:
        raise Unreadable(f"{path}: {error}") from error


def xml(path, words=None):
    """The root of an XML document; `words`: its text, if it was read before. Throws Unreadable. It declares no entities: a short text could make endless ones of them."""
    words = text(path) if words is None else words
    if "<!DOCTYPE" in words or "<!ENTITY" in words:
        raise Unreadable(f"{path}: it declares a document type; expected plain XML")
    try:
        return ElementTree.fromstring(words)
    except (ElementTree.ParseError, ValueError, LookupError, RecursionError, MemoryError) as error:
        raise Unreadable(f"{path}: {error}") from error


def write_whole(path, words):
    """Writes a text whole or not at all. A link at the place of the file or of its temporary one is not followed: it may lead anywhere. What is no UTF-8 becomes "?"."""
    path = pathlib.Path(path)
    part = path.with_name(path.name + ".part")
    part.unlink(missing_ok=True)
    with open(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666), "w", encoding="utf-8", errors="replace", newline="\n") as file:
        file.write(words)
    os.replace(part, path)


def memory():
    """Bytes that the machine can still give."""
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            return next(1024 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, ValueError, StopIteration):
        return 1 << 62
