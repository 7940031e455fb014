"""barchan report DIR."""

import argparse
import pathlib
import sys

from .. import files
from ..errors import OutputError, SceneError


def parser():
    """Options of the command line."""
    p = argparse.ArgumentParser(prog="barchan report", description="One self-contained HTML page of a run: warnings, pictures, plots, the matrix, times. It opens from disk without a network.")
    p.add_argument("folder", metavar="DIR", help="folder of a run, as out/dune; the run may go on, or have broken down")
    p.add_argument("-o", "--output", metavar="FILE", help="the page (default DIR/report.html)")
    p.add_argument("--render", action="store_true", help="render pictures of the scene's states first (ParaView)")
    p.add_argument("--film", action="store_true", help="put films into the page; with --render make them")
    p.add_argument("--scene", metavar="FILE", help="the file of the scene (default: the one that run.json names, if it is the same as then or lies in DIR)")
    p.add_argument("--speed", type=float, metavar="U", help="with --length: coefficients of every force and Strouhal numbers, for a stream of this speed (m/s)")
    p.add_argument("--length", type=float, metavar="L", help="width of the body across the stream (m)")
    p.add_argument("--no-plan", action="store_true", help="do not ask barchan plan for the matrix")
    return p


def main(words):
    """Writes the page of a run; returns the exit status."""
    options = parser().parse_args(words)
    stream = (options.speed, options.length)
    if (stream[0] is None) != (stream[1] is None) or not all(s is None or 0 < s < float("inf") for s in stream):
        raise SceneError("--speed and --length: expected both, above 0 (m/s, m)")
    file = make(options.folder, options.output, options.render, options.film, not options.no_plan, options.scene, stream if stream[0] else None)
    print(f"report    {file}")
    return 0


def make(folder, output=None, render=False, film=False, plan=True, scene=None, stream=None):
    """Writes the page of the run in `folder` to `output` (default DIR/report.html) and returns its path; `scene`: the file of its scene; `stream`: speed (m/s) and length (m) of coefficients of force. Throws NoSeries, SceneError, OutputError, PackageMissing."""
    from . import gather, page, pictures
    g = gather.gather(folder, plan, scene)
    if render:
        try:
            pictures.render(g, film)
        except OutputError as error:
            g.remarks.append(error.message)
            print(f"barchan: warning: {error}", file=sys.stderr)
    file = pathlib.Path(output) if output else g.folder / "report.html"
    text = page.make(g, film, stream)
    try:
        files.write_whole(file, text)
    except (OSError, ValueError) as error:
        raise OutputError(f"cannot write {file}: {error}") from error
    return file
