#!/usr/bin/python3
"""The stability atlas: where the numerics hold, and where they end.

    /usr/bin/python3 bench/stability/atlas.py build/barchan --write            all families, about 1,700 short runs
    /usr/bin/python3 bench/stability/atlas.py build/barchan vortices dam       some of them
    /usr/bin/python3 bench/stability/atlas.py none --write                     the picture and the ranges again

A family is a small scene. Along each direction one quantity is varied, everything else stays; a map varies two. Each run is done with other
seeds of the disorder, without retreats, and gets one word:

    stable    status 0, and the checks below find nothing
    told      status 0, the run itself warned of what the checks find (run.json)
    stopped   status 3, the watch ended it
    refused   status 2, a wrong scene
    slow      not at its end after --limit seconds: no verdict
    SILENT    status 0, no warning, and the checks find something; or any other status

The checks read the frames and history.csv and use nothing of the program's watch: numbers that are not finite; more than 5 % of a fluid's
particles nearer than 0.3 spacings to another; a density error above 0.3; mechanical energy grown by 5 % of the motion's and by a hundredth of the
weight's, where nothing drives the scene; the angular momentum of a free body changed by 1 %; particles more than a spacing outside the domain. Exits
with 1 when a run is SILENT.
"""

import argparse
import collections
import concurrent.futures
import dataclasses
import itertools
import math
import pathlib
import sys
import tempfile
import tomllib

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402
from barchan_bench.page import BLACK, BLUE, GREEN, ORANGE, SKY, VERMILION, processor  # noqa: E402

RESULTS = pathlib.Path(__file__).resolve().parent / "results" / "atlas.csv"
PICTURE, RANGES = ROOT / "docs/gallery/atlas.png", ROOT / "src/plan/stable_ranges.inc"
WORDS = {"stable": GREEN, "told": SKY, "refused": BLUE, "stopped": ORANGE, "slow": "#999999", "SILENT": VERMILION}
MARGIN = 1.5  # asked of a default: the nearest value that is not stable is at least this factor away


@dataclasses.dataclass
class Direction:
    """Values of one quantity. `sets` makes the overrides of a value; `rule` is the name by which the plan knows the quantity."""
    name: str
    values: tuple
    sets: object
    default: float
    rule: str = ""
    lower_is_free: bool = False  # below the default it only becomes slower or gentler: no margin is asked there


@dataclasses.dataclass
class Family:
    name: str
    scene: str
    base: list
    disorder: str  # override of the disorder of a seed, with {seed}
    directions: list
    maps: list = dataclasses.field(default_factory=list)  # pairs of names
    fluids: tuple = ()
    closed: bool = False  # nothing drives it: mechanical energy may only fall
    turns: bool = False   # a free body: its angular momentum stays
    seeds: int = 2
    rule: str = ""        # the plan's name of the kind of physics


def key(path, form="{:.10g}"):
    return lambda v: [f"{path}={form.format(v)}"]


def several(*paths):
    return lambda v: [f"{p}={v:.10g}" for p in paths]


SAFETY = (.25, .5, .75, 1, 1.25, 1.5, 1.75, 2, 2.5, 3, 4, 6, 10)
RADII = (.8, 1., 1.2, 1.4, 1.6, 1.8, 2.1, 2.4, 2.6, 3., 3.5, 4.)
DISORDER = (0., .05, .1, .15, .2, .3, .4, .5)


def safety(values=SAFETY):
    return Direction("time.safety", values, key("time.safety"), 1, "safety", lower_is_free=True)


def vortices(scheme):
    radius = 2.1 if scheme == "consistent" else 2.6
    return Family(
        f"vortices, {scheme}", "verification/taylor_green", ["spacing=0.04", "time.end=0.5", f"phases.fluid.scheme={scheme}"] +
        ([f"interactions.fluid-fluid={radius}"] if scheme == "plain" else []), "fill.0.seed={seed}",
        [safety(),
         Direction("sound speed / flow speed", (1.2, 1.5, 2, 3, 4, 5, 6.6, 10, 15, 30, 100), key("phases.fluid.sound-speed"), 10, "sound"),
         Direction("viscosity, m2/s", (0., 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2, .1, 1., 10.), key("phases.fluid.viscosity"), 1e-2),
         Direction("radius, spacings", RADII, key("interactions.fluid-fluid"), radius, "radius"),
         Direction("disorder, spacings", DISORDER, key("fill.0.perturb"), .2, "disorder", lower_is_free=True),
         Direction("spacing, m", (.1, 1 / 15, .05, .04, 1 / 30, .025, .02, 1 / 70), key("spacing"), .04),
         Direction("time, s (vortices turn once in 3 s)", (.5, 2., 10., 50.), lambda v: [f"time.end={v:.10g}"], .5),
         Direction("background pressure, rho c2", (0., .01, .05, .1, .3, 1.), key("phases.fluid.background-pressure"), 0),
         Direction("shifting", (0., .25, .5, 1., 1.5, 2., 4., 8.), key("phases.fluid.shifting"), 1),
         Direction("density diffusion", (0., .01, .025, .05, .1, .2, .5, 1.), key("phases.fluid.density-diffusion"), .05)],
        maps=[("time.safety", "radius, spacings"), ("radius, spacings", "disorder, spacings"),
              ("sound speed / flow speed", "viscosity, m2/s")], fluids=("fluid",), closed=True, seeds=3, rule=f"{scheme} fluid")


def dam(scheme):
    radius = 2.6
    return Family(
        f"dam break, {scheme}", "verification/dam_break", ["spacing=5.715e-3", "time.end=0.4", "output.every=0.4", f"phases.water.scheme={scheme}", "fill.1.perturb=0.05"],
        "fill.1.seed={seed}",
        [safety(),
         Direction("sound speed / flow speed", (1.2, 2, 3, 4, 5, 6.6, 10, 15, 30, 60), lambda v: [f"phases.water.sound-speed={2.12 * v:.10g}"], 10, "sound"),
         Direction("radius, spacings", RADII[3:], several("interactions.water-water", "interactions.water-tank"), radius, "radius"),
         Direction("viscosity, m2/s", (0., 1e-8, 1e-6, 1e-4, 1e-2, 1e-1), key("phases.water.viscosity"), 1e-6),
         Direction("artificial viscosity", (0., .005, .01, .02, .04, .1, .3, 1.), key("phases.water.artificial-viscosity"), .02),
         Direction("disorder, spacings", DISORDER, key("fill.1.perturb"), .05, "disorder", lower_is_free=True),
         Direction("spacing, m", (.011430, 5.715e-3, 3.81e-3, 2.8575e-3), key("spacing"), 5.715e-3)],
        fluids=("water",), closed=True, rule=f"{scheme} fluid")


def cavity():
    """Re 1000, 20 particles a side, the default radius. Where the lid meets a wall that rests a particle once was squeezed into the corner."""
    return Family(
        "cavity", "verification/cavity", ["spacing=0.05", "phases.fluid.viscosity=1e-3", "interactions.fluid-fluid=2.1", "time.end=10", "output.every=10"],
        "fill.2.seed={seed}",
        [safety(),
         Direction("Reynolds number", (10., 100., 400., 1000., 3200., 1e4, 1e5), lambda v: [f"phases.fluid.viscosity={1 / v:.10g}"], 1000),
         Direction("sound speed / flow speed", (1.5, 3, 5, 6.6, 10, 15, 30), key("phases.fluid.sound-speed"), 10, "sound"),
         Direction("radius, spacings", RADII[3:], several("interactions.fluid-fluid"), 2.1, "radius"),
         Direction("disorder, spacings", DISORDER, key("fill.2.perturb"), .2, "disorder", lower_is_free=True),
         Direction("spacing, m", (.1, 1 / 15, .05, 1 / 33, .02), key("spacing"), .05)],
        fluids=("fluid",), rule="consistent fluid")


def turning():
    """A free square that turns once about its middle (0.63 s)."""
    def spin(w):
        return [f'fill.0.velocity=["{-w:.10g}*(y - 0.1)", "{w:.10g}*(x - 0.1)"]', f"time.end={2 * math.pi / w:.10g}", f"output.every={2 * math.pi / w:.10g}",
                f"output.history-every={.2 / w:.10g}", f"time.largest-speed={.1 * w:.10g}"]
    return Family(
        "turning square", "verification/spinning_square", spin(10.), "title=seed {seed}",
        [Direction("time.safety", SAFETY, key("time.safety"), 1, lower_is_free=True),
         Direction("Young's modulus, Pa", (3e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e10, 1e12), key("phases.square.young"), 1e7),
         Direction("angular velocity, 1/s", (1e-3, .1, 1., 3., 10., 30., 100., 300., 1000.), spin, 10),
         Direction("radius within a body, spacings", (1.1, 1.3, 1.6, 2., 2.4, 2.8, 3.2, 4.), key("interactions.square-square"), 1.6),
         Direction("Poisson's ratio", (-.5, 0., .1, .2, .3, .4, .45, .49), key("phases.square.poisson"), .3),
         Direction("disorder, spacings", DISORDER, key("fill.0.perturb"), 0, lower_is_free=True)],
        closed=True, turns=True, seeds=1)


def families():
    return [
        vortices("consistent"), vortices("plain"), cavity(), dam("consistent"), dam("plain"),
        Family("two fluids", "verification/two_phase_column", ["spacing=4e-3", "output.every=0.05", "fill.1.perturb=0.05", "fill.2.perturb=0.05"],
               "fill.1.seed={seed}",
               [safety(),
                Direction("density ratio", (1., 2., 5., 10., 50., 200., 1000., 2000., 5000., 20000.),
                          lambda v: [f"phases.air.density={1225 / v:.10g}"], 1000, "density ratio"),
                Direction("sound speed / flow speed", (1.2, 2, 3, 5, 10, 13, 20, 40, 100), several("phases.water.sound-speed", "phases.air.sound-speed"),
                          20, "sound"),
                Direction("radius, spacings", RADII[3:], several(*(f"interactions.{e}" for e in ("water-water", "air-air", "water-air",
                          "water-wall", "air-wall"))), 2.6, "radius"),
                Direction("disorder, spacings", DISORDER, several("fill.1.perturb", "fill.2.perturb"), .05, "disorder", lower_is_free=True),
                Direction("viscosity of the air, m2/s", (0., 1e-6, 1.48e-5, 1e-4, 1e-3, 1e-2, .1), key("phases.air.viscosity"), 1.48e-5)],
               fluids=("water", "air"), closed=True, rule="consistent fluid"),
        Family("elastic cubes", "paper/impact_cubes", ["fill.0.shape.cube.count=5", "fill.1.shape.cube.count=5", "output.every=1", "precision=double"],
               "title=seed {seed}",
               [safety(),
                Direction("Young's modulus, Pa", (1., 1e2, 1e4, 1e6, 1e7, 1e8, 1e9, 1e10, 2.06e11, 1e12, 1e13, 2.06e14),
                          lambda v: [f"phases.{p}.young={v:.10g}" for p in "ab"], 2.06e11),
                Direction("speed / sound speed of the bar", (1e-5, 1e-4, 1e-3, 1.95e-3, 1e-2, .03, .1, .2, .5, 1.),
                          lambda v: [f"fill.0.velocity=[{5116 * v:.10g},0,0]", f"time.largest-speed={5116 * v:.10g}", f"time.end={2.5e-3 / (5116 * v):.10g}"],
                          1.95e-3, "elastic speed", lower_is_free=True),
                Direction("radius within a body, spacings", (1.1, 1.3, 1.6, 2., 2.4, 2.8, 3.2, 4.), several("interactions.a-a", "interactions.b-b"), 2.4, "radius"),
                Direction("radius between bodies, spacings", (.8, .9, 1., 1.2, 1.5, 2., 2.4, 3., 4.), key("interactions.a-b"), 1.),
                Direction("artificial viscosity", (0., .05, .1, .2, .4, 1., 2.), several("phases.a.artificial-viscosity", "phases.b.artificial-viscosity"), .2),
                Direction("Poisson's ratio", (-.5, 0., .1, .2, .3, .4, .45, .49), several("phases.a.poisson", "phases.b.poisson"), .3),
                Direction("disorder, spacings", DISORDER, several("fill.0.perturb", "fill.1.perturb"), 0, "disorder", lower_is_free=True)],
               closed=True, seeds=1, rule="elastic"),
        Family("two particles", "verification/two_particle_impact", [], "precision=double",
               [safety(),
                Direction("Young's modulus, Pa", (1., 1e2, 1e4, 1e6, 1e8, 1e10, 2.06e11, 1e12, 1e13, 2.06e14),
                          lambda v: [f"phases.{p}.young={v:.10g}" for p in "ab"], 2.06e11),
                Direction("speed / sound speed of the bar", (1e-5, 1e-4, 1e-3, 1.95e-3, 1e-2, .03, .1, .2, .5, 1.),
                          lambda v: [f"fill.0.velocity=[{5116 * v:.10g},0,0]", f"time.largest-speed={5116 * v:.10g}", f"time.end={2.5e-3 / (5116 * v):.10g}"],
                          1.95e-3, "elastic speed", lower_is_free=True),
                Direction("radius between bodies, spacings", (.8, .9, 1., 1.2, 1.5, 2., 2.4), key("interactions.a-b"), 1.)],
               closed=True, seeds=1, rule="elastic"),
        turning(),
        Family("grains in air", "verification/pile", ["time.end=0.03", "output.every=0.03", "fill.2.perturb=0.05"], "fill.2.seed={seed}",
               [safety(),
                Direction("sound speed / flow speed", (3, 5, 10, 20, 26, 40, 60, 100, 200), key("phases.air.sound-speed"), 40),
                Direction("drag coefficient", (0., .1, .25, .5, .66, 1., 1.5, 3., 10.), key("interactions.air-sand.drag"), 1.),
                Direction("radius of air and sand, spacings", (.8, 1., 1.4, 1.6, 2., 2.5, 3., 3.5, 4.), key("interactions.air-sand.radius"), 2.5),
                Direction("radius of sand and sand, spacings", (.8, 1., 1.1, 1.3, 1.6, 2., 2.4), key("interactions.sand-sand"), 1.1),
                Direction("density ratio", (2., 10., 100., 500., 1000., 2163., 4000., 10000.), lambda v: [f"phases.sand.density={1.225 * v:.10g}"], 2163),
                Direction("contact speed, m/s", (.5, 1., 2., 5., 10., 20., 50.), key("phases.sand.contact-speed"), 20),
                Direction("disorder of the air, spacings", DISORDER, key("fill.2.perturb"), .05, lower_is_free=True)],
               fluids=("air",), seeds=1, rule="grains"),
        Family("spheres", "repose", ["domain.size=[0.16, 0.06]", "fill.0.shape.box.max=[0.16, 0.001]", "fill.0.shape.box.min=[0, 0]", "phases.sand.friction=1.0", "phases.sand.rolling-friction=0.8",
                                     'fill.2={ phase = "sand", shape = { box = { min = [0, 0.001], max = [0.05, 0.036] } }, packing = "staggered", perturb = 0.02 }',
                                     "time.largest-speed=1.0", "time.end=0.1", "output.every=0.1"], "fill.2.seed={seed}",
               [safety(),
                Direction("restitution", (.01, .05, .1, .3, .5, .7, .9, 1.), key("phases.sand.restitution"), .5),
                Direction("friction", (0., .1, .3, .5, 1., 2., 10.), key("phases.sand.friction"), 1.),
                Direction("rolling friction", (0., .1, .4, .8, 1.6, 5.), key("phases.sand.rolling-friction"), .8),
                Direction("stiffness, N/m", (5., 20., 100., 500., 1333., 2000., 3000., 1e4, 1e5, 1e6), key("phases.sand.stiffness"), 2e3),
                Direction("spread of diameters", (0., .1, .2, .3, .5), key("phases.sand.diameter.spread"), .2),
                Direction("density, kg/m3", (10., 100., 1000., 2650., 8000., 2e4), key("phases.sand.density"), 2650)],
               seeds=1, rule="spheres"),
        Family("wind over a bed", "paper/flat_bed", ["time.end=1e-3", "output.every=1e-3", "fill.3.perturb=0.02"], "fill.3.seed={seed}",
               [safety((.5, .75, 1, 1.25, 1.5, 2, 3, 5, 10)),
                Direction("sound speed / wind speed", (1.5, 3, 5, 7.8, 12, 18, 30), lambda v: [f"phases.air.sound-speed={33.3 * v:.10g}"], 12),
                Direction("friction velocity, m/s", (0., .5, 1., 1.33, 2., 3., 5., 10.),
                          key("fill.3.velocity.log-profile.friction-velocity"), 2.),
                Direction("drag coefficient", (0., .1, .29, .44, .66, 1., 3., 10.), key("interactions.air-sand.drag"), .44),
                Direction("radius of air, spacings", (1.4, 1.8, 2., 2.4, 3., 3.5, 4.), several("interactions.air-air", "interactions.air-lid"), 3.)],
               fluids=("air",), seeds=1, rule="grains"),
        Family("air column", "saltation", ["time.end=0.01", "time.largest-speed=5"], "fill.1.seed={seed}",
               [safety((.25, .5, 1, 1.5, 2, 3, 5, 10)),
                Direction("friction velocity, m/s", (0., .1, .2, .27, .4, .6, 1., 2., 4.), key("phases.air.friction-velocity"), .4),
                Direction("resolution, m", (1e-5, 2e-5, 4e-5, 6e-5, 9e-5, 1.2e-4, 2.4e-4), key("phases.air.resolution"), 6e-5),
                Direction("averaging, s", (.001, .01, .033, .05, .075, .2, 1.), key("phases.air.averaging"), .05),
                Direction("stiffness, N/m", (10., 50., 100., 150., 225., 600., 2400.), key("phases.sand.stiffness"), 150)],
               seeds=1, rule="column")]


def runs_of(family):
    """(kind, names, values, seed, overrides) of each run; a value that is the same point twice runs twice."""
    seeds = [[] if "{seed}" not in family.disorder and k else [family.disorder.format(seed=k + 1)] for k in range(family.seeds)]
    for direction in family.directions:
        for value, seed in itertools.product(direction.values, range(family.seeds)):
            order = direction.name.startswith("disorder") and value == 0  # nothing is random: a seed is refused
            if not (order and seed):
                yield (direction.name,), (value,), seed, family.base + ([] if order else seeds[seed]) + direction.sets(value)
    named = {d.name: d for d in family.directions}
    for a, b in family.maps:
        for u, v in itertools.product(named[a].values, named[b].values):
            order = b.startswith("disorder") and v == 0
            yield (a, b), (u, v), 0, family.base + ([] if order else seeds[0]) + named[a].sets(u) + named[b].sets(v)


def near(x, spacing, size, periodic):
    """Share of the particles with a neighbour nearer than 0.3 spacings, by cells of that size."""
    reach = .3 * spacing
    shape = numpy.maximum(numpy.floor(numpy.asarray(size) / reach).astype(int), 1)
    cells = collections.defaultdict(list)
    places = numpy.floor(x / reach).astype(int)
    for k, place in enumerate(places):
        cells[tuple(place % shape if periodic else place)].append(k)
    found = 0
    for k, place in enumerate(places):
        found += any(other != k and numpy.linalg.norm((d := x[k] - x[other]) - periodic * size * numpy.round(d / size)) < reach
                     for step in itertools.product((-1, 0, 1), repeat=x.shape[1])
                     for other in cells.get(tuple((place + step) % shape if periodic else place + step), ()))
    return found / max(len(x), 1)


def trouble(out, name, scene, family):
    """What the checks find in a run that ended with 0; an empty string if nothing."""
    history = table(out / "history.csv")
    entries = series(out / f"{name}.pvd")
    first, last = Frame(entries[0][1], 0), Frame(entries[-1][1], 1)
    dims, size = scene.get("dimensions", 2), numpy.asarray(scene["domain"]["size"], float)
    origin = numpy.asarray(scene["domain"].get("origin", [0] * dims), float)
    if not all(numpy.isfinite(a).all() for a in (last.x, last["velocity"], *history.values())):
        return "not finite"
    walls = [name for name, phase in scene["phases"].items() if phase["kind"] == "wall"]
    moving = ~numpy.isin(last["phase"], [last.names.index(w) for w in walls if w in last.names])
    x = last.x[moving, :dims] - origin
    axes = [d for d in range(dims) if "xyz"[d] not in scene["domain"].get("periodic", [])]
    spacing = scene["spacing"]
    if ((x < -spacing) | (x > size + spacing))[:, axes].any():
        return "escape"
    error = numpy.nanmax(history["largest_density_error"]) if family.fluids else 0
    if error > .3:
        return f"density error {error:.2g}"
    for fluid in family.fluids:
        own = last.x[last["phase"] == last.names.index(fluid), :dims] - origin
        if near(own, spacing, size, len(axes) == 0) > .05:
            return "pairs"
    if family.turns:
        turning = next(v for k, v in history.items() if "_angular_momentum [" in k)
        if (drift := numpy.abs(turning / turning[0] - 1).max()) > .01:
            return f"angular momentum changed by {drift:.2g}"
    if family.closed:
        kinetic = sum(v for k, v in history.items() if "_kinetic_energy [" in k)
        gravity = numpy.asarray(scene["domain"].get("gravity", [0] * dims), float)
        weight = []
        for frame in (first, last):
            keep = ~numpy.isin(frame["phase"], [frame.names.index(w) for w in walls if w in frame.names])
            volume = spacing**dims
            density = numpy.array([scene["phases"][n].get("density", 0) for n in frame.names])[frame["phase"][keep]]
            weight.append(-float((volume * density * (frame.x[keep, :dims] @ gravity)).sum()))
        grown, most = kinetic[-1] + weight[1] - kinetic[0] - weight[0], max(kinetic.max(), 1e-300)
        if kinetic[-1] > 1e-6 * max(abs(weight[0]), most) and grown > .05 * most and grown > 1e-2 * abs(weight[0]):
            return f"energy grew by {grown / most:.2g} of the motion's"
    return ""


def carry_out(program, family, overrides, limit):
    """One run; its word and what was said."""
    path = ROOT / f"scenes/{family.scene}.toml"
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "run"
        ended = run.scene(program, path, out, overrides + ["output.compress=false", "output.checkpoint-every=0"], options=["--retreats", "0"],
                          timeout=limit, check=False)
        if ended.status is None:
            return "slow", ""
        said = ended.stderr.strip().splitlines()
        said = next((line.partition("barchan: ")[2] or line for line in said if "warning" not in line), "")
        if ended.status == 3:
            return "stopped", said
        if ended.status == 2:
            return "refused", said
        if ended.status != 0:
            return "SILENT", f"status {ended.status}: {said}"
        scene = tomllib.loads(path.read_text())
        for o in overrides:
            if o.startswith("spacing="):
                scene["spacing"] = float(o.partition("=")[2])
            for phase in scene["phases"]:
                if o.startswith(f"phases.{phase}.density="):
                    scene["phases"][phase]["density"] = float(o.partition("=")[2])
        found = trouble(out, path.stem, scene, family)
        if not found:
            return "stable", ""
        warnings = ended.report["warnings"]
        return ("told" if warnings else "SILENT"), found


def kind_of(said):
    """The sort of failure that the watch's words tell."""
    for words, sort in (("in one place", "collapse"), ("pairs", "pairs"), ("density", "density"), ("escaped", "escape"), ("passed the wall", "escape"),
                        ("energy", "energy"), ("faster", "too fast"), ("in one step", "too fast"), ("not finite", "not finite"), ("overlap", "collapse")):
        if words in said:
            return sort
    return "other"


def sweep(program, family, options):
    points = {}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        jobs = [(names, values, pool.submit(carry_out, program, family, overrides, options.limit)) for names, values, _, overrides in runs_of(family)]
        for names, values, job in jobs:
            word, said = job.result()
            point = points.setdefault((names, values), {"of": list(names), "at": list(values), "words": [], "why": ""})
            point["words"].append(word)
            if word not in ("stable", "refused") and not point["why"]:
                point["why"] = said if word in ("told", "SILENT") else kind_of(said) if word == "stopped" else ""
            if word == "SILENT" or (word == "stopped" and kind_of(said) == "other"):
                print(f"{family.name}: {names} = {values}: {word}: {said}", flush=True)
    return list(points.values())


def worst(words):
    return max(words, key=list(WORDS).index)


def stable_range(family, direction, points):
    """The values round the default between which no run was unstable: (lowest stable, highest stable, nearest unstable below, above)."""
    line = sorted((p["at"][0], worst(p["words"])) for p in points if p["of"] == [direction.name])
    good = lambda w: w in ("stable", "slow", "refused")
    below = [v for v, w in line if v < direction.default and not good(w)]
    above = [v for v, w in line if v > direction.default and not good(w)]
    bad_low, bad_high = max(below, default=None), min(above, default=None)
    inside = [v for v, w in line if w == "stable" and (bad_low is None or v > bad_low) and (bad_high is None or v < bad_high)]
    return min(inside, default=direction.default), max(inside, default=direction.default), bad_low, bad_high


def margins(family, direction, points):
    """Line of the page, and whether the default has its margin."""
    low, high, bad_low, bad_high = stable_range(family, direction, points)
    at_default = [worst(p["words"]) for p in points if p["of"] == [direction.name] and math.isclose(p["at"][0], direction.default, rel_tol=.05, abs_tol=1e-12)]
    down = math.inf if bad_low is None or bad_low <= 0 else direction.default / bad_low
    up = math.inf if bad_high is None or direction.default == 0 else bad_high / direction.default
    good = at_default == ["stable"] and up >= MARGIN and (down >= MARGIN)
    text = lambda v: "none" if v is None else f"{v:.4g}"
    factor = min(down, up)
    why = "; ".join(sorted({p["why"] for p in points if p["of"] == [direction.name] and p["why"]}))[:90]
    return (f"| {family.name} | {direction.name} | {direction.default:.4g} | {low:.4g} to {high:.4g} | {text(bad_low)} | {text(bad_high)} | "
            f"{'none found' if factor == math.inf else f'{factor:.2f}'} | {'' if good else 'MISSED'} | {why} |"), good


def draw(results):
    pyplot = pages.pyplot()
    from matplotlib.lines import Line2D
    known = {f.name: f for f in families()}
    maps = [(name, pair) for name in results for pair in known[name].maps]
    rows = sum(len(known[n].directions) for n in results)
    across = 2   # maps beside each other
    below = math.ceil(len(maps) / across)
    figure = pyplot.figure(figsize=(8, .23 * rows + 3.9 * below + 1))   # 800 pixels: letters of 10 points have 14
    first, *others = figure.subfigures(2, 1, height_ratios=[.23 * rows + 1, 3.9 * below])
    axes = first.add_axes((.53, .6 / (.23 * rows + 1), .45, 1 - 1.2 / (.23 * rows + 1)))
    labels, row = [], 0
    for name in results:
        for direction in known[name].directions:
            for p in (p for p in results[name] if p["of"] == [direction.name]):
                base = direction.default if direction.default > 0 else max(direction.values) / 10
                x = math.log10(p["at"][0] / base) if p["at"][0] > 0 else None
                x = -3.4 if x is None or x < -3.2 else min(x, 3.2)
                axes.plot(x, row, marker="o" if worst(p["words"]) == "stable" else "s", color=WORDS[worst(p["words"])], markersize=5, linestyle="")
            labels.append(f"{name}: {direction.name} ({direction.default:.3g})")
            row += 1
        axes.axhline(row - .5, color="0.8", linewidth=.8)
    axes.axvline(0, color=BLACK, linewidth=.8)
    for factor in (1 / MARGIN, MARGIN):
        axes.axvline(math.log10(factor), color=BLACK, linewidth=.6, linestyle=":")
    axes.set(yticks=range(row), ylim=(row - .5, -.5), xlim=(-3.6, 3.4), xticks=[-3.4, -3, -2, -1, 0, 1, 2, 3],
             xticklabels=["0", "", "1/100", "1/10", "1", "10", "100", "1000"])
    first.text(.5, 1 - .1 / (.23 * rows + 1), "Each dot: the worst of the runs at one value, as a factor of the default (its number in\n"
               f"brackets; of 0: a tenth of the largest); dotted: the factor {MARGIN}", ha="center", va="top", fontsize=11)
    axes.set_yticklabels(labels, fontsize=9)
    axes.legend(handles=[Line2D([], [], marker="o" if w == "stable" else "s", color=c, linestyle="", label=w) for w, c in WORDS.items()], ncol=6,
                loc="upper center", bbox_to_anchor=(-.1, -.3 / (.23 * rows)), frameon=False)
    for k, (name, (a, b)) in enumerate(maps):
        axes = others[0].add_axes((.1 + .5 * (k % across), (below - k // across - 1) / below + .8 / (3.9 * below), .38, 2.7 / (3.9 * below)))
        points = [p for p in results[name] if p["of"] == [a, b]]
        xs, ys = sorted({p["at"][0] for p in points}), sorted({p["at"][1] for p in points})
        for p in points:
            axes.plot(xs.index(p["at"][0]), ys.index(p["at"][1]), marker="o" if worst(p["words"]) == "stable" else "s",
                      color=WORDS[worst(p["words"])], markersize=8, linestyle="")
        axes.set_title(name, fontsize=11)
        axes.set_xlabel(a), axes.set_ylabel(b)
        axes.set_xticks(range(len(xs)), [f"{v:.3g}" for v in xs], fontsize=9, rotation=60)
        axes.set_yticks(range(len(ys)), [f"{v:.3g}" for v in ys], fontsize=9)
    figure.savefig(PICTURE, dpi=100, pil_kwargs={"optimize": True})


def tables():
    """That of docs/stability.md."""
    kept = store.load(RESULTS)
    results, known = kept["families"], {f.name: f for f in families()}
    counts = collections.Counter(w for points in results.values() for p in points for w in p["words"])
    lines, missed = [], 0
    for name, points in results.items():
        for direction in known[name].directions:
            line, good = margins(known[name], direction, points)
            lines.append(line)
            missed += not good
    text = [f"{sum(counts.values())} runs: " + ", ".join(f"{counts[w]} {w}" for w in WORDS if counts[w]) + f". Measured on {kept['processor']}, "
            f"{kept['instructions']}.\n", "![The atlas](gallery/atlas.png)\n",
            "\"Stable\": between the nearest values on both sides of the default at which a run was unstable (a refusal is none). The factor is the distance of the "
            f"nearest of them from the default; {MARGIN} is asked.\n",
            "| family | quantity | default | stable | nearest unstable below | nearest above | factor | | why |\n" + "| --- " * 9 + "|"] + lines
    return {"atlas": "\n".join(text)}
    print(text[0] + f"{missed} of {len(lines)} defaults have a margin below {MARGIN}")


def write_ranges(results, known):
    """src/plan/stable_ranges.inc: of each kind of physics and quantity that the plan knows, the range that is stable in every family."""
    ranges = {}
    for name, points in results.items():
        for direction in (d for d in known[name].directions if d.rule):
            low, high, _, _ = stable_range(known[name], direction, points)
            if direction.lower_is_free:
                low = 0
            if direction.rule == "sound":  # of a fast sound some seeds of a splash were stopped; waves and tanks at rest take any
                high = 1e9
            at = (known[name].rule, direction.rule)
            old = ranges.get(at, (-math.inf, math.inf))
            ranges[at] = (max(low, old[0]), min(high, old[1]))
    rows = [f'{{"{kind}", "{quantity}", {low:.6g}, {high:.6g}}},' for (kind, quantity), (low, high) in sorted(ranges.items())]
    RANGES.write_text("// Written by bench/stability/atlas.py: the values between which every run of the atlas was stable.\n" + "\n".join(rows) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="PROGRAM", help="build/barchan, or none")
    parser.add_argument("families", nargs="*", metavar="FAMILY", help="beginnings of names; all if there is none")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=60, help="seconds after which a run is given up")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    silent = 0
    if options.program != "none":
        program = str(pathlib.Path(options.program).resolve())
        said = run.version(program)
        kept = store.load(RESULTS, {"families": {}})
        kept.update(processor=processor(), instructions=said.partition("instruction set: ")[2].split(" (")[0])
        for family in families():
            if options.families and not any(family.name.startswith(f) for f in options.families):
                continue
            points = sweep(program, family, options)
            counts = collections.Counter(w for p in points for w in p["words"])
            print(f"{family.name}: {sum(counts.values())} runs: {dict(counts)}", flush=True)
            silent += counts["SILENT"]
            kept["families"][family.name] = points
            for direction in family.directions:
                print("  " + margins(family, direction, points)[0], flush=True)
        if options.write:
            kept["families"] = {f.name: kept["families"][f.name] for f in families() if f.name in kept["families"]}
            store.keep(RESULTS, kept)
    if options.write:
        kept, known = store.load(RESULTS), {f.name: f for f in families()}
        write_ranges(kept["families"], known)
        draw(kept["families"])
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
