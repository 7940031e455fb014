"""The part of pvstate/render that runs inside pvpython: render_frames.py FRAMES STATE... -- FILE...    or render_frames.py --batch JOBS

Runs each state, then shows it each frame (numbers by comma) and writes the pictures: for each state one FILE a frame, in this order. JOBS is a .json list of
pictures of different series, each with "series", "state", "frame" (a number or "last"), "size" and "file": one start of ParaView for all of them.
The exit status is 2 when the command is wrong (barchan_series.Wrong), 1 when anything else failed.
"""
import json
import os
import runpy
import sys
import traceback

import paraview

paraview.options.batch = True
import paraview.simple as pv  # noqa: E402

from barchan_figure import Figure  # noqa: E402
from barchan_series import Wrong  # noqa: E402


def run_state(state, anew):
    """Runs a state, `anew`: in a session with nothing in it. Returns its view and the times of the series."""
    if anew:
        pv.Disconnect()
        pv.Connect()
    pv._DisableFirstRenderCameraReset()
    runpy.run_path(state, run_name="__main__")
    view = pv.GetActiveView()
    if view is None:
        raise RuntimeError(f"{state} made no view")
    return view, list(pv.GetTimeKeeper().TimestepValues) or [0.0]


def shoot(view, time, file):
    view.ViewTime = time
    pv.SaveScreenshot(file, view, ImageResolution=list(view.ViewSize), CompressionLevel="2")
    if os.environ.get("BARCHAN_PLAIN"):
        if Figure.last is None or Figure.last.view != view:
            raise Wrong("this state draws lines over axes; --format takes states that draw particles and fields (its numbers: barchan report)")
        with open(file[:-4] + ".json", "w", encoding="utf-8") as words:
            json.dump(Figure.last.words_at(time), words)
    print(f"picture {file}", flush=True)


def batch(jobs):
    """Pictures of different series; one that fails is named, and the others go on."""
    failed, kind = [], Wrong
    for number, job in enumerate(jobs):
        os.environ.update(BARCHAN_SERIES=job["series"], BARCHAN_SIZE=job["size"])
        os.environ.pop("BARCHAN_WINDOW", None)
        if job.get("window"):
            os.environ["BARCHAN_WINDOW"] = job["window"]
        try:
            view, times = run_state(job["state"], number > 0)
            shoot(view, times[-1] if job["frame"] == "last" else times[int(job["frame"])], job["file"])
        except Exception as error:
            if not isinstance(error, Wrong):
                traceback.print_exc()
                kind = RuntimeError
            failed.append(f"{job['file']}: {error}")
    if failed:
        raise kind("; ".join(failed))


def main():
    if sys.argv[1] == "--batch":
        with open(sys.argv[2], encoding="utf-8") as file:
            return batch(json.load(file))
    frames = [int(k) for k in sys.argv[1].split(",")]
    end = sys.argv.index("--")
    states, files = sys.argv[2:end], iter(sys.argv[end + 1:])
    for number, state in enumerate(states):
        view, times = run_state(state, number > 0)
        for frame in frames:
            shoot(view, times[frame], next(files))


def leave(error, status):
    """Ends at once: ParaView's own end can crash after an exception. The point of the story is its last line."""
    print(f"render: {error}", file=sys.stderr, flush=True)
    os._exit(status)


try:
    main()
except Wrong as error:
    leave(error, 2)
except Exception as error:
    traceback.print_exc()
    leave(error, 1)
