"""The part of pvstate/render that runs inside pvpython: render_frames.py FRAMES STATE... -- FILE...

Runs each state, then shows it each frame (numbers by comma) and writes the pictures: for each state one FILE a frame, in this order.
The exit status is 2 when the command is wrong (barchan_series.Wrong), 1 when anything else failed.
"""
import os
import runpy
import sys
import traceback

import paraview

paraview.options.batch = True
import paraview.simple as pv  # noqa: E402

from barchan_series import Wrong  # noqa: E402


def main():
    frames = [int(k) for k in sys.argv[1].split(",")]
    end = sys.argv.index("--")
    states, files = sys.argv[2:end], iter(sys.argv[end + 1:])
    for number, state in enumerate(states):
        if number:
            pv.Disconnect()   # the next state begins with nothing
            pv.Connect()
        pv._DisableFirstRenderCameraReset()
        runpy.run_path(state, run_name="__main__")
        view = pv.GetActiveView()
        if view is None:
            raise RuntimeError(f"{state} made no view")
        times = list(pv.GetTimeKeeper().TimestepValues) or [0.0]
        for frame in frames:
            file = next(files)
            view.ViewTime = times[frame]
            pv.SaveScreenshot(file, view, ImageResolution=list(view.ViewSize), CompressionLevel="2")
            print(f"picture {file}", flush=True)


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
