"""The part of pvstate/render that runs inside pvpython: render_frames.py OUT FRAMES STATE...

Runs each state, then shows it each frame (numbers by comma) and writes OUT/STATE_NUMBER.png.
"""
import os
import runpy
import sys
import traceback

import paraview

paraview.options.batch = True
import paraview.simple as pv  # noqa: E402


def main():
    out, frames, states = sys.argv[1], [int(k) for k in sys.argv[2].split(",")], sys.argv[3:]
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
        name = os.path.splitext(os.path.basename(state))[0]
        for frame in frames:
            view.ViewTime = times[frame]
            file = os.path.join(out, f"{name}_{frame:06d}.png")
            pv.SaveScreenshot(file, view, ImageResolution=list(view.ViewSize), CompressionLevel="2")
            print(f"picture {file}", flush=True)


try:
    main()
except Exception as error:  # the whole story to the log, the point of it last
    traceback.print_exc()
    print(f"render: {error}", file=sys.stderr, flush=True)
    sys.stderr.flush()
    os._exit(1)
