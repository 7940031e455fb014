#!/usr/bin/python3
"""A picture of every scene: runs the scenes of docs/gallery/scenes.json, each shortened as its "settings" say, and renders docs/gallery/scenes/NAME.png.

    /usr/bin/python3 bench/gallery.py build/barchan                      all; about half an hour of one core
    /usr/bin/python3 bench/gallery.py build/barchan --only dune,rings    some
    /usr/bin/python3 bench/gallery.py build/barchan --rendered           no runs: from those in out/gallery

The list has for each scene: "scene" (its file), "picture", "state" (in pvstate/, one of those that the scene names), "settings" (KEY=VALUE, as after --set),
"frame" (its number, or "last"), "size", "window" if a part is shown, "seen" (one line of what is seen), and what this program writes: "time" (s, of the frame).
Runs are kept in out/gallery and are not done again while their settings are the same. A run has BUDGET seconds; one that takes longer is named and left out.
"""

import argparse
import json
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from barchan_bench import ROOT, frame, run  # noqa: E402

LIST, PICTURES = ROOT / "docs/gallery/scenes.json", ROOT / "docs/gallery"
BUDGET = 900          # s of wall time, a run
LARGEST = 80_000      # bytes, a picture
COLOURS = (128, 96, 64, 48, 32, 24, 16, 8)   # tried in this order until the picture is small enough


def name_of(entry):
    return pathlib.Path(entry["picture"]).stem


def series_of(entry, runs):
    return runs / name_of(entry) / f"{pathlib.Path(entry['scene']).stem}.pvd"


def is_done(entry, runs):
    """Whether a whole run with these settings is there."""
    report = runs / name_of(entry) / "run.json"
    if not report.is_file():
        return False
    said = json.loads(report.read_text())
    return said["end_reason"] == "end" and [s.replace(" ", "") for s in said["scene"]["set"]] == [s.replace(" ", "") for s in entry["settings"]]


def run_scene(program, entry, runs):
    """Runs a scene unless it is there; returns the seconds of the processor, None when it failed."""
    out = runs / name_of(entry)
    try:
        ended = run.scene(program, ROOT / entry["scene"], out, entry["settings"], before=["nice", "-n", "15"], timeout=BUDGET, check=False)
    except OSError as error:
        print(f"gallery: {entry['scene']}: {error}", flush=True)
        return None
    if ended.status != 0:
        why = f"took more than {BUDGET} s" if ended.status is None else f"ended with {ended.status}: {ended.stderr.strip()[-300:]}"
        print(f"gallery: {entry['scene']} {why}", flush=True)
        return None
    return ended.user


def small(file, target):
    """A copy of a picture with as many colours as LARGEST allows."""
    for colours in COLOURS:
        run.command(["ffmpeg", "-y", "-loglevel", "error", "-i", file, "-vf", f"split[a][b];[a]palettegen=max_colors={colours}:stats_mode=full[p];[b][p]paletteuse=dither=none",
                     "-frames:v", "1", "-pred", "mixed", target], check=True)
        if target.stat().st_size <= LARGEST:
            return
    print(f"gallery: {target} has {target.stat().st_size} bytes", flush=True)


def render(entries, runs):
    """Renders the pictures of all entries with one start of ParaView, and writes the time of each frame into its entry."""
    with tempfile.TemporaryDirectory() as scratch:
        scratch, jobs = pathlib.Path(scratch), []
        for entry in entries:
            series = series_of(entry, runs)
            times = [time for time, _ in frame.series(series)]
            entry["time"] = times[-1] if entry["frame"] == "last" else times[entry["frame"]]
            jobs.append({"series": str(series), "state": entry["state"], "frame": entry["frame"], "size": entry["size"], "window": entry.get("window", ""),
                         "file": str(scratch / f"{name_of(entry)}.png")})
        (scratch / "jobs.json").write_text(json.dumps(jobs))
        ended = run.command([ROOT / "pvstate/render", "--batch", scratch / "jobs.json"])
        if ended.status != 0:
            print(ended.stderr, flush=True)
        for entry in entries:
            if (scratch / f"{name_of(entry)}.png").is_file():
                small(scratch / f"{name_of(entry)}.png", PICTURES / entry["picture"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="PROGRAM")
    parser.add_argument("--only", default="", help="names of pictures, by comma")
    parser.add_argument("--rendered", action="store_true", help="no runs")
    parser.add_argument("--runs", type=pathlib.Path, default=ROOT / "out/gallery")
    given = parser.parse_args()
    entries = json.loads(LIST.read_text())
    wanted = set(filter(None, given.only.split(",")))
    if wanted - {name_of(e) for e in entries}:
        sys.exit(f"gallery: no picture {', '.join(sorted(wanted - {name_of(e) for e in entries}))} in {LIST}")
    chosen = [e for e in entries if not wanted or name_of(e) in wanted]
    (PICTURES / "scenes").mkdir(exist_ok=True)
    if not given.rendered:
        for entry in chosen:
            if not is_done(entry, given.runs):
                seconds = run_scene(given.program, entry, given.runs)
                print(f"{entry['scene']}: " + ("failed" if seconds is None else f"{seconds:.1f} s of the processor"), flush=True)
    render([e for e in chosen if is_done(e, given.runs)], given.runs)
    LIST.write_text(json.dumps(entries, indent=1) + "\n")
    missing = [e["picture"] for e in chosen if not is_done(e, given.runs)]
    if missing:
        sys.exit(f"gallery: no run for {', '.join(missing)}")


if __name__ == "__main__":
    main()
