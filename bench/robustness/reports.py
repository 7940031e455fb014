#!/usr/bin/python3
"""A report of every scene: made, below 10 MB, opened in Chromium without a blank picture.

    /usr/bin/python3 bench/robustness/reports.py build/barchan --seconds 20 --out out/reports [SCENE ...] [--write]

Each scene runs for at most --seconds of wall time on one thread, then SIGINT stops it, so that most pages are those of stopped runs. OUT keeps runs, pages and screenshots (NAME.png), for somebody who looks
at them. With --write the results go to results/reports.csv. Exits with 1 when a page was not made, is too large, or is blank.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store, table  # noqa: E402

RESULTS = pathlib.Path(__file__).resolve().parent / "results/reports.csv"

MOST_MB, FEWEST_COLOURS = 10., 200
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"]


def colours(html, png):
    """Opens a page in Chromium; how many colours its picture has. None where there is no Chromium."""
    if not shutil.which("chromium"):
        return None
    with tempfile.TemporaryDirectory() as profile:
        run.command(["chromium", *FLAGS, f"--user-data-dir={profile}", f"--screenshot={png}", "--window-size=1400,5000", html.absolute().as_uri()], timeout=300)
    from PIL import Image
    return len(numpy.unique(numpy.asarray(Image.open(png).convert("RGB"), numpy.int32) @ [65536, 256, 1]))


def examine(program, scene, out, seconds):
    """The row of one scene."""
    name = str(scene.relative_to(ROOT / "scenes").with_suffix("")).replace("/", "-")
    folder = out / name
    for longest in (seconds, 30 * seconds):  # once more, longer, for a bed that has not settled before the first frame
        ran = run.scene(program, scene, folder, before=["timeout", "--preserve-status", "-s", "INT", str(longest)], check=False)
        if ran.report:
            break
    made = run.command([program, "report", folder], timeout=600)
    html = folder / "report.html"
    good = made.status == 0 and html.is_file()
    size = html.stat().st_size / 1e6 if good else 0.
    seen = colours(html, out / f"{name}.png") if good else 0
    return {"scene": name, "status": ran.status, "made": good, "MB": round(size, 3), "seconds": round(made.user, 1), "colours": seen,
            "good": good and size < MOST_MB and (seen is None or seen > FEWEST_COLOURS), "said": made.stderr.strip()[:200]}


def line(rows):
    good = sum(r["good"] for r in rows)
    return (f"Measured: {good} of {len(rows)} scenes have a page that is smaller than 10 MB and not blank in Chromium; the largest has {max(r['MB'] for r in rows):.1f} MB, the slowest took "
            f"{max(r['seconds'] for r in rows):.0f} s of processor time, half of them less than {sorted(r['seconds'] for r in rows)[len(rows) // 2]:.1f} s (`bench/robustness/reports.py`).")


def tables():
    """That of docs/report.md."""
    return {"reports": line(store.load(RESULTS))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("scenes", nargs="*", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=20.)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_intermixed_args()
    scenes = [scene.resolve() for scene in options.scenes] or sorted((ROOT / "scenes").rglob("*.toml"))
    rows = []
    print(table.head("scene", "status of the run", "MB", "user CPU s of the report", "colours of the picture", ""))
    for scene in scenes:
        rows.append(r := examine(options.program.resolve(), scene, options.out, options.seconds))
        print(table.row(r["scene"], r["status"], f"{r['MB']:.2f}", r["seconds"], r["colours"], table.missed(r["good"]), r["said"]), flush=True)
    good = sum(r["good"] for r in rows)
    print(line(rows))
    if options.write:
        store.keep(RESULTS, rows)
    return 0 if good == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
