#!/usr/bin/python3
"""Saltation against what is known: settling, hops, flux, profiles, thresholds, splash.

    bench/saltation/cases.py settling hop            run these (no name: all), write results/NAME.csv
    bench/saltation/cases.py --barchan build/barchan --out /tmp/saltation flux

docs/saltation.md shows them (bench/saltation/page.py); the case flux draws docs/saltation.png.
"""
import argparse
import json
import math
import pathlib
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, frame, run, statistics, store  # noqa: E402
import page  # noqa: E402

RESULTS = pathlib.Path(__file__).resolve().parent / "results"


class Bench:
    def __init__(self, program, out, threads):
        self.program, self.out, self.threads, self.overrides = program, pathlib.Path(out), threads, []

    def run(self, scene, name, *overrides):
        """Runs a scene of the repository; returns its folder."""
        run.scene(self.program, scene, self.out / name, [*overrides, *self.overrides], threads=self.threads, shown=True)
        return self.out / name

    def generate(self, scene, file, *overrides):
        """Writes the particles with which a scene of the repository begins."""
        self.out.mkdir(parents=True, exist_ok=True)
        run.generate(self.program, scene, file, overrides, shown=True, check=True)


def table(file):
    """Columns of a csv file by their names without units, as lists."""
    return {name.split(" [")[0]: values.tolist() for name, values in frame.table(file).items()}


def at(columns, time, name):
    """Value at a time that the table has."""
    k = min(range(len(columns["time"])), key=lambda i: abs(columns["time"][i] - time))
    assert abs(columns["time"][k] - time) < 1e-9 + 1e-6 * time, f"no row at {time} s"
    return columns[name][k]


# --- a grain in still air ---------------------------------------------------------------------------------------------

RHO, RHO_P, MU, G = 1.225, 2650.0, 1.81e-5, 9.81


def drag_coefficient(law, re):
    if law == "stokes":
        return 24 / re
    if law == "schiller-naumann":
        return 24 / re * (1 + 0.15 * re ** 0.687) if re < 1000 else 0.44
    if law == "cheng":
        return ((32 / re) ** (2 / 3) + 1) ** 1.5
    if law == "duran":
        return (math.sqrt(0.5) + math.sqrt(24 / re)) ** 2
    if law == "di-felice":
        return (0.63 + 4.8 / math.sqrt(re)) ** 2
    raise ValueError(law)


def terminal_speed(law, d):
    """Of m g = 1/8 C_D pi d^2 rho v^2, by bisection."""
    low, high = 1e-6, 1e3
    for _ in range(200):
        v = 0.5 * (low + high)
        drag = drag_coefficient(law, RHO * v * d / MU) * math.pi / 8 * d * d * RHO * v * v
        low, high = (v, high) if drag < RHO_P * math.pi / 6 * d ** 3 * G else (low, v)
    return v


# Fall from rest, d = 0.25 mm, Schiller & Naumann: time, speed, way (an integration with a fine step).
TRANSIENT = [(0.05, 0.456619, 0.011721), (0.1, 0.832036, 0.044293), (0.2, 1.344636, 0.155544), (0.5, 1.832938, 0.655712),
             (1.0, 1.896376, 1.596073)]
# Terminal speeds of Schiller & Naumann and of Cheng by diameter (mm), tabulated apart from terminal_speed().
TERMINAL = {0.1: 0.57694, 0.15: 1.02542, 0.2: 1.46987, 0.25: 1.89803, 0.5: 3.81355, 1.0: 7.02329}


def settling(bench):
    rows, fall = [], []
    for law in ("schiller-naumann", "cheng", "duran", "di-felice"):
        for d in (0.1, 0.15, 0.2, 0.25, 0.5, 1.0):
            v = terminal_speed(law, d * 1e-3)
            # thrown at 0.9 of that speed: what is left of the difference after 3 s is less than 1e-3 of it
            folder = bench.run("verification/settling", f"settling_{law}_{d}", f"spacing={d}e-3", f"interactions.air-sand.drag={law}",
                               "time.end=3", "time.step=2e-5", "fill.0.shape.points=[[0.005, 29.9]]", "domain.size=[0.01, 30]",
                               f"fill.0.velocity=[0, {-0.9 * v}]", "output.every=3", "output.history-every=0.5")
            measured = table(folder / "history.csv")["sand_largest_speed"][-1]
            rows.append({"law": law, "d": d, "measured": measured, "exact": v, "reference": TERMINAL[d] if law == "schiller-naumann" else None})
    folder = bench.run("verification/settling", "settling_transient")
    h = table(folder / "history.csv")
    for t, v, way in TRANSIENT:
        fall.append({"t": t, "measured": at(h, t, "sand_largest_speed"), "reference": v})
    return {"terminal": rows, "transient": fall}


# --- a hop in the logarithmic wind ------------------------------------------------------------------------------------

# u*, v0, angle: time, length, apex over the start, impact speed, impact angle.
HOPS = [(0.0, 1.0, 50, .14319, .07221, .02510, .7535, 58.75), (0.3, 1.0, 50, .13330, .31423, .02192, 3.4961, 9.63),
        (0.4, 0.5, 50, .07106, .12132, .00621, 2.7621, 6.74), (0.4, 1.0, 50, .13033, .41745, .02101, 4.7712, 6.85),
        (0.4, 1.5, 40, .15856, .62933, .03119, 5.5682, 7.02)]


def hop_of(bench, name, u, v, degrees, duration):
    """The last rows before the grain comes down: followed to its start's height along a parabola through three rows."""
    a = math.radians(degrees)
    every = 1e-3
    end = math.floor((duration - 2e-4) / every) * every
    folder = bench.run("verification/hop", name, f"phases.air.log-profile.friction-velocity={u}", f"time.end={end:.4f}",
                       f"fill.0.velocity=[{v * math.cos(a)}, {v * math.sin(a)}]", f"output.every={every}", f"output.history-every={every}")
    places = []
    for _, file in frame.series(folder / "hop.pvd"):
        grain = frame.Frame(file)
        places.append((*grain.x[0], *grain["velocity"][0]))
    start = places[0]
    times = [k * every for k in range(len(places))]
    apex = max(p[1] for p in places) - start[1]
    # between rows: the largest of the parabola
    k = max(range(1, len(places) - 1), key=lambda i: places[i][1])
    y0, y1, y2 = places[k - 1][1], places[k][1], places[k + 1][1]
    apex = y1 - (y2 - y0) ** 2 / (8 * (y0 - 2 * y1 + y2)) - start[1]
    # from the last row on with its velocity and acceleration
    p, q = places[-1], places[-2]
    ax, ay = (p[3] - q[3]) / every, (p[4] - q[4]) / every
    below = p[1] - start[1]
    t = (-p[4] - math.sqrt(p[4] ** 2 - 2 * ay * below)) / ay
    vx, vy = p[3] + ax * t, p[4] + ay * t
    length = p[0] - start[0] + p[3] * t + 0.5 * ax * t * t
    return {"time": times[-1] + t, "length": length, "apex": apex, "speed": math.hypot(vx, vy), "angle": math.degrees(math.atan2(-vy, vx))}


def hop(bench):
    rows = []
    for u, v, degrees, *reference in HOPS:
        measured = hop_of(bench, f"hop_{u}_{v}", u, v, degrees, reference[0])
        rows.append({"u": u, "v": v, "degrees": degrees, "measured": measured,
                     "reference": dict(zip(("time", "length", "apex", "speed", "angle"), reference))})
    return {"hops": rows}


# --- the saturated flux of sand ---------------------------------------------------------------------------------------

# Creyssels et al. 2009: u* (m/s), flux (g/m/s); begin and end of the average (s).
FLUX = [(0.24, 5.25, 1.0, 4.0), (0.40, 21.09, 0.6, 1.6), (0.56, 48.85, 0.6, 1.6)]
SEEDS = (1, 2)  # of the bed's diameters
BLOCK = 0.2  # s; shorter ones follow each other


def flux_of(folder, u, creyssels, begin, end):
    h = table(folder / "history.csv")
    rows = [k for k, t in enumerate(h["time"]) if t >= begin]
    end = min(end, h["time"][-1])
    blocks = {}
    for k in rows:
        blocks.setdefault(int((h["time"][k] - begin) / BLOCK), []).append(1e3 * h["sand_flux"][k])
    means = [sum(b) / len(b) for b in blocks.values() if len(b) > 10]
    mean = sum(means) / len(means)
    error = math.sqrt(sum((m - mean) ** 2 for m in means) / max(len(means) - 1, 1) / len(means))
    fit = json.loads((folder / "saltation_sand.json").read_text())
    d, stress = fit["diameter"], 1.2365 * u * u
    p = table(folder / "saltation_sand.csv")
    keep = [k for k, y in enumerate(p["height_over_bed"]) if 0 < y < 400 * d]
    pick = lambda name, scale=1.0: [scale * p[name][k] for k in keep]
    return {"u": u, "creyssels": creyssels, "flux": mean, "error": error, "from": begin, "to": end,
            "flux_decay": fit["flux_decay"]["height"] / d, "flux_decay_error": fit["flux_decay"]["standard_error"] / d,
            "concentration_decay": fit["concentration_decay"]["height"] / d,
            "bed_u": sum(h["sand_bed_friction_velocity"][k] for k in rows) / len(rows),
            "t": h["time"][::10], "q": [1e3 * q for q in h["sand_flux"][::10]],
            "profile": {"height": pick("height_over_bed", 1 / d), "flux": pick("flux"), "wind": pick("air_speed"),
                        "grain_stress": pick("grain_stress", 1 / stress), "air_stress": pick("air_stress", 1 / stress)}}


RANGES = ((5, 20), (20, 60), (60, 150), (4, 80))  # diameters over the bed


def error_of(run):
    """Standard error of the mean flux of one bed, g/m/s: of its blocks or of its autocorrelation, the larger."""
    window = [q for t, q in zip(run["t"], run["q"]) if t >= run["from"]]
    return max(run["error"], statistics.error_of_mean(window)[0])


def decays_of(run):
    """Heights over which the flux falls by a factor e, in diameters, by the range of the fit."""
    height, flux = (numpy.array(run["profile"][key]) for key in ("height", "flux"))
    found = {}
    for low, high in RANGES:
        fit = (height > low) & (height < high) & (flux > 0)
        found[f"{low} to {high} d"] = -1 / numpy.polyfit(height[fit], numpy.log(flux[fit]), 1)[0]
    return found


def stress_of(run):
    """Stress of air and grains over rho u*^2 in layers of ten diameters from 2 d on, six of them: least, mean, largest."""
    p = run["profile"]
    layers = {}
    for h, a, g in zip(p["height"], p["air_stress"], p["grain_stress"]):
        if 2 < h < 62:
            layers.setdefault(int((h - 2) / 10), []).append(a + g)
    sums = [sum(s) / len(s) for s in layers.values()]
    return [min(sums), sum(sums) / len(sums), max(sums)]


def flux(bench):
    runs = []
    for u, creyssels, begin, end in FLUX:
        for seed in SEEDS:
            name = f"flux_{u}_{seed}"
            if not (bench.out / name / "saltation_sand.json").exists():
                bench.run("saltation", name, f"phases.air.friction-velocity={u}", f"fill.1.seed={seed}", f"time.end={end}", f"saltation.0.start={begin}")
            run = flux_of(bench.out / name, u, creyssels, begin, end)
            runs.append(dict(run, seed=seed, error_of_mean=error_of(run), decays=decays_of(run), stress=stress_of(run)))
    return {"block": BLOCK, "runs": runs}


# The same in three dimensions: u*, Creyssels' flux, begin and end of the average (s), beds: the shipped one, or others that settle.
FLUX_3D = [(0.24, 5.25, 0.9, 2.4, (1,)), (0.40, 21.09, 0.4, 1.2, (1,)), (0.56, 48.85, 0.3, 1.0, (1, 2, 3, 4, 5))]


SETTLED_3D = 'fill.1={{ phase = "sand", shape = {{ bed = "8*d", from = "d" }}, packing = "settled", seed = {} }}'
# What each part of the sand, of the air and of the box does, at u* = 0.56 m/s.
NARROW, HEAPS_FRICTION = 'domain.size=["120*d", "800*d", "6*d"]', ["phases.sand.friction=0.6", "phases.sand.rolling-friction=0.4"]
PLAIN = "interactions.air-sand.magnus=false"
TRIED_3D = {"plain": ("6 d wide, friction 0.6, rolling friction 0.4, no Magnus force", [NARROW, SETTLED_3D.format(1), *HEAPS_FRICTION, PLAIN]),
            "sizes": ("the same, log-normal sizes, 0.25", [NARROW, SETTLED_3D.format(1), *HEAPS_FRICTION, PLAIN, 'phases.sand.diameter={ mean = "d", log-normal = 0.25 }']),
            "cheng": ("the same, drag of Cheng 1997", [NARROW, SETTLED_3D.format(1), *HEAPS_FRICTION, PLAIN, "interactions.air-sand.drag=cheng"]),
            "magnus": ("the same, with the Magnus force", [NARROW, SETTLED_3D.format(1), *HEAPS_FRICTION]),
            "friction": ("the same, friction 0.3, rolling friction 1", [NARROW, SETTLED_3D.format(1), PLAIN]),
            "both": ("6 d wide, friction 0.3, rolling friction 1, Magnus force", [NARROW, SETTLED_3D.format(1)]),
            "long": ("240 d long, 6 d wide, friction 0.3, rolling friction 1, Magnus force", ['domain.size=["240*d", "800*d", "6*d"]', SETTLED_3D.format(1)]),
            "gusts": ("12 d wide, friction 0.3, rolling friction 1, Magnus force, gusts of 0.38", ["interactions.air-sand.gusts=0.38"])}


def flux_3d(bench):
    runs, tried = [], []
    for u, creyssels, begin, end, seeds in FLUX_3D:
        for seed in seeds:
            folder = bench.out / f"flux3_{u}_{seed}"
            if not (folder / "saltation_sand.json").exists():
                bed = [] if seed == 1 else [SETTLED_3D.format(seed)]  # the shipped bed is that of seed 1
                bench.run("saltation_3d", folder.name, f"phases.air.friction-velocity={u}", f"time.end={end}", *bed)
            run = flux_of(folder, u, creyssels, begin, end)
            runs.append(dict(run, seed=seed, error_of_mean=error_of(run)))
    for name, (words, overrides) in TRIED_3D.items():
        u, creyssels, begin, end, _ = FLUX_3D[-1]
        folder = bench.out / f"flux3_{name}"
        if not (folder / "saltation_sand.json").exists():
            bench.run("saltation_3d", folder.name, *overrides)
        run = flux_of(folder, u, creyssels, begin, end)
        tried.append({"what": words, "u": u, "creyssels": creyssels, "flux": run["flux"], "error_of_mean": error_of(run)})
    return {"runs": runs, "tried": tried}


IMPACT_WINDS, IMPACT_END = (0.18, 0.20, 0.22, 0.24), 3.0  # u* (m/s), s


def impact(bench):
    """The least wind that keeps saltation going once grains fly: saltation.toml in weak winds, the flux of its last second."""
    runs = []
    for u in IMPACT_WINDS:
        for seed in SEEDS:
            folder = bench.out / f"impact_{u:.2f}_{seed}"
            if not (folder / "saltation_sand.json").exists():
                bench.run("saltation", folder.name, f"phases.air.friction-velocity={u}", f"fill.1.seed={seed}", f"time.end={IMPACT_END}",
                          f"saltation.0.start={IMPACT_END / 2}", "output.every=0.5")
            h = table(folder / "history.csv")
            last = [1e3 * q for t, q in zip(h["time"], h["sand_flux"]) if t >= IMPACT_END - 1.0]
            runs.append({"u": u, "seed": seed, "flux": sum(last) / len(last), "end": h["time"][-1]})
    return {"runs": runs}


# --- flux in resolved air ------------------------------------------------------------------------------------------------

# u*, flux of Creyssels (of 0.50: the line through the points), averaged from and to, s; beds.
RESOLVED = ((0.24, 5.25, 1.8, 3.0, (1,)), (0.40, 21.09, 1.8, 3.0, (1, 2)), (0.50, 36.9, 1.8, 3.0, (1, 2)), (0.56, 48.85, 1.8, 3.0, (1, 2)))
DECAYS = ((5, 30), (30, 100))  # diameters over the bed, ranges of a line through the logarithm of the concentration
RESOLVED_START = 0.35  # m/s: weaker winds need grains in flight to begin with


def flat_bed_with_grains_in_flight(bench):
    """flat_bed.toml with twelve grains in flight at the start, as saltation.toml has them: below the fluid threshold nothing else would start."""
    bed = ROOT / "scenes" / "flat_bed_bed.vtp"
    text = (ROOT / "scenes" / "flat_bed.toml").read_text().replace("flat_bed_bed.vtp", str(bed))
    points = ", ".join(f"[{0.005 + 0.01 * k:.3f}, {0.0055 + 0.0012 * (5 * k % 12):.4f}]" for k in range(12))
    file = bench.out / "flat_bed_with_grains.toml"
    file.write_text(f'{text}\n[[fill]]\nphase = "sand"\nshape = {{ points = [{points}] }}\nvelocity = ["0.5 + x/0.12", "0.5 - x/0.12"]\n')
    return file


def concentration_decays(folder, d):
    """Heights (diameters) over which the concentration falls by a factor e, from each range of heights."""
    import numpy
    p = table(folder / "saltation_sand.csv")
    height, density = numpy.array(p["height_over_bed"]) / d, numpy.array(p["concentration"])
    found = []
    for low, high in DECAYS:
        keep = (height > low) & (height < high) & (density > 0)
        found.append(-1 / numpy.polyfit(height[keep], numpy.log(density[keep]), 1)[0])
    return found


def resolved_run(folder, u, creyssels, begin, seed):
    h = table(folder / "history.csv")
    blocks = {}
    for t, q in zip(h["time"], h["sand_flux"]):
        if t >= begin:
            blocks.setdefault(int((t - begin) / BLOCK), []).append(1e3 * q)
    means = [sum(b) / len(b) for b in blocks.values() if len(b) > 10]
    mean = sum(means) / len(means)
    fit = json.loads((folder / "saltation_sand.json").read_text())
    run = {"u": u, "seed": seed, "creyssels": creyssels, "flux": mean, "error": math.sqrt(sum((m - mean) ** 2 for m in means) / max(len(means) - 1, 1) / len(means)),
           "flux_decay": fit["flux_decay"]["height"] / fit["diameter"], "concentration_decays": concentration_decays(folder, fit["diameter"]),
           "from": begin, "to": h["time"][-1]}
    if "air_equivalent_friction_velocity" in h:
        held = [e for t, e in zip(h["time"], h["air_equivalent_friction_velocity"]) if t >= begin]
        run["equivalent_u"] = sum(held) / len(held)
    if (folder / "profile_wind.csv").exists():
        wind = table(folder / "profile_wind.csv")
        run["wind"] = {"height": [y - fit["bed"] for y in wind["y"]], "speed": wind["velocity_mean_x"]}
    return run


def resolved(bench):
    """flat_bed.toml, whose wind is held by the stress on the lid, rho u*^2: air and sand find their balance."""
    runs = []
    for u, creyssels, begin, end, seeds in RESOLVED:
        for seed in seeds:
            folder = bench.out / f"rflux_{u:g}_{seed}"
            if not (folder / "saltation_sand.json").exists():
                scene = flat_bed_with_grains_in_flight(bench) if u < RESOLVED_START else "flat_bed"
                bed = [] if seed == 1 else [f'fill.3={{ phase = "sand", shape = {{ bed = 0.002 }}, packing = "settled", seed = {seed} }}']
                bench.run(scene, folder.name, *bed, f"phases.lid.shear-stress=[{1.225 * u * u:.9g}, 0]", f"fill.4.velocity.log-profile.friction-velocity={u}",
                          f"forcing.0.friction-velocity={u}", f"time.end={end}", "output.every=0.1",
                          f'saltation=[{{ name = "sand", phase = "sand", every = 1e-3, start = {begin} }}]',
                          f'profile=[{{ name = "wind", phase = "air", every = 1e-3, start = {begin}, box = {{ min = [0, 0.002], max = [0.12, 0.062] }} }}]')
            runs.append(resolved_run(folder, u, creyssels, begin, seed))
    return {"block": BLOCK, "runs": runs}


# --- splash -----------------------------------------------------------------------------------------------------------

# Rice, Willetts & McEwan 1995, medium sand: speed (m/s) and angle of the impact; share of the speed and angle of the rebound; grains
# ejected an impact, and their speed (m/s).
RICE = {"speed": 3.30, "angle": 11.5, "rebound": 0.57, "rebound_angle": 30.2, "ejecta": 2.89, "ejection_speed": 0.266}
SPLASH_D, SPLASH_LEVELS = 3.0e-4, (1.0, 1.5, 2.0)
# In a slab one diameter thick, and in three dimensions: runs, strikers of each, width and thickness (m) of the bed, height (m) of the start.
SPLASHES = ({"scene": "splash", "dimensions": 2, "runs": 20, "strikers": 3, "width": 0.036, "thickness": SPLASH_D, "start": 0.0045},
            {"scene": "splash_3d", "dimensions": 3, "runs": 30, "strikers": 2, "width": 0.0144, "thickness": 0.006, "start": 0.0033})


def frames_of(folder, name, phase):
    """Times, places and velocities of a phase in the order of its ids, frame by frame."""
    frames = [frame.Frame(file, time, phase) for time, file in frame.series(folder / f"{name}.pvd")]
    return [(f.time, f.x.astype(float), f["velocity"].astype(float)) for f in frames]


def risers(frames, height, above):
    """Speed (m/s) and angle at the bed, seen from the side, of each grain that is seen to rise over `height`, `above` metres over the bed: v^2 + 2 g above."""
    found, done = [], set()
    for _, x, v in frames:
        for k in ((x[:, 1] > height) & (v[:, 1] > 0)).nonzero()[0]:
            if k not in done:
                done.add(k)
                up = math.sqrt(v[k, 1] ** 2 + 2 * G * (x[k, 1] - height + above))
                found.append((math.hypot(v[k, 0], up), math.degrees(math.atan2(up, v[k, 0]))))
    return found


def bed_surface(bed, case):
    """Mean over the bed of the highest centre in tiles four diameters long and one thick."""
    tops = {}
    for x, y, z in bed:
        tile = int(x // (4 * SPLASH_D)), int(z // SPLASH_D) if case["dimensions"] == 3 else 0
        tops[tile] = max(tops.get(tile, y), y)
    return sum(tops.values()) / len(tops)


def strikers_of(case, k):
    """Where the strikers of run k begin: every run elsewhere over the same bed, the strikers of one far from each other."""
    n, width, thickness = case["strikers"], case["width"], case["thickness"]
    places = []
    for s in range(n):
        x = (0.001 + width * (s + k / case["runs"]) / n) % width
        place = [x, case["start"]] + ([thickness * ((11 * k % case["runs"]) / case["runs"] + s / n) % thickness] if case["dimensions"] == 3 else [])
        places.append("[" + ", ".join(f"{c:.6f}" for c in place) + "]")
    return "[" + ", ".join(places) + "]"


def splash_of(bench, case, speed=RICE["speed"]):
    """Many impacts of one scene: rebounds and ejected grains, those that rise over a level above the bed. A striker that does not rise so high stays in the bed."""
    rebounds, ejected, counts = ({level: [] for level in SPLASH_LEVELS} for _ in range(3))
    for k in range(case["runs"]):
        folder = bench.run(case["scene"], f"{case['scene']}_{k}", f"fill.2.shape.points={strikers_of(case, k)}", "output.walls=false")
        bed, strikers = frames_of(folder, case["scene"], "sand"), frames_of(folder, case["scene"], "striker")
        surface = bed_surface(bed[0][1], case)
        for level in SPLASH_LEVELS:
            above = level * SPLASH_D
            rebounds[level] += risers(strikers, surface + above, above)
            thrown = risers(bed[1:], surface + above, above)
            ejected[level] += thrown
            counts[level].append(len(thrown) / case["strikers"])
    mean = lambda values: sum(values) / max(len(values), 1)  # noqa: E731
    error = lambda values: math.sqrt(sum((v - mean(values)) ** 2 for v in values) / max(len(values) - 1, 1) / max(len(values), 1))  # noqa: E731
    rows = []
    for level in SPLASH_LEVELS:
        shares, speeds = [v / speed for v, _ in rebounds[level]], [v for v, _ in ejected[level]]
        rows.append({"level": level, "impacts": case["runs"] * case["strikers"], "rebounds": len(shares), "rebound": mean(shares), "rebound_error": error(shares),
                     "rebound_angle": mean([a for _, a in rebounds[level]]), "ejecta": mean(counts[level]), "ejecta_error": error(counts[level]),
                     "ejection_speed": mean(speeds), "ejection_speed_error": error(speeds), "ejection_angle": mean([a for _, a in ejected[level]])})
    return {"scene": case["scene"], "dimensions": case["dimensions"], "levels": rows}


def splash(bench):
    """Many impacts of scenes/splash.toml and splash_3d.toml: the strikers of each run begin at other places of the same bed."""
    return {"rice": RICE, "beds": [splash_of(bench, case) for case in SPLASHES]}


SPLASH_SPEEDS, SPLASH_ANGLES = (1.5, 2.5, 3.3, 4.5, 6.0, 8.0), (10, 20, 40)  # m/s, degrees


def splash_table(bench):
    """splash_3d.toml at many speeds and angles, 60 impacts each, stiffer contacts above 4 m/s; what the results have already is kept."""
    file = RESULTS / "splash-table.csv"
    rows = store.load(file)["rows"] if file.exists() else []
    for angle in SPLASH_ANGLES:
        for speed in SPLASH_SPEEDS:
            if any((r["speed"], r["angle"]) == (speed, angle) for r in rows):
                continue
            a, stiff = math.radians(angle), 300 * max(1, (speed / 4) ** 2)
            own = Bench(bench.program, bench.out / f"splash_{speed}_{angle}", bench.threads)
            own.overrides = [f"fill.2.velocity=[{speed * math.cos(a)}, {-speed * math.sin(a)}, 0]", f"phases.sand.stiffness={stiff}", f"phases.striker.stiffness={stiff}",
                             f"time.largest-speed={1.2 * max(speed, 3.4)}", "domain.size=[0.0144, 0.06, 0.006]"]
            level = splash_of(own, SPLASHES[1], speed)["levels"][1]
            rows.append({"speed": speed, "angle": angle, **{key: level[key] for key in ("impacts", "rebounds", "rebound", "rebound_angle", "ejecta", "ejecta_error", "ejection_speed")}})
            store.keep(file, {"rows": rows})
    return {"rows": rows}


# --- the threshold of the wind ------------------------------------------------------------------------------------------

SHIELDS, COHESION = 0.0123, 3e-4  # A_N and gamma (kg/s2) of Shao & Lu 2000
THRESHOLD_D, THRESHOLD_LOW, THRESHOLD_HIGH, THRESHOLD_STEPS = (1.5e-4, 2.5e-4, 5e-4), 0.8, 2.0, 5
THRESHOLD_WINDS = (((0.85, 0.38), (1, 2)),)  # lift and gusts, and the beds
MOVES = 0.02  # m/s, of the fastest grain in the last third of a run: a bed at rest has 1e-5 m/s or less


def shao_lu(d, density=2650.0, air=1.225, g=9.81):
    """Friction velocity (m/s) at which grains of d begin to move: u*^2 = A_N (rho_s/rho g d + gamma/(rho d)), eq. (24)."""
    return math.sqrt(SHIELDS * (density / air * g * d + COHESION / (air * d)))


def bed_moves(bench, d, u, seed, wind):
    """Whether a bed of grains of d goes on to move in the wind u*; all lengths of the scene by diameters. wind: lift and gusts."""
    scale = d / 2.5e-4
    overrides = {"spacing": 8 * d, "domain.size": f"[{0.12 * scale:.9g}, {0.032 * scale:.9g}]", "phases.sand.diameter.mean": d,
                 "phases.sand.stiffness": 150 * scale**2, "phases.ground.roughness": d / 30, "phases.floor.spacing": 2 * d,
                 "phases.lid.shear-stress": f"[{1.225 * u * u:.9g}, 0]", "fill.0.shape.bed": 8 * d, "fill.3.shape.bed": 8 * d,
                 "fill.4.velocity.log-profile.friction-velocity": u, "fill.4.velocity.log-profile.roughness": d / 30,
                 "fill.3.seed": seed, "interactions.air-sand.lift": wind[0], "interactions.air-sand.gusts": wind[1],
                 "time.end": 0.15 * math.sqrt(scale), "output.every": 0.15 * math.sqrt(scale), "output.walls": "false"}
    folder = bench.run("threshold", f"threshold_{1e6 * d:.0f}_{u:.4f}_{seed}_{wind[1]}", *(f"{key}={value}" for key, value in overrides.items()))
    h = table(folder / "history.csv")
    last = [k for k, t in enumerate(h["time"]) if t > 2 / 3 * h["time"][-1]]
    return max(h["sand_largest_speed"][k] for k in last) > MOVES


def threshold(bench):
    rows = []
    for wind, seeds in THRESHOLD_WINDS:
        for d in THRESHOLD_D:
            for seed in seeds:
                expected = shao_lu(d)
                low, high = THRESHOLD_LOW * expected, THRESHOLD_HIGH * expected
                tried = []
                for _ in range(THRESHOLD_STEPS):
                    middle = 0.5 * (low + high)
                    moves = bed_moves(bench, d, middle, seed, wind)
                    tried.append([middle, moves])
                    low, high = (low, middle) if moves else (middle, high)
                rows.append({"d": 1e3 * d, "lift": wind[0], "gusts": wind[1], "seed": seed, "low": low, "high": high, "shao_lu": expected, "tried": tried})
    return {"rows": rows}


# --- the paper's kernel and drag by name ----------------------------------------------------------------------------------

KERNEL_DRAG_D, KERNEL_DRAG_LENGTH, KERNEL_DRAG_TIMES = 5e-4, 0.06, (0.003, 0.012, 0.021, 0.030)  # m, m, s
MASS_OF_A_SPHERE = math.pi / 6  # in a slab a diameter thick, over that of a grain of the kernel, rho d^2 by metre


def kernel_drag(bench):
    """The flat bed of the paper with its kernel between air and sand, and with drag by name: what leaves the same bed, when and how fast."""
    import numpy
    d, rows = KERNEL_DRAG_D, []
    drag = pathlib.Path(__file__).resolve().parent / "flat_bed_drag.toml"
    for law, scene, share in (("kernel", "paper/flat_bed", 1.0), ("drag", drag, MASS_OF_A_SPHERE)):
        folder = bench.run(scene, f"kernel_drag_{law}", "output.every=5e-4")
        frames = frames_of(folder, pathlib.Path(scene).stem, "sand")
        start = frames[0][1]
        rises = [(t, v[(x[:, 1] - start[:, 1]) > d]) for t, x, v in frames]
        first, how = next((t, v) for t, v in rises if len(v))
        top, mass = start[:, 1].max(), 2650 * d * d * share
        at = []
        for wanted in KERNEL_DRAG_TIMES:
            t, x, v = min(frames, key=lambda f: abs(f[0] - wanted))
            at.append({"t": t, "flying": int((x[:, 1] > top + d).sum()), "height": float(x[:, 1].max() - top) / d,
                       "fastest": float(numpy.hypot(v[:, 0], v[:, 1]).max()), "flux": 1e3 * mass * float(v[:, 0].sum()) / KERNEL_DRAG_LENGTH})
        rows.append({"law": law, "grains": len(start), "take_off": first, "along": float(how[:, 0].mean()), "up": float(how[:, 1].mean()), "at": at})
    return {"rows": rows}


# --- heaps --------------------------------------------------------------------------------------------------------------

HEAP_SEEDS, HEAP_D = (1, 2, 3), 1e-3
HEAP_FRICTIONS = ((0.3, 0.4), (0.6, 0.4), (0.6, 1.0))  # friction and rolling-friction


def surface_of(x, step):
    """Highest centre (m) in each interval of `step`, and the middles of the intervals; up to the first empty one."""
    tops = {}
    for along, up in x[:, :2]:
        k = int(along / step)
        tops[k] = max(tops.get(k, 0.0), up)
    number = next(k for k in range(len(tops) + 1) if k not in tops)
    return [(k + 0.5) * step for k in range(number)], [tops[k] for k in range(number)]


def slope_of(x):
    """Angle (degrees) of the line through the surface of grains at x, from 0.25 to 0.85 of its height; falls along x: positive."""
    import numpy
    along, up = surface_of(x, 2 * HEAP_D)
    low, high = min(up), max(up)
    kept = [k for k, y in enumerate(up) if 0.25 <= (y - low) / (high - low) <= 0.85]
    return -math.degrees(math.atan(numpy.polyfit([along[k] for k in kept], [up[k] for k in kept], 1)[0]))


def drained(bench, seed, *overrides):
    """The last frame of repose.toml with a bed of its own: the angle above the shelf, that of the heap below, and what still moves."""
    import numpy
    shelf, width = 0.0505, 0.076  # m: between the chambers, and where the slot begins
    bed = bench.out / f"repose_bed_{seed}{''.join(overrides)}.vtp".replace("=", "_")
    sand = 'shape = { box = { min = [0, 0.051], max = [0.09, 0.091] } }, packing = "settled"'
    folder = bench.out / bed.stem.replace("_bed", "")
    if not (folder / "repose_000028.vtp").exists():
        bench.generate("repose", bed, "fill.0.shape.box.max=[0.09, 0.051]", "output.walls=false", f'fill.2={{ phase = "sand", {sand}, seed = {seed} }}', *overrides)
        bench.run("repose", folder.name, f'fill.2={{ phase = "sand", shape = {{ file = "{bed}" }} }}', *overrides)
    _, x, v = frames_of(folder, "repose", "sand")[-1]
    above = x[:, 1] > shelf
    mirror = numpy.column_stack([0.09 - x[~above][:, 0], x[~above][:, 1]])
    return {"seed": seed, "angle": slope_of(x[above & (x[:, 0] < width)]), "speed": float(numpy.hypot(*v[above][:, :2].T).max()), "below": slope_of(mirror)}


def heaps(bench):
    """The angle at which repose.toml rests, and what column_collapse.toml leaves, a bed each seed."""
    import numpy
    angles, columns = [drained(bench, seed) for seed in HEAP_SEEDS], []
    harder = [drained(bench, 1, f"phases.sand.friction={mu}", f"phases.sand.rolling-friction={rolling}") for mu, rolling in HEAP_FRICTIONS]
    for seed in HEAP_SEEDS:
        frames = frames_of(bench.run("column_collapse", f"column_{seed}", f"fill.1.seed={seed}"), "column_collapse", "sand")
        start, end = frames[0][1], frames[-1][1]
        length, height = 0.03, float(numpy.quantile(start[:, 1], 0.99)) + 0.5 * HEAP_D
        along, up = surface_of(end, 2 * HEAP_D)
        columns.append({"seed": seed, "aspect": height / length, "front": (float(numpy.quantile(end[:, 0], 0.99)) - length) / length,
                        "gap": (along[-1] + HEAP_D - length) / length, "height": max(up) / length})
    frictions = [dict(h, friction=mu, rolling=rolling) for h, (mu, rolling) in zip(harder, HEAP_FRICTIONS)]
    return {"parameters": {"friction": 0.3, "rolling": 1.0}, "repose": angles, "frictions": frictions, "collapse": columns}


CASES = {"settling": settling, "hop": hop, "splash": splash, "splash-table": splash_table, "threshold": threshold, "flux": flux, "flux-3d": flux_3d, "impact": impact, "resolved": resolved, "heaps": heaps,
         "kernel-drag": kernel_drag}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", help=", ".join(CASES))
    parser.add_argument("--barchan", default=str(ROOT / "build" / "barchan"))
    parser.add_argument("--out", default="/tmp/barchan_saltation")
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    bench = Bench(options.barchan, options.out, options.threads)
    for name in options.cases or CASES:
        if name not in CASES:
            sys.exit(f"no case {name}; expected {', '.join(CASES)}")
        result = CASES[name](bench)
        if name == "flux":
            page.plot(result)
        store.keep(RESULTS / f"{name}.csv", result, leave=("t", "q", "profile"))
        print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
