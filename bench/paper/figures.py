#!/usr/bin/python3
"""The wind and sand of Halik et al. 2015, figures 3 and 10 to 14: runs the paper's two scenes, draws the figures, writes their numbers into docs/paper.md.

    /usr/bin/python3 bench/paper/figures.py build/barchan --write [--runs FOLDER]

Without --write it prints the numbers. With --runs the runs are kept in a folder, and those that are there are not done again. About four minutes; with
--only bed one: figures 3, 10 and 11 are made, the others stay as they are kept.
"""

import argparse
import pathlib
import sys
import tempfile

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "accuracy")]
import cases_wind  # noqa: E402
import harness  # noqa: E402
from barchan_bench import ROOT, page as pages, store  # noqa: E402

plt = pages.pyplot()
plt.rcParams["font.size"] = 13   # a figure is 11 inches wide: 12 pixels where it is shown with 800
GALLERY = ROOT / "docs/gallery"
MOVES = .01    # m/s: slower grains count as at rest
EARLY, LATE = 14e-3, 30e-3  # s, figure 10: the first grains leave; the end of the run
SAND = "#c8a165"
DUNE_TIMES = (2e-3, 20e-3, 40e-3, 70e-3)  # s, figure 14


def at(frames, time):
    return min(frames, key=lambda f: abs(f.time - time))


def save(figure, name):
    figure.savefig(GALLERY / f"paper_{name}.png", dpi=110, bbox_inches="tight")
    plt.close(figure)


def cubic(r, h):
    """The cubic B-spline in two dimensions, Monaghan & Lattanzio 1985; support 2 h."""
    q = r / h
    return 10 / (7 * numpy.pi * h**2) * numpy.where(q < 1, 1 - 1.5 * q**2 + .75 * q**3, numpy.where(q < 2, .25 * (2 - q)**3, 0))


def kernels():
    """Figure 3: the kernel and its slope for four smoothing lengths; the area under each is one."""
    r = numpy.linspace(0, 2, 2001)
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
    numbers = []
    for h, style in zip((1, .75, .5, .25), ("-", "--", "-.", ":")):
        w = cubic(r, h)
        slope = numpy.gradient(w, r)
        left.plot(r, w, "k" + style, label=f"h = {h}")
        right.plot(r, slope, "k" + style)
        numbers.append({"h": h, "top": float(w[0]), "steepest": float(slope.min()), "at": float(r[slope.argmin()] / h),
                        "area": float(numpy.trapezoid(2 * numpy.pi * r * w, r) if hasattr(numpy, "trapezoid") else numpy.trapz(2 * numpy.pi * r * w, r))})
    left.set(xlabel="r", ylabel="W", xlim=(0, 2))
    right.set(xlabel="r", ylabel="dW/dr", xlim=(0, 2))
    left.legend(frameon=False)
    save(figure, "kernels")
    return numbers


def speed(frame):
    return numpy.hypot(frame["velocity"][:, 0], frame["velocity"][:, 1])


def arrows(axes, frame, title, window):
    """Sand as its velocity vectors, 5 m/s a centimetre; grains at rest as dots."""
    x, v, s = 1e3 * frame.x, frame["velocity"], speed(frame)
    moving = s > MOVES
    axes.plot(x[~moving, 0], x[~moving, 1], ".", color="0.75", markersize=2)
    drawn = axes.quiver(x[moving, 0], x[moving, 1], v[moving, 0], v[moving, 1], s[moving], cmap="viridis", angles="xy", scale_units="xy", scale=1,
                        width=.0015, clim=(0, 2))
    axes.set(title=title, xlim=window[0], ylim=window[1], aspect="equal", ylabel="y, mm")
    return drawn


def groups(ways):
    """How many grains go each way: ways of which each is within half a grain (root mean square over the run) of another belong together."""
    left, sizes = list(range(len(ways))), []
    while left:
        group, left = [left[0]], left[1:]
        for member in group:   # grows while it is read
            near = [k for k in left if numpy.sqrt(((ways[k] - ways[member])**2).sum(axis=1).mean()) < 2.5e-4]
            group += near
            left = [k for k in left if k not in near]
        sizes.append(len(group))
    return sorted(sizes, reverse=True)


def flat_bed(frames):
    """Figures 10 and 11."""
    start = frames[0]
    top = start.x[:, 1].max()
    bed = numpy.quantile(start.x[:, 1], .9)
    figure, axes = plt.subplots(2, 1, figsize=(10, 5.4))
    numbers = []
    for axis, time in zip(axes, (EARLY, LATE)):
        f = at(frames, time)
        drawn = arrows(axis, f, f"sand at {1e3 * f.time:.1f} ms", ((0, 60), (0, 16)))
        s, v = speed(f), f["velocity"]
        moving = s > MOVES
        numbers.append({"ms": 1e3 * f.time, "moving": int(moving.sum()), "all": len(s), "up": int((moving & (v[:, 1] > MOVES)).sum()),
                        "down": int((moving & (v[:, 1] < -MOVES)).sum()), "flying": int((f.x[:, 1] > top + 5e-4).sum()),
                        "fastest": float(s.max()), "highest": float(1e3 * (f.x[:, 1].max() - top))})
    axes[1].set_xlabel("x, mm")
    figure.colorbar(drawn, ax=axes, label="speed, m/s (an arrow of 1 mm: 1 m/s)", shrink=.8)
    save(figure, "takeoff")

    ids = start["id"][start.x[:, 1] > bed]
    place = {int(k): n for n, k in enumerate(ids)}
    tracks = numpy.full((len(frames), len(ids), 4), numpy.nan)
    for n, f in enumerate(frames):
        for k, x, v in zip(f["id"], f.x, f["velocity"]):
            if int(k) in place:
                tracks[n, place[int(k)]] = x[0], x[1], v[0], v[1]
    rise = tracks[:, :, 1].max(axis=0) - tracks[0, :, 1]
    flown = numpy.argsort(-rise)[:12]
    t = 1e3 * numpy.array([f.time for f in frames])
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.6))
    colours = plt.cm.viridis(numpy.linspace(0, .9, len(flown)))
    ways = []
    for k, colour in zip(flown, colours):
        way = numpy.concatenate([[0], numpy.cumsum((numpy.diff(tracks[:, k, 0]) + .03) % .06 - .03)])
        ways.append(numpy.column_stack([way, tracks[:, k, 1] - tracks[0, k, 1]]))
        left.plot(1e3 * way, 1e3 * (tracks[:, k, 1] - tracks[0, k, 1]), color=colour, lw=1)
        right.plot(t, numpy.hypot(tracks[:, k, 2], tracks[:, k, 3]), color=colour, lw=1)
    left.set(xlabel="way along the wind, mm", ylabel="height over its place, mm")
    right.set(xlabel="t, ms", ylabel="speed, m/s")
    save(figure, "tracks")
    first = [float(t[numpy.argmax(tracks[:, k, 1] - tracks[0, k, 1] > 5e-4)]) for k in flown if rise[k] > 5e-4]
    flights = [(1e3 * f.time, f["velocity"][f.x[:, 1] > top + 5e-4, 1]) for f in frames]
    falling = [(time, len(v), int((v < 0).sum())) for time, v in flights if len(v)]
    return numbers, {"apart": groups(ways), "falling": [row for row in falling if any(abs(row[0] - time) < .05 for time in (14, 18, 22, 26, 30))],
                     "left": int((rise > 5e-4).sum()), "layer": len(ids), "first": min(first, default=float("nan")),
                     "last": max(first, default=float("nan")), "highest": float(1e3 * rise.max())}


def dune(frames, early, wind):
    """Figures 12 to 14."""
    figure, axis = plt.subplots(figsize=(11, 2.2))
    first = frames[0]
    for name, colour, size in (("air", "tab:blue", .6), ("sand", "tab:orange", 1.5), ("floor", "k", 1.5), ("lid", "k", 1.5)):
        part = cases_wind.only(first, name) if name in first.names else None
        if part is not None:
            axis.plot(1e3 * part.x[:, 0], 1e3 * part.x[:, 1], ".", color=colour, markersize=size, label=name)
    axis.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    axis.legend(loc="lower center", bbox_to_anchor=(.5, 1), markerscale=5, ncols=4, frameon=False)
    save(figure, "dune_start")

    crest, half = wind.dune["at"], wind.dune["length"] / 2
    ground = lambda x: wind.bed + numpy.where(abs(x - crest) < half, wind.dune["height"] / 2 * (1 + numpy.cos(numpy.pi * (x - crest) / half)), 0)
    figure, axes = plt.subplots(2, 1, figsize=(11, 4))
    airflow = []
    for axis, f in zip(axes, (early, frames[-1])):
        air = cases_wind.only(f, "air")
        drawn = axis.scatter(1e3 * air.x[:, 0], 1e3 * air.x[:, 1], c=air["velocity"][:, 0], s=1.2, cmap="viridis", vmin=0, vmax=26)
        sand = cases_wind.only(f, "sand")
        axis.scatter(1e3 * sand.x[:, 0], 1e3 * sand.x[:, 1], s=2.2, color=SAND, lw=0)
        along = numpy.linspace(0, .16, 321)
        axis.fill_between(1e3 * along, 1e3 * (ground(along) - 3e-4), color=SAND, lw=0)
        axis.set(title=f"air, speed along x at {1e3 * f.time:.1f} ms", ylabel="y, mm", aspect="equal", xlim=(0, 160))
        places = {"upstream": crest - half - .03, "windward": crest - half / 2, "crest": crest, "leeward": crest + half / 2, "behind": crest + half + .01,
                  "far": crest + half + .06}
        airflow.append({"ms": 1e3 * f.time, **{k: float(cases_wind.speed([air], wind, x, .006, 1e-3, ground)) for k, x in places.items()}})
    axes[1].set_xlabel("x, mm")
    figure.colorbar(drawn, ax=axes, label="m/s", shrink=.8)
    save(figure, "airflow")

    figure, axes = plt.subplots(len(DUNE_TIMES), 1, figsize=(11, 7))
    sand = []
    for axis, time in zip(axes, DUNE_TIMES):
        f = cases_wind.only(at(frames, time), "sand")
        s = speed(f)
        drawn = axis.scatter(1e3 * f.x[:, 0], 1e3 * f.x[:, 1], c=s, s=1.5 + 6 * (s > .2), cmap="viridis", vmin=0, vmax=2)
        axis.set(title=f"sand at {1e3 * f.time:.0f} ms", ylabel="y, mm", aspect="equal", xlim=(0, 160), ylim=(0, 20))
        over = f.x[:, 1] - ground(f.x[:, 0])
        flying, windward = over > 5e-4, (f.x[:, 0] > crest - half) & (f.x[:, 0] < crest)
        sand.append({"ms": 1e3 * f.time, "moving": int((s > MOVES).sum()), "flying": int(flying.sum()), "fastest": float(s.max()),
                     "windward": float(s[windward & (over > -7e-4)].mean()), "rest": float(s[~windward & (over > -7e-4)].mean())})
    axes[-1].set_xlabel("x, mm")
    figure.colorbar(drawn, ax=axes, label="m/s", shrink=.8)
    save(figure, "sand")
    return airflow, sand


def lines(r):
    """The tables of the page."""
    text = ["### Figure 3", "", "| h | W at 0 | steepest slope | at r/h | integral |", "| --- | --- | --- | --- | --- |"]
    text += [f"| {k['h']} | {k['top']:.3f} | {k['steepest']:.3f} | {k['at']:.2f} | {k['area']:.4f} |" for k in r["kernels"]]
    text += ["", "![The kernel and its slope](gallery/paper_kernels.png)", "", "### Figure 10", "",
             "| t, ms | grains that move | of them up, down | in flight | fastest, m/s | highest over the bed's top, mm |", "| --- " * 6 + "|"]
    text += [f"| {k['ms']:.1f} | {k['moving']} of {k['all']} | {k['up']}, {k['down']} | {k['flying']} | {k['fastest']:.2f} | {k['highest']:.2f} |" for k in r["takeoff"]]
    k = r["tracks"]
    text += ["", "![Velocity of the sand](gallery/paper_takeoff.png)", "", "### Figure 11", "",
             f"{k['left']} of the {k['layer']} grains of the highest tenth rise by more than a grain, the first after {k['first']:.1f} ms, the last of the twelve "
             f"drawn after {k['last']:.1f} ms, the highest by {k['highest']:.1f} mm. The scene has an equal bump of loose grains every 6 mm, so that many ways are nearly the same: the "
             f"twelve that rise highest go {len(k['apart'])} ways that differ by more than half a grain, of {', '.join(map(str, k['apart']))} grains.", "",
             "| t, ms | in flight | of them on the way down |", "| --- | --- | --- |",
             *(f"| {time:.1f} | {flying} | {down} |" for time, flying, down in k["falling"]), "",
             "![Ways and speeds of the twelve grains that rise highest](gallery/paper_tracks.png)", "", "### Figure 12", "",
             "![The start](gallery/paper_dune_start.png)", "", "### Figure 13", "", "Speed along x, m/s, 1 mm over the ground.", "",
             "| t, ms | 3 cm upstream | half way up | crest | half way down | 1 cm behind | 6 cm behind |", "| --- " * 7 + "|"]
    text += [f"| {k['ms']:.1f} | " + " | ".join(f"{k[p]:.2f}" for p in ("upstream", "windward", "crest", "leeward", "behind", "far")) + " |" for k in r["airflow"]]
    text += ["", "![The air](gallery/paper_airflow.png)", "", "### Figure 14", "",
             "| t, ms | grains that move | in flight | fastest, m/s | mean speed of the surface: windward side, elsewhere, m/s |", "| --- " * 5 + "|"]
    text += [f"| {k['ms']:.0f} | {k['moving']} | {k['flying']} | {k['fastest']:.2f} | {k['windward']:.4f}, {k['rest']:.4f} |" for k in r["sand"]]
    return "\n".join([*text, "", "![The sand](gallery/paper_sand.png)", ""])


def tables():
    """That of docs/paper.md."""
    return {"measured": lines(store.load(HERE / "results/figures.csv"))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="PROGRAM")
    parser.add_argument("--runs", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", choices=["bed"])
    given = parser.parse_args()
    harness.options.program = str(pathlib.Path(given.build).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        harness.options.runs = given.runs or scratch
        bed, _ = harness.run("paper/flat_bed", ["output.every=2e-4"], "sand")
        takeoff, tracks = flat_bed(bed)
        result = {**store.load(HERE / "results/figures.csv", {}), "kernels": kernels(), "takeoff": takeoff, "tracks": tracks}
        if given.only != "bed":
            early, _ = harness.run("paper/dune", ["time.end=2e-4", "output.every=2e-4"])
            frames, _ = harness.run("paper/dune", [])
            result["airflow"], result["sand"] = dune(frames, early[-1], cases_wind.Wind(harness.document("paper/dune")))
    print(lines(result))
    if given.write:
        store.keep(HERE / "results/figures.csv", result)


if __name__ == "__main__":
    main()
