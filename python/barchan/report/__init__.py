"""The page of a run: gather.py reads its folder, plots.py and pictures.py draw, parts.py makes HTML of it, page.py joins the parts, command.py is the command."""

from .command import make  # noqa: F401
