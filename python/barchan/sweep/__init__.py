"""Many runs of one scene: cases.py makes the combinations, runner.py runs them, results.py gathers the table, page.py draws it, command.py is the command."""

from .cases import Case, combinations  # noqa: F401
from .results import read  # noqa: F401
from .runner import Ended, Runner  # noqa: F401
