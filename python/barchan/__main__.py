"""python3 -m barchan COMMAND ...: report and sweep are done here, all other commands by the program, with its exit status."""

import os
import sys

from .errors import BarchanError


def main(words):
    """The exit status of a command line."""
    try:
        if words[:1] == ["report"]:
            from .report.command import main as report
            return report(words[1:])
        if words[:1] == ["sweep"]:
            from .sweep.command import main as sweep
            return sweep(words[1:])
        from .program import find_program
        program = find_program()
        sys.stdout.flush()
        os.execv(program, [str(program), *words])
    except BarchanError as error:
        print(f"barchan: {error}", file=sys.stderr)
        return error.status or (4 if isinstance(error, ImportError) else 2)
    except ImportError as error:
        debian = {"numpy": "python3-numpy", "matplotlib": "python3-matplotlib"}.get(str(error.name).split(".")[0])
        print(f"barchan: {sys.executable} cannot load {error.name}: {error}" + (f"; apt install {debian}" if debian else ""), file=sys.stderr)
        return 4
    except (OSError, MemoryError) as error:
        print(f"barchan: {error or 'there is not enough memory'}", file=sys.stderr)
        return 4


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
