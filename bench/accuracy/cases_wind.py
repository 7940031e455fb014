"""The wind of the paper's scenes: does it hold its logarithmic profile, upstream of a dune and over a bed held fixed; the dune's own flow."""

import math

import numpy

from harness import attempt, document, report, run, tell, toml

HEIGHTS = (1e-3, 2e-3, 4e-3, 8e-3)  # m over the bed


class Wind:
    """What a scene says of its wind and its bed."""

    def __init__(self, scene):
        fill = next(f for f in scene["fill"] if f["phase"] == "air")
        profile = fill["velocity"]["log-profile"]
        self.friction, self.roughness = profile["friction-velocity"], profile["roughness"]
        sand = next(f["shape"] for f in scene["fill"] if f["phase"] == "sand")
        ground = [f["shape"] for f in scene["fill"] if isinstance(f["shape"], dict) and "bed" in f["shape"]]
        shape = sand if "bed" in sand else ground[0]  # a bed from a file lies on the ground of the air
        self.bed, self.dune = shape["bed"], shape.get("dune", {})
        self.dx, self.size, self.end = scene["spacing"], scene["domain"]["size"], scene["time"]["end"]
        self.density = scene["phases"]["air"]["density"]

    def law(self, y):
        """u(y) = (u*/0.4) ln(y/y0), y over the bed; Halik et al. 2015, eq. (18)."""
        return self.friction / .4 * numpy.log(y / self.roughness)


def held_fixed(scene):
    """The scene with its grains replaced by a wall of the same rows, as rough as grains are to the air."""
    wall = {"kind": "wall"}
    if scene["phases"]["air"].get("turbulence", "none") != "none":
        wall["roughness"] = scene["phases"]["sand"].get("roughness", scene["spacing"] / 30)
    scene["phases"]["sand"] = wall
    entries = {k: v for k, v in scene["interactions"].items() if "sand" not in k.split("-")}
    coupling = scene["interactions"].get("air-sand", scene["interactions"].get("sand-air"))
    if isinstance(coupling, dict):
        coupling = {k: v for k, v in coupling.items() if k in ("radius", "kernel")}
    scene["interactions"] = {**entries, "air-sand": coupling, "air-floor": coupling}  # no wall may be there for nobody
    return scene


def speed(frames, wind, middle, width, y, ground=None):
    """Mean u at the height y (from y = 0), over x within width/2 of the middle (periodic): a straight line in y through the air
    within a spacing of it, all frames together."""
    heights, u = [], []
    for f in frames:
        x = f.x[:, 0] - middle
        x -= wind.size[0] * numpy.round(x / wind.size[0])
        over = f.x[:, 1] - (ground(f.x[:, 0]) if ground else 0)
        near = (abs(x) <= width / 2) & (abs(over - y) < wind.dx)
        heights.append(over[near] - y)
        u.append(f["velocity"][near, 0])
    heights, u = numpy.concatenate(heights), numpy.concatenate(u)
    if len(u) < 3:
        return math.nan
    return numpy.polyfit(heights, u, 1)[1]


def only(frame, phase):
    """The particles of one phase of a frame."""
    part = object.__new__(type(frame))
    keep = frame["phase"] == frame.names.index(phase)
    part.time, part.names, part.x = frame.time, frame.names, frame.x[keep]
    part.arrays = {k: v[keep] for k, v in frame.arrays.items()}
    return part


def profile(name, scheme, wind, frames, history, middle, width, seconds):
    """The profile and the bulk speed over the second half of the run."""
    errors = {}
    for y in HEIGHTS:
        got, exact = speed(frames, wind, middle, width, wind.bed + y), wind.law(y)
        errors[y] = got / exact - 1
        tell(name, scheme, "", f"u at {1e3 * y:g} mm over the bed, m/s", f"{got:.2f}", f"{exact:.2f}", seconds)
    worst = max(errors, key=lambda y: abs(errors[y]) if errors[y] == errors[y] else math.inf)
    report(name, scheme, "", f"profile against its u*, largest error, at {1e3 * worst:g} mm", abs(errors[worst]), .1, seconds)
    t, bulk = history["time [s]"], history["air_mean_vx [m/s]"]
    late = bulk[t > .5 * wind.end]
    report(name, scheme, "", "bulk speed/that of the start, largest error in the second half", abs(late / bulk[0] - 1).max(), .01, seconds)
    if "air_held_acceleration_x [m/s2]" in history:  # of all the air; what holds the wind up is what bed and grains take off it
        push = history["air_held_acceleration_x [m/s2]"][t > .5 * wind.end].mean()
        stress = push * len(frames[0].x) * wind.density * wind.dx**2 / wind.size[0]
        tell(name, scheme, "", "stress that bed and grains take off the wind/(rho u*2), second half",
             f"{stress / (wind.density * wind.friction**2):.2f}", "1 over the bed at rest", seconds)


def flat_bed():
    """The flat bed with every grain held."""
    wind, name, scheme = Wind(document("paper/flat_bed")), "flat bed held fixed", document("paper/flat_bed")["phases"]["air"].get("scheme", "consistent")

    def case():
        frames, (history,), seconds = run(toml(held_fixed(document("paper/flat_bed"))), ["output.every=5e-4", "output.walls=false"], "air",
                                          keep=lambda t: t > .5 * wind.end, also=("history.csv",))
        profile(name, scheme, wind, frames, history, 0, wind.size[0], seconds)
    attempt(name, scheme, "", case)


def slow_ground(frame, wind):
    """Top of the sand by columns of a spacing, of the grains too slow to rise by their own diameter."""
    sand = only(frame, "sand")
    rest = numpy.linalg.norm(sand["velocity"], axis=1) < math.sqrt(2 * 9.81 * wind.dx)
    columns = round(wind.size[0] / wind.dx)
    top = numpy.zeros(columns)
    numpy.maximum.at(top, (sand.x[rest, 0] / wind.dx).astype(int) % columns, sand.x[rest, 1] + .5 * wind.dx)
    top = numpy.max([numpy.roll(top, k) for k in (-1, 0, 1)], axis=0)
    return lambda x: top[(x / wind.dx).astype(int) % columns]


def dune():
    """Upstream profile, speed-up at the crest, lee, and what the grains take, over the second half of paper/dune.toml."""
    scene = document("paper/dune")
    wind, name, scheme = Wind(scene), "dune", scene["phases"]["air"].get("scheme", "consistent")
    height, length, at = (wind.dune[k] for k in ("height", "length", "at"))
    toe, half_width = at - length / 2, length / 4  # a cosine has half its height a quarter of its length from the crest

    def case():
        everything, (history,), seconds = run("paper/dune", ["output.every=1e-3", "output.walls=false"], keep=lambda t: t > .5 * wind.end or t == 0,
                                              also=("history.csv",))
        late = everything[1:]
        air = [only(f, "air") for f in late]
        upstream = toe - .03
        profile(f"{name}, 3 cm upstream of the toe", scheme, wind, air, history, upstream, .01, seconds)
        grounds = [slow_ground(f, wind) for f in late]

        def over(x, width, z):
            return numpy.nanmean([speed([a], wind, x, width, z, g) for a, g in zip(air, grounds)])
        for z in (1e-3, 2e-3, 4e-3):
            up = over(upstream, .01, z)
            tell(name, scheme, "", f"speed-up at the crest, {1e3 * z:g} mm over the ground", f"{over(at, .003, z) / up - 1:+.2f}",
                 f"2 H/L = {2 * height / half_width:.2f}", seconds)
        places = at + numpy.arange(0, 3 * length, .002)
        lee = numpy.array([over(x, .004, 1e-3) for x in places])
        low = int(numpy.nanargmin(lee))
        back = places[lee < 0] - at
        tell(name, scheme, "", "least speed behind the crest, 1 mm over the ground, over upstream",
             f"{lee[low] / over(upstream, .01, 1e-3):+.2f} at {(places[low] - at) / height:.1f} H",
             f"reversed {back[0] / height:.1f} to {back[-1] / height:.1f} H" if len(back) else "nowhere reversed", seconds)
        grains(name, scheme, wind, everything, seconds)
    attempt(name, scheme, "", case)


def grains(name, scheme, wind, frames, seconds):
    """How many grains fly, and the stress that they take off the wind: the growth of their momentum by area of ground and time, which
    the bed's friction has already lowered, over rho u*^2."""
    first, last = only(frames[0], "sand"), only(frames[-1], "sand")
    flying = numpy.mean([(only(f, "sand").x[:, 1] > first.x[:, 1].max() + wind.dx).sum() for f in frames[1:]])
    tell(name, scheme, "", "grains higher than the crest of the start, mean", f"{flying:.1f} of {len(last.x)}", "", seconds)
    start, end = first["velocity"][:, 0].sum(), last["velocity"][:, 0].sum()
    mass = document("paper/dune")["phases"]["sand"]["density"] * wind.dx**2
    stress = mass * (end - start) / (wind.size[0] * (frames[-1].time - frames[0].time))
    tell(name, scheme, "", "momentum that grains hold at the end/(rho u*2 L t)", f"{stress / (wind.density * wind.friction**2):.2f}", "", seconds)


CASES = {
    "wind": (lambda: [flat_bed(), dune()], "The wind of paper/flat_bed.toml (bed held fixed) and paper/dune.toml, second half of the run"),
}
