"""What goes wrong, as exceptions: one class for each exit status of the program, and one for each thing that a reader of a run may miss."""

import difflib


class BarchanError(Exception):
    """Every error of this package. `status`: the exit status of the program, None where the program did not run."""
    status = None

    def __init__(self, message, **about):
        super().__init__(message)
        self.message = message
        self.__dict__.update(about)

    def __str__(self):
        return self.message


class SceneError(BarchanError, ValueError):
    """Status 2: the command or the scene is wrong. The message is the program's: file, line, column, key, what was expected."""
    status = 2


class UsageError(BarchanError, ValueError):
    """A call that is wrong, or that comes at the wrong time: the message says what was expected."""


class Breakdown(BarchanError, RuntimeError):
    """Status 3: the run broke down. `series`: the good frames (barchan.Series), None if there are none."""
    status = 3
    series = None


class OutputError(BarchanError, OSError):
    """Status 4: input/output failed, or there was not enough memory or no thread."""
    status = 4


class Mistake(BarchanError, RuntimeError):
    """Status 5: a mistake in Barchan itself; or a status that the program does not have, or a crash (negative: the signal)."""
    status = 5


class Stopped(BarchanError):
    """Status 128 + n: signal n stopped the run. `series`: its frames; `barchan.run(..., restart="latest")` goes on."""
    series = None


class ProgramNotFound(BarchanError, FileNotFoundError):
    """There is no program `barchan` in any of the places where it is looked for."""


class NoSeries(BarchanError, FileNotFoundError):
    """There is no series at this place."""


class Unreadable(BarchanError, ValueError):
    """A file of a run that is damaged: a frame without particles, a list of frames that is no XML, a table that is none."""


class UnknownName(BarchanError, KeyError):
    """A field, phase, column or table that is not there; the message has those that are, and the nearest."""

    @classmethod
    def of(cls, what, name, names, where):
        """`what`: "field", ...; `names`: those that are there; `where`: of what."""
        names = list(map(str, names))
        return cls(f'{where}: no {what} "{name}"{nearest(name, names)}; it has {", ".join(names) or "none"}')


class PackageMissing(BarchanError, ImportError):
    """A Python package that this function needs is not installed; the message names it."""


def nearest(name, names):
    """"; did you mean ...?" for the most similar of `names`, or an empty text."""
    close = difflib.get_close_matches(str(name).lower(), {n.lower(): n for n in names}, 1, .55)
    original = {n.lower(): n for n in names}
    return f'; did you mean "{original[close[0]]}"?' if close else ""


def error_of(status, said):
    """The exception for an exit status other than 0 of the program, with what it `said` on its standard error."""
    message = "\n".join(line.removeprefix("barchan: ") for line in said.strip().splitlines() if not line.startswith("barchan: warning:"))
    known = {2: SceneError, 3: Breakdown, 4: OutputError}
    if status in known:
        return known[status](message or f"barchan ended with status {status}")
    if status > 128:
        stopped = Stopped(message or f"stopped by signal {status - 128}", signal=status - 128)
        stopped.status = status
        return stopped
    mistake = Mistake(message or f"barchan ended with status {status}" + (f": signal {-status}" if status < 0 else ""))
    mistake.status = status
    return mistake


def package(name, debian, what):
    """Imports a package, or throws PackageMissing that says which Debian package has it."""
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise PackageMissing(f"{what} needs the Python package {name}, which is not installed ({error}): "
                             f"apt install {debian}, or pip install {name}") from error
