#!/usr/bin/python3
"""Grains in a rotating drum (scenes/rotating_drum.toml) at three speeds, from rolling to cataracting: the angle of the surface, and that no grain is lost.

    /usr/bin/python3 bench/saltation/drum.py build/barchan --out /tmp/drum     runs what is not in --out, writes results/drum.csv and docs/gallery/drum.png
    /usr/bin/python3 bench/saltation/drum.py none --out /tmp/drum              measures runs that are there

The surface: grains of all frames of a block of time are counted in coordinates along the surface and across it, s and n; the surface is where their number falls to half of that
inside the bed. The dynamic angle is the slope of a line through it from s = -R/2 to R/2; it is a mean over the blocks, and its error is that of the mean. A second angle needs no
surface: the bed's centre of mass stands to the side of the axle, and its direction from the axle, over the vertical, is the angle of a flat surface. The torque on the drum must bear
the weight at that arm.
"""
import argparse
import json
import math
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402

SCENE, RESULT, PICTURE = ROOT / "scenes/rotating_drum.toml", ROOT / "bench/saltation/results/drum.csv", ROOT / "docs/gallery/drum.png"
RADIUS, CENTRE, DIAMETER, DENSITY, GRAVITY = 0.030, 0.035, 1e-3, 2650, 9.81  # m, m (both coordinates), m, kg/m3, m/s2
# Mellmann 2001 of Froude numbers: rolling 1e-4 to 1e-2, cascading 1e-3 to 1e-1, cataracting 1e-1 to 1. A speed is (regime, Froude number, turns, turns before the measurement).
SPEEDS = (("rolling", 0.00688, 3, 0.6), ("cascading", 0.05, 6, 1.5), ("cataracting", 0.3, 20.2, 4))
BLOCKS, FRAMES = 12, 40  # blocks of time of a mean; frames a turn


def speed(froude):
    return math.sqrt(froude * GRAVITY / RADIUS)


def settings(froude, turns):
    w = speed(froude)
    end = turns * 2 * math.pi / w + 0.05  # the drum turns with half of its speed in the first 0.1 s
    return [f'motion.0.angular-velocity="{w!r}*min(t/0.1, 1)"', f"time.end={end!r}", f"output.every={2 * math.pi / w / FRAMES!r}", "output.walls=false",
            f"time.largest-speed={max(0.5, 1.5 * w * RADIUS)!r}", 'output.fields=["radius"]']


def surface(s, n, frames):
    """Where the number of grains falls to half of that inside the bed, from below, in strips two diameters wide along the surface."""
    edges_s, edges_n = np.arange(-24, 25, 2) * DIAMETER, np.arange(-60, 61) * DIAMETER / 2
    count = np.histogram2d(s, n, (edges_s, edges_n))[0] / frames
    middle_s, middle_n = (edges_s[1:] + edges_s[:-1]) / 2, (edges_n[1:] + edges_n[:-1]) / 2
    count = (np.pad(count, ((0, 0), (1, 1)))[:, :-2] + count + np.pad(count, ((0, 0), (1, 1)))[:, 2:]) / 3  # rows of grains have gaps
    bed = (middle_n[None, :] < -0.2 * RADIUS) & (np.hypot(middle_s[:, None], middle_n[None, :]) < 0.8 * RADIUS)
    half = np.median(count[bed]) / 2
    place = []
    for column, x in zip(count, middle_s):
        inside = np.hypot(x, middle_n) < 0.93 * RADIUS
        full = np.flatnonzero((column >= half) & inside)
        if not len(full):
            place.append(math.nan)
            continue
        first = full[0]
        k = first + np.flatnonzero(column[first:] < half)[0]
        place.append(middle_n[k - 1] + (column[k - 1] - half) / (column[k - 1] - column[k]) * (middle_n[k] - middle_n[k - 1]))
    return middle_s, np.array(place)


def slope(s, n, low, high):
    """Angle of a line through the surface between two s, radians."""
    chosen = (s > low) & (s < high) & np.isfinite(n)
    return math.atan(np.polyfit(s[chosen], n[chosen], 1)[0])


def angles(places, guess):
    """Of the grains of some frames: the angle of the middle of the surface, of its upper and of its lower half, degrees, and the surface along it."""
    x = np.concatenate(places)
    angle = guess
    for _ in range(4):
        c, k = math.cos(angle), math.sin(angle)
        s, n = surface(x[:, 0] * c + x[:, 1] * k, x[:, 1] * c - x[:, 0] * k, len(places))
        turn = slope(s, n, -RADIUS / 2, RADIUS / 2)
        angle += turn
    halves = [angle - turn + slope(s, n, *part) for part in ((0, 0.8 * RADIUS), (-0.8 * RADIUS, 0))]
    return [math.degrees(a) for a in (angle, *halves)], (s, n, angle - turn)


def mean_and_error(values):
    return float(np.mean(values)), float(np.std(values, ddof=1) / math.sqrt(len(values)))


def measure(folder, regime, froude, turns, before):
    w, report = speed(froude), json.loads((folder / "run.json").read_text())
    history = table(folder / "history.csv")
    entries, start = series(folder / "rotating_drum.pvd"), before * 2 * math.pi / w
    first = Frame(entries[0][1], phase="sand")
    ids, lost, farthest = np.sort(first["id"]), 0, 0.0
    places, centres, flying = [], [], []
    for t, path in entries:
        f = Frame(path, phase="sand")
        x = f.x[:, :2] - CENTRE
        lost = max(lost, len(ids) - int(np.isin(ids, f["id"]).sum()))
        farthest = max(farthest, float((np.hypot(*x.T) + f["radius"]).max()))
        if t > start:
            places.append(x)
            centres.append(np.average(x, axis=0, weights=f["radius"] ** 3))
    centres = np.array(centres)
    by_mass = np.degrees(np.arctan2(centres[:, 0], -centres[:, 1]))
    blocks = np.array_split(np.arange(len(places)), BLOCKS)
    by_surface = [angles([places[k] for k in block], math.radians(by_mass[block].mean()))[0] for block in blocks]
    whole, curve = angles(places, math.radians(by_mass.mean()))
    s, n, angle = curve
    for x in places:  # in flight: more than two diameters over the mean surface
        along, over = x[:, 0] * math.cos(angle) + x[:, 1] * math.sin(angle), x[:, 1] * math.cos(angle) - x[:, 0] * math.sin(angle)
        flying.append((over - np.interp(along, s[np.isfinite(n)], n[np.isfinite(n)]) > 2 * DIAMETER).mean())
    later = history["time"] > start
    mass = DENSITY * math.pi / 6 * (2 * first["radius"]) ** 3
    torque = history["drum_torque_z"][later].mean()
    arm = centres[:, 0].mean() * mass.sum() * GRAVITY / DIAMETER  # by metre of depth: the slab is one mean diameter thick
    middle, upper, lower = (mean_and_error([a[k] for a in by_surface]) for k in range(3))
    deepest = float(history["deepest_contact"].max()) if "deepest_contact" in history else None
    result = {"regime": regime, "froude": froude, "speed_rad_s": w, "turns": float(w * (entries[-1][0] - 0.05) / (2 * math.pi)), "measured_turns": turns - before, "frames": len(places),
              "grains": len(ids), "lost": lost, "left_by_run": len(ids) - int(report["particles"]["sand"]), "farthest_over_radius": farthest / RADIUS,
              "angle": middle[0], "angle_error": middle[1], "upper_half": upper[0], "lower_half": lower[0], "by_centre_of_mass": mean_and_error([by_mass[b].mean() for b in blocks])[0],
              "by_centre_of_mass_error": mean_and_error([by_mass[b].mean() for b in blocks])[1], "least": float(by_mass.min()), "largest": float(by_mass.max()),
              "in_flight": float(np.mean(flying)), "torque_N": float(torque), "weight_at_its_arm_N": float(arm), "deepest_contact": deepest, "steps": report["steps"],
              "cpu_seconds": report.get("cpu_seconds")}
    return result, (first, entries[-1][1], curve)


def draw(found, pictures):
    plt = page.pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(12, 4.4))
    for at, r, (_, last, (s, n, angle)) in zip(axes, found, pictures):
        f = Frame(last, phase="sand")
        x, v = f.x[:, :2] - CENTRE, np.hypot(*f["velocity"][:, :2].T)
        at.set(aspect="equal", xlim=(-33, 33), ylim=(-33, 33), xticks=[], yticks=[], title=f"{r['regime']}, Froude number {r['froude']:.3g}\n{r['speed_rad_s']:.2f} rad/s: {r['angle']:.1f} +- {r['angle_error']:.1f} degrees")
        figure.canvas.draw()
        patches = [plt.Circle(1e3 * place, 1e3 * radius) for place, radius in zip(x, f["radius"])]
        import matplotlib.collections
        drawn = at.add_collection(matplotlib.collections.PatchCollection(patches, cmap="viridis", lw=0))
        drawn.set_array(v)
        drawn.set_clim(0, np.quantile(v, .99))
        at.add_patch(plt.Circle((0, 0), 1e3 * RADIUS, fill=False, color="0.3", lw=2))
        along, up = s * math.cos(angle) - n * math.sin(angle), s * math.sin(angle) + n * math.cos(angle)
        at.plot(1e3 * along, 1e3 * up, color="#D55E00", lw=2)
        figure.colorbar(drawn, ax=at, label="speed of grains, m/s", orientation="horizontal", shrink=.8, pad=.03)
    figure.tight_layout()
    figure.savefig(PICTURE, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("barchan")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/barchan_drum"))
    parser.add_argument("--only", help="a regime")
    options = parser.parse_args()
    found, pictures = [], []
    for regime, froude, turns, before in SPEEDS:
        if options.only and regime != options.only:
            continue
        folder = options.out / regime
        if options.barchan != "none" and not (folder / "run.json").exists():
            run.scene(options.barchan, SCENE, folder, settings(froude, turns))
        result, picture = measure(folder, regime, froude, turns, before)
        found.append(result)
        pictures.append(picture)
        for name, value in result.items():
            print(name, value if isinstance(value, str) or value is None else round(value, 5))
    good = all(r["lost"] == 0 and r["left_by_run"] == 0 and r["farthest_over_radius"] < 1 + 0.5 * DIAMETER / RADIUS for r in found)
    if not options.only:
        store.keep(RESULT, found)
        draw(found, pictures)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
