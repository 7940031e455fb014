#!/usr/bin/python3
"""Whole matrices of cases that once broke, gained energy or went astray, with the defaults of the shipped scenes.

    matrix.py PROGRAM [cavity | block | rings | balls | slide | plates | turns ...] [--sides 20,33,50,100] [--jobs N] [--write]

cavity  lid-driven cavity, Re 100, 400, 1000, 3200, the default radius, 20 to 100 particles a side, four seeds: which end.
block   bouncing_block.toml, Young 5e4 to 1e7 Pa, 1 to 8 m/s, three spacings: energy at the end and at most, over that of the start.
rings   rings.toml at 1, 2 and 4 times its speed: the same.
balls   a frictionless disc and ball, elastic and rigid, on a plate (a box), on a side and on a slope that the lattice cuts, at 20 places: speed along
        the plate over that of the fall.
slide   a block, elastic and rigid, slides with friction 0.3 on each of them: its way to rest over v^2/(2 mu g).
plates  a plate of steel, clamped and free, mixed and double precision, speed from 1e-6 to 1e-2 of the wave speed: change of its energy over 10 periods.
turns   a free square and cube of every formulation turns ten times: change of its angular momentum and energy; a refusal is told.

Prints a line a run and Markdown tables; --write puts those that are wrong, of the cavities all, into bench/robustness/results/CASE.csv. A run that ends with status 3 is named with its
message. Exits with 1 when a run breaks down without a word, or misses its bound and ends with status 0.
"""

import argparse
import concurrent.futures
import itertools
import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store  # noqa: E402

RESULTS = pathlib.Path(__file__).resolve().parent / "results"


def go(program, scene, sets, work, text=None):
    """Status, message and the rows of history.csv (a list of dictionaries of numbers) of one run."""
    path = ROOT / "scenes" / scene
    with tempfile.TemporaryDirectory(dir=work) as folder:
        if text is not None:
            path = pathlib.Path(folder) / scene
            path.write_text(text)
        done = run.scene(program, path, folder + "/out", sets, check=False)
        rows = done.history().rows() if (done.out / "history.csv").exists() else []
        warned = " ".join(w if isinstance(w, str) else json.dumps(w) for w in (done.report or {}).get("warnings", []))
        return done.status, done.stderr.strip().replace(folder + "/", "").replace(f"{ROOT}/", ""), rows, warned


def cavity(options, work, pool):
    sides = [int(n) for n in options.sides.split(",")]
    cases = list(itertools.product(sides, (100, 400, 1000, 3200), (1, 2, 3, 4)))

    def one(case):
        n, reynolds, seed = case
        sets = [f"spacing={1 / n!r}", f"phases.fluid.viscosity={1 / reynolds!r}", "interactions.fluid-fluid=2.1", f"fill.2.seed={seed}", "time.end=30"]
        status, words, rows, _ = go(options.program, "verification/cavity.toml", sets, work)
        return {"a side": n, "Re": reynolds, "seed": seed, "status": status, "until": rows[-1]["time"] if rows else 0, "words": words[:300] if status else ""}
    return list(pool.map(one, cases)), lambda r: r["status"] != 0


def energies(rows, scene):
    """Energy by row: motion, strain, hourglass, weight, and what the springs of contacts hold."""
    def sum_of(row, *ends):
        return sum(v for k, v in row.items() if k.endswith(ends))
    total = [sum_of(r, "_kinetic_energy", "_strain_energy", "_hourglass_energy", "_taken_energy") for r in rows]
    if scene == "block":
        mass = 1000 * .1 * .1
        total = [e + mass * 9.81 * (r["middle_y"] - .05) for e, r in zip(total, rows)]
    return total


def of_energy(name, scene, cases, sets_of, options, work, pool):
    def one(case):
        status, words, rows, warned = go(options.program, scene, sets_of(case), work)
        e, last = energies(rows, name), len(rows) - 1
        if name == "block" and rows:  # in flight, at the top of its last bounce: what the springs of the floor hold has no column
            low = min(range(len(rows)), key=lambda k: rows[k]["middle_y"])
            last = max(range(low, len(rows)), key=lambda k: rows[k]["middle_y"])
        return dict(case, status=status, end=e[last] / e[0] if e else math.nan, most=max(e) / e[0] if e else math.nan,
                    words=(words if status else "told: " + warned if "energy" in warned else "")[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] == 0 and not r["words"] and not (r["most"] < 1.01 and r["end"] > .99)


def block(options, work, pool):
    cases = [{"young": y, "speed": v, "spacing": h} for y in (5e4, 1e5, 2e5, 1e6, 1e7) for v in (1, 2, 4, 6, 8) for h in (2.5e-3, 5e-3, 1e-2)]

    def sets(c):
        end = .2 / c["speed"] + .25
        return [f"phases.block.young={c['young']!r}", f"spacing={c['spacing']!r}", f"fill.1.velocity=[0, {-c['speed']}]", "domain.size=[0.4, 4]",
                f"time.end={end!r}", f"time.largest-speed={c['speed'] + 2}"]
    return of_energy("block", "bouncing_block.toml", cases, sets, options, work, pool)


def rings(options, work, pool):
    cases = [{"times": t, "spacing": h} for t in (1, 2, 4) for h in (1e-3, 1.25e-3, 2e-3)]

    def sets(c):
        v = 6.95 * c["times"]
        return [f"fill.0.velocity=[{v!r}, 0]", f"fill.1.velocity=[{-v!r}, 0]", f"spacing={c['spacing']!r}", f"time.largest-speed={2.1 * v!r}",
                f"time.end={.016 / c['times'] + .004!r}"]
    return of_energy("rings", "rings.toml", cases, sets, options, work, pool)


BALL = """dimensions = {dimensions}
spacing = {spacing}
precision = "double"
[domain]
size = {size}
gravity = {gravity}
[phases.ball]
kind = "{kind}"
density = 1000
{elastic}
[phases.plate]
kind = "wall"
[interactions]
{own}
ball-plate = {{ restitution = 1 }}
[[fill]]
phase = "plate"
shape = {plate}
[[fill]]
phase = "ball"
shape = {ball}
packing = "{packing}"
velocity = {velocity}
[time]
end = 0.02
largest-speed = 3
[output]
every = 0.02
history-every = 1e-4
"""


SLOPE = .37  # rad; no row of the lattice lies along it


def vector_of(three, x, y, z):
    return str([x, y, z] if three else [x, y])


def plate_of(plate, three, wide):
    """The shape of a wall, a place on it, and the directions along and across it. The slope is a wedge that begins at (0.01, 0.01)."""
    if plate == "sides":
        return '{ sides = ["bottom"] }', lambda s: (s, 0.), (1., 0.), (0., 1.)
    if plate == "box":
        low, high = vector_of(three, 0, 0, 0), vector_of(three, wide, .02, .24)
        return "{ box = { min = %s, max = %s } }" % (low, high), lambda s: (s, .02), (1., 0.), (0., 1.)
    along = (math.cos(SLOPE), math.sin(SLOPE))
    far = wide - .01
    corners = [[.01, .01], [far, .01], [far, .01 + (far - .01) * math.tan(SLOPE)]]
    return "{ polygon = %s }" % corners, lambda s: (.01 + s * along[0], .01 + s * along[1]), along, (-along[1], along[0])


def balls(options, work, pool):
    """2.1 m/s, radius 20 mm, spacing 2 mm (3D: 4 mm), gap 4 mm. The plate is a box, the lower side, or a slope that the lattice cuts."""
    cases = [{"dimensions": d, "kind": kind, "plate": plate, "place": round(.1 + .02 * k / 20 * (1 + .05 * (k % 3)), 6)}
             for d in (2, 3) for kind in ("elastic", "rigid") for plate in ("box", "sides", "slope") for k in range(20)]

    def one(c):
        three = c["dimensions"] == 3
        plate, at, along, across = plate_of(c["plate"], three, .24)
        foot = at(c["place"])
        x, y = (foot[d] + .024 * across[d] for d in (0, 1))
        text = BALL.format(
            dimensions=c["dimensions"], spacing=.004 if three else .002, size=vector_of(three, .24, .2, .24), gravity=vector_of(three, 0, 0, 0), kind=c["kind"],
            velocity=vector_of(three, -2.1 * across[0], -2.1 * across[1], 0), elastic="young = 5e6\npoisson = 0.3" if c["kind"] == "elastic" else "",
            own="ball-ball = 1.6" if c["kind"] == "elastic" else "", plate=plate,
            ball="{ %s = { centre = %s, radius = 0.02 } }" % ("sphere" if three else "disc", vector_of(three, x, y, c["place"] + .001)), packing="rows")
        status, words, rows, warned = go(options.program, "ball.toml", [], work, text)
        if status == 2:
            return dict(c, status=status, sideways=math.nan, rebound=math.nan, words=words[:300])
        first, last = ([r["momentum_x"], r["momentum_y"], r.get("momentum_z", 0.)] for r in (rows[0], rows[-1])) if rows else ([math.nan] * 3,) * 2
        start = math.hypot(*first)
        sideways = math.hypot(last[0] * along[0] + last[1] * along[1], last[2]) / start
        return dict(c, status=status, sideways=sideways, rebound=(last[0] * across[0] + last[1] * across[1]) / start, words=(words if status else warned)[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] not in (0, 2) or r["status"] == 0 and not (r["sideways"] < .01 and r["rebound"] > .3)


SLIDE = """dimensions = {dimensions}
spacing = 0.01
precision = "double"
[domain]
size = {size}
periodic = {periodic}
gravity = {gravity}
[phases.block]
kind = "{kind}"
density = 1000
{elastic}
[phases.floor]
kind = "wall"
[interactions]
{own}
block-floor = {{ restitution = 0.5, friction = 0.3 }}
[[fill]]
phase = "floor"
shape = {floor}
[[fill]]
phase = "block"
shape = {block}
packing = "{packing}"
velocity = {velocity}
[[marker]]
name = "middle"
phase = "block"
[time]
end = 0.6
largest-speed = 2
[output]
every = 0.6
history-every = 0.01
"""


def slide(options, work, pool):
    """A block of 100 x 50 mm (3D: 100 x 50 x 80 mm) begins with 1 m/s along the floor; on the slope weight is across it, and in 3D
    slope and block are prisms that go through both sides of a periodic z. Spacing 10 mm."""
    cases = [{"dimensions": d, "kind": kind, "floor": floor, "place": place}
             for d in (2, 3) for kind in ("elastic", "rigid") for floor in ("box", "sides", "slope") for place in (.05, .0527, .0559, .0583)]

    def one(c):
        three = c["dimensions"] == 3
        floor, at, along, across = plate_of(c["floor"], three, .9)
        low = at(c["place"])
        if c["floor"] == "slope":  # a polygon, turned; its outermost layer follows its border
            corners = [[low[d] + u * along[d] + v * across[d] for d in (0, 1)] for u, v in ((0, 0), (.1, 0), (.1, .05), (0, .05))]
            block, packing = "{ polygon = %s }" % corners, "relaxed"
        else:
            block = "{ box = { min = %s, max = %s } }" % (vector_of(three, *low, .08), vector_of(three, low[0] + .1, low[1] + .05, .16))
            packing = "rows"
        text = SLIDE.format(
            dimensions=c["dimensions"], periodic='["z"]' if three and c["floor"] == "slope" else "[]", size=vector_of(three, .9, .6, .24), gravity=vector_of(three, -9.81 * across[0], -9.81 * across[1], 0), kind=c["kind"],
            elastic="young = 1e6\npoisson = 0.3" if c["kind"] == "elastic" else "", own="block-block = 1.6" if c["kind"] == "elastic" else "",
            floor=floor, block=block, packing=packing, velocity=vector_of(three, *along, 0))
        status, words, rows, warned = go(options.program, "slide.toml", [], work, text)
        if status or not rows:
            return dict(c, status=status, way=math.nan, rest=math.nan, words=words[:300])
        way = sum((rows[-1][f"middle_{n}"] - rows[0][f"middle_{n}"]) * along[d] for d, n in enumerate("xy"))
        return dict(c, status=status, way=way * 2 * .3 * 9.81, rest=rows[-1]["block_largest_speed"], words=warned[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] not in (0, 2) or r["status"] == 0 and not abs(r["way"] - 1) < .01


def plates(options, work, pool):
    """cantilever.toml of steel (c = 5064 m/s along a bar), spacing 4 mm, and the same plate without a clamp: 10 periods of the first mode of each."""
    young, density, thick, long = 2e11, 7800., .02, .2
    bar = math.sqrt(young / density)
    cases = [{"motion": m, "precision": p, "speed over c": s} for m in (True, False) for p in ("mixed", "double") for s in (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)]

    def one(c):
        length, root = (long, 1.8751) if c["motion"] else (long + .04, 4.7300)
        period = 2 * math.pi / (root**2 / length**2 * bar * thick / math.sqrt(12))
        v = c["speed over c"] * bar
        # Clamped: grows with the square of the way from the clamp. Free: the parabola that neither moves the plate nor turns it.
        shape = f"{v!r}*((x - 0.06)/0.2)^2*(x > 0.06)" if c["motion"] else f"{v!r}*(6*((x - 0.14)/0.24)^2 - 0.5)"
        sets = ["phases.plate.young=2e11", "phases.plate.poisson=0.3", "phases.plate.density=7800", "spacing=4e-3", f"precision={c['precision']}",
                f'fill.0.velocity=[0, "{shape}"]', f"time.end={10 * period!r}", f"output.every={10 * period!r}", f"output.history-every={period / 20!r}",
                *([] if c["motion"] else ["motion=[]"])]
        status, words, rows, warned = go(options.program, "verification/cantilever.toml", sets, work)
        e = [sum(v for k, v in r.items() if k.endswith(("_kinetic_energy", "_strain_energy", "_hourglass_energy"))) for r in rows]
        change = max(abs(x / e[0] - 1) for x in e) if e else math.nan
        return dict(c, status=status, change=change, words=(words if status else warned)[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] == 0 and not r["words"] and not r["change"] < 1e-3


TURNS = """dimensions = {dimensions}
spacing = 0.01
precision = "{precision}"
[domain]
size = {size}
[phases.body]
kind = "{kind}"
density = 1000
{keys}
[interactions]
{own}
[[fill]]
phase = "body"
shape = {{ box = {{ min = {low}, max = {high} }} }}
{spin}
[time]
end = {end}
largest-speed = 2
[output]
every = {end}
history-every = 0.01
"""


def turns(options, work, pool):
    """10 particles along each edge, E = 1e7 Pa, 10 rad/s (in 3D about an axis that is none of its own), ten turns."""
    kinds = [("elastic", f, p) for f in ("total-lagrangian", "updated-lagrangian") for p in ("mixed", "double")] + [("rigid", "", "double")]
    cases = [{"dimensions": d, "kind": k, "formulation": f, "precision": p} for d in (2, 3) for k, f, p in kinds]

    def one(c):
        three, elastic = c["dimensions"] == 3, c["kind"] == "elastic"
        axis = (2., 6., math.sqrt(60)) if three else (0., 0., 10.)  # 10 rad/s
        r = ("(x - 0.1)", "(y - 0.1)", "(z - 0.1)" if three else "0")
        speed = [f"{axis[(d + 1) % 3]!r}*{r[(d + 2) % 3]} - {axis[(d + 2) % 3]!r}*{r[(d + 1) % 3]}" for d in range(3 if three else 2)]
        spin = f"velocity = {json.dumps(speed)}" if elastic else "angular-velocity = " + (str(list(axis)) if three else "10")
        text = TURNS.format(
            dimensions=c["dimensions"], precision=c["precision"], size=vector_of(three, .2, .2, .2), kind=c["kind"],
            keys=f'formulation = "{c["formulation"]}"\nyoung = 1e7\npoisson = 0.3' if elastic else "",
            own=f"body-body = {1.6 if c['formulation'] == 'total-lagrangian' else 2.4}" if elastic else "", low=vector_of(three, .05, .05, .05),
            high=vector_of(three, .15, .15, .15), spin=spin, end=repr(2 * math.pi))
        status, words, rows, warned = go(options.program, "turns.toml", [], work, text)
        if status or not rows:
            return dict(c, status=status, turning=math.nan, energy=math.nan, words=words[:300])
        names = [k for k in rows[0] if k.startswith("body_angular_momentum")]
        start = math.hypot(*(rows[0][k] for k in names))
        drift = max(math.hypot(*(r[k] - rows[0][k] for k in names)) for r in rows) / start
        e = [sum(v for k, v in r.items() if k.endswith(("_kinetic_energy", "_strain_energy", "_hourglass_energy"))) for r in rows]
        return dict(c, status=status, turning=drift, energy=max(abs(x / e[0] - 1) for x in e), words=warned[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] not in (0, 2) or r["status"] == 0 and not r["turning"] < 1e-3


CASES = {"cavity": cavity, "block": block, "rings": rings, "balls": balls, "slide": slide, "plates": plates, "turns": turns}


def write(path, rows, wrong):
    """Cavities may be measured a few sides at a time: those of other sides stay."""
    if path.stem == "cavity" and path.exists():
        sides = {r["a side"] for r in rows}
        rows = sorted([r for r in store.load(path)["runs"] if r["a side"] not in sides] + rows, key=lambda r: (r["a side"], r["Re"], r["seed"]))
    path.parent.mkdir(exist_ok=True)
    kept = rows if path.stem == "cavity" else list(filter(wrong, rows))
    store.keep(path, {"count": len(rows), "runs": kept, "wrong": sum(map(wrong, rows))})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*", choices=[*CASES, []], default=list(CASES))
    parser.add_argument("--sides", default="20,33,50,100")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    options.program = str(pathlib.Path(options.program).resolve())
    failed = False
    with tempfile.TemporaryDirectory() as work, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name in options.cases:
            rows, wrong = CASES[name](options, work, pool)
            keys = list(rows[0])
            print("| " + " | ".join(keys) + " |\n|" + " --- |" * len(keys))
            for row in rows:
                print("| " + " | ".join(f"{v:.5g}" if isinstance(v, float) else str(v) for v in row.values()) + (" WRONG |" if wrong(row) else " |"))
            bad = sum(map(wrong, rows))
            print(f"\n{name}: {len(rows)} runs, {bad} wrong\n", flush=True)
            failed |= bad > 0
            if options.write:
                write(RESULTS / f"{name}.csv", rows, wrong)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
