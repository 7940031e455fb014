#!/usr/bin/python3
"""On paper: 1e8 and 1e10 particles in three dimensions on 1 to 4096 ranks, from constants that `barchan plan --ranks` measures here.

    /usr/bin/python3 bench/ranks/paper_study.py PROGRAM [--write]

Air in a periodic cube (consistent scheme, radius 2.1 spacings) of 1e6 particles is planned on 1 to 128 ranks. That gives the time and the memory of a
particle, the width h of the halo, the side s of the columns of 16 by 16 cells in which the walk goes, and what a step sends for a ghost. The rest is geometry,
with L = n^(1/3) spacings along an edge. A piece of the walk (today) is, on N ranks, a slab L/N thick, then several columns of one row of them, then a part of
a column; a block (what comes next) is a cube of n/N particles. Ghosts stand within h of it. Those beyond the periodic sides that a piece reaches itself are
images of its own particles and cost no message.

The page says which constants are assumed. With --write the results go to bench/ranks/results/paper_study.csv, the page and docs/gallery/ranks_on_paper.png.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store, table  # noqa: E402
from speed import air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/paper_study.csv"
PAGE, PICTURE = ROOT / "docs/ranks.md", ROOT / "docs/gallery/ranks_on_paper.png"
RANKS = [1, 4, 16, 64, 256, 1024, 4096]
SIZES = [1e8, 1e10]
PLANNED = (1, 2, 8, 16, 32, 64, 128)
GHOST = 200                  # bytes of a ghost: position, image, records where they are and on their way
ACROSS = 100                 # particles along an edge of the cube that is planned
DISK, FRAME = 2e9, 60.       # bytes/s, assumed; bytes of a particle in a frame: position, velocity, density, pressure, phase
NEIGHBOURS = {"pieces": 2, "blocks": 26}


def planned(program, ranks, folder):
    scene = run.scene_file(air(3, ACROSS, .012), folder)
    return json.loads(run.command([program, "plan", scene, "--json", "--threads", "1", "--ranks", ranks], check=True).stdout)


def shape(n, ranks, way, side):
    """Edges (spacings) of what a rank has."""
    edge = n ** (1 / 3)
    if way == "blocks":
        return [(n / ranks) ** (1 / 3)] * 3
    thick = max(edge / ranks, min(side, edge))
    wide = max(n / ranks / thick / edge, min(side, edge))
    return [thick, wide, n / ranks / thick / wide]


def ghosts(n, ranks, way, side, h):
    """Ghosts of a rank, and those of them that are of other ranks."""
    edges = shape(n, ranks, way, side)
    all_of_them = math.prod(e + 2 * h for e in edges) - n / ranks
    own = math.prod(e + 2 * h if e > .999 * n ** (1 / 3) else e for e in edges) - n / ranks
    return all_of_them, all_of_them - own


def halved(low, high, too_small):
    """Where `too_small` changes from true to false."""
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if too_small(middle) else (low, middle)
    return low


def cells_of(n, side):
    """Bytes of begin, end, walk, block and owner of each cell of the domain."""
    return n / (side / 16) ** 3 * 20


def constants(program):
    with tempfile.TemporaryDirectory() as folder:
        plans = {n: planned(program, n, pathlib.Path(folder)) for n in PLANNED}
    n, memory, alone, of = ACROSS**3, plans[1]["memory"]["parts"], plans[1]["ranks"], {r: p["ranks"]["mean"] for r, p in plans.items()}
    h = halved(0., 20., lambda h: ghosts(n, 2, "pieces", 0., h)[0] < of[2]["ghosts"])
    side = min((s / 10 for s in range(100, 500)), key=lambda s: sum(math.log(ghosts(n, r, "pieces", s, h)[0] / of[r]["ghosts"]) ** 2 for r in PLANNED if r > 2))
    return {"particles": n, "seconds": alone["seconds_alone"] / n, "memory": (memory["arrays"] + memory["states to go back to"]) / n,
            "program": memory["program"], "start": (plans[8]["ranks"]["start_memory"] - memory["program"] - cells_of(n, side)) / (n / 8), "h": h, "side": side,
            "bytes": of[2]["bytes"] / ghosts(n, 2, "pieces", side, h)[1], "messages": of[2]["messages"] / NEIGHBOURS["pieces"],
            "plan": alone["constants"],
            "planned": {str(r): {"ghosts": p["ghosts"], "efficiency": plans[r]["ranks"]["efficiency"], "messages": p["messages"]} for r, p in of.items()}}


def on(n, ranks, way, c):
    """Of a rank: ghosts over particles, bytes a step, memory (bytes) during the run and at the start, efficiency."""
    p, own = c["plan"], n / ranks
    halo, remote = ghosts(n, ranks, way, c["side"], c["h"]) if ranks > 1 else (ghosts(n, 1, way, c["side"], c["h"])[0], 0)
    sent, messages = remote * c["bytes"], 0 if ranks == 1 else c["messages"] * NEIGHBOURS["pieces" if way == "pieces" and ranks < 4 else "blocks"]
    rounds = math.ceil(math.log2(ranks))
    alone = c["seconds"] * own
    seconds = alone + messages * p["latency"] + sent / p["bandwidth"] + rounds * p["reductions"] * p["latency"]
    cells = cells_of(n, c["side"])
    return {"particles": own, "share": halo / own, "bytes": sent, "efficiency": alone / seconds, "memory": c["program"] + c["memory"] * own + GHOST * halo + cells,
            "cells": cells, "start": c["program"] + c["start"] * own + cells, "frame": n * FRAME * (1 / p["bandwidth"] + 1 / DISK)}


def text(results, c):
    def giga(x):
        return f"{x / 1e9:.3g}"
    lines = [f"Constants, measured with {c['particles']:.0e} particles: {c['seconds'] * 1e9:.0f} ns a particle and step, {c['memory']:.0f} bytes a particle, "
             f"{c['start']:.0f} bytes a particle that a rank makes at the start, a halo of {c['h']:.2f} spacings, columns of {c['side']:.0f} spacings, {c['bytes']:.0f} bytes a ghost and step, "
             f"{c['messages']:.1f} messages a neighbour and step. Assumed: {FRAME:.0f} bytes a particle in a frame, a disk of {DISK / 1e9:.0f} GB/s, "
             "and between machines the latency and bandwidth that were measured within one.", "",
             table.head("particles, ranks", "a rank", "ghosts over particles: pieces; blocks", "MB a step a rank", "efficiency",
                        "GB a rank: run", "start", "s a frame")]
    for n in SIZES:
        for ranks in RANKS:
            a, b = (results[f"{n:.0e} {ranks} {way}"] for way in ("pieces", "blocks"))
            lines.append(table.row(f"{n:.0e}, {ranks}", f"{a['particles']:.2g}", f"{a['share']:.2f}; {b['share']:.2f}", f"{a['bytes'] / 1e6:.1f}; {b['bytes'] / 1e6:.1f}",
                                   f"{a['efficiency']:.2f}; {b['efficiency']:.2f}",
                                   f"{giga(a['memory'])}; {giga(b['memory'])}", giga(a["start"]), f"{a['frame']:.0f}"))
    return "\n".join(lines)


def draw(results, c):
    plot = pages.pyplot()
    figure, (strong, weak) = plot.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
    for n, style in zip(SIZES, ("-", "--")):
        for way, colour in (("pieces", pages.VERMILION), ("blocks", pages.BLUE)):
            strong.plot(RANKS, [results[f"{n:.0e} {r} {way}"]["efficiency"] for r in RANKS], style, color=colour, marker="o", ms=3,
                        label=f"{n:.0e} particles, {way}")
    for way, colour in (("pieces", pages.VERMILION), ("blocks", pages.BLUE)):
        for own, style in ((1e5, ":"), (1e6, "-")):
            weak.plot(RANKS, [on(own * r, r, way, c)["efficiency"] for r in RANKS], style, color=colour, marker="o", ms=3, label=f"{own:.0e} a rank, {way}")
    for axes, name in ((strong, "strong scaling"), (weak, "weak scaling")):
        axes.set(xscale="log", xlabel="ranks", ylabel="efficiency", ylim=(0, 1.05), title=name)
        axes.legend(fontsize=7, frameon=False)
    figure.savefig(PICTURE, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    c = constants(options.program.resolve())
    for ranks in PLANNED[1:]:
        told = c["planned"][str(ranks)]
        print(f"{ranks} ranks: ghosts a rank by geometry over those of plan --ranks {ghosts(c['particles'], ranks, 'pieces', c['side'], c['h'])[0] / told['ghosts']:.3f}, "
              f"efficiency {on(c['particles'], ranks, 'pieces', c)['efficiency']:.3f} and {told['efficiency']:.3f}, messages {told['messages']:.0f}")
    results = {f"{n:.0e} {ranks} {way}": on(n, ranks, way, c) for n in SIZES for ranks in RANKS for way in NEIGHBOURS}
    print(text(results, c))
    if options.write:
        store.keep(RESULTS, {"constants": c, "results": results})
        pages.fill(PAGE, "on paper", text(results, c))
        draw(results, c)


if __name__ == "__main__":
    main()
