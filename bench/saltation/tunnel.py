#!/usr/bin/python3
"""A dune in a wind tunnel (scenes/dune.toml): wind before, over and behind the dune, what drives it, and the flux of sand along x.

    /usr/bin/python3 bench/saltation/tunnel.py build/barchan --out /tmp/tunnel               runs the scene four times, two at once, each with other grains that enter (influx.0.seed);
                                                                                             writes results/tunnel.csv and the pictures docs/gallery/dune_tunnel*.png
    /usr/bin/python3 bench/saltation/tunnel.py none --out /tmp/tunnel --from 0.3 --to 0.6    measures the runs that are there between two times
    /usr/bin/python3 bench/saltation/tunnel.py none --out /tmp/tunnel --draw                 draws the first run that is there, and writes no results

Means of the frames between two times (the last second, if none are given). Wind at a place: mean of the air's particles within 1 cm of it, by height over the ground. u*: slope of
a line through the mean speed over the logarithm of the height, 2 to 10 cm over the bed. Flux: mass by length times speed along the wind of all grains, in parts of 3 cm; its error is that of
the mean of the frames. What drives the air and the sand between x = 5 and 60 cm: the stress of the lid, what the air brings in by momentum and pressure less what it takes out (profiles
"upstream" and "far": sum of rho (mean u^2 + rms^2) + p over the height), and the same of the grains (history.csv, between the open sides); for each metre of length, as u* = sqrt(tau/rho).
Pressure on the dune: the sum of p dh/dx over the ground, p the mean of the first row's particles within 2.5 mm.
"""
import argparse
import concurrent.futures
import math
import pathlib
import sys
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402

SCENE, RESULT = ROOT / "scenes/dune.toml", ROOT / "bench/saltation/results/tunnel.csv"
PICTURE, PLOTS = ROOT / "docs/gallery/dune_tunnel.png", ROOT / "docs/gallery/dune_tunnel_plots.png"
FRICTION_VELOCITY, DENSITY, SATURATED, KAPPA = 0.5, 1.225, 35.0, 0.4  # m/s; kg/m3; g/m/s, Creyssels et al. 2009; -
QUARTZ = 2650.0  # kg/m3, of material = "quartz-sand" (src/scene/materials.cpp)
PART, REACH, RUNS = 0.03, 0.01, 4  # m, of the flux; about a place; of the ensemble
SECTIONS = (0.05, 0.6)  # m, between which the momentum of the air is summed
STRESS = (0.05, 0.1, 0.158, 0.2, 0.24, 0.28, 0.302, 0.33, 0.36, 0.4, 0.45, 0.5, 0.55, 0.6)  # m, where the stress of the ground is told
BORDER = 0.07  # m, above it the air is coarser
TOP = 0.12  # m, of the picture
GROUND_COLOUR, SAND_COLOUR = "#c8a165", "#5a3a12"


class Ground:
    """Height of the bed with its asymmetric dune."""

    def __init__(self, scene):
        shape = next(f["shape"] for f in scene["fill"] if f["phase"] == "ground")
        dune = shape["dune"]
        self.length, self.top = scene["domain"]["size"]
        self.bed, self.crest, self.height_of_dune = shape["bed"], dune["at"], dune["height"]
        self.angle = dune["slip-face-angle"]
        self.lee = self.height_of_dune / math.tan(math.radians(dune["slip-face-angle"]))
        self.windward = dune["length"] - self.lee
        self.toe, self.end = self.crest - self.windward, self.crest + self.lee

    def height(self, x):
        s = np.asarray(x) - self.crest
        side = np.where(s > -self.windward, self.height_of_dune / 2 * (1 + np.cos(np.pi * s / self.windward)), 0)
        return self.bed + np.where(s >= 0, np.where(s < self.lee, self.height_of_dune * (1 - s / self.lee), 0), side)


    def slope(self, x):
        return (self.height(x + 1e-6) - self.height(x - 1e-6)) / 2e-6


class Means:
    """Sums over the frames of a run between two times."""

    def __init__(self, folder, ground, scene, begin, end):
        self.ground, self.spacing = ground, scene["spacing"]
        self.air, self.flux, self.mass, self.pushes, self.fastest = [], [], [], [], 0.0
        self.taken, low, high = [], *SECTIONS
        parts = round(ground.length / PART)
        fluids = [name for name, keys in scene["phases"].items() if keys["kind"] == "fluid"]
        diameter = scene["phases"]["sand"]["diameter"]["mean"]
        density = scene["phases"]["sand"].get("density", QUARTZ)
        frames = [(t, p) for t, p in series(next(folder.glob("*.pvd"))) if begin <= t <= end]
        for _, path in frames:
            airs, self.sand = [Frame(path, phase=name) for name in fluids], Frame(path, phase="sand")
            air = airs[0]
            inside = (air.x[:, 0] > 0) & (air.x[:, 0] < ground.length)
            self.last = air.keep(inside)
            self.whole = np.concatenate([np.column_stack([a.x[:, :2], a["velocity"][:, :2]]) for a in airs])
            self.air.append(self.whole)
            if all("drag_acceleration" in a.arrays for a in airs):
                self.taken.append(sum(-DENSITY * scene["phases"][name].get("spacing", scene["spacing"]) ** 2 * a["drag_acceleration"][(a.x[:, 0] > low) & (a.x[:, 0] < high), 0].sum()
                                      for name, a in zip(fluids, airs)))
            self.pushes.append(push_on_dune(self.last, ground, self.spacing))
            mass = density * math.pi / 6 * (2 * self.sand["radius"]) ** 3 / diameter
            along = {"bins": parts, "range": (0, ground.length)}
            self.flux.append(np.histogram(self.sand.x[:, 0], weights=mass * self.sand["velocity"][:, 0], **along)[0] / PART * 1e3)
            self.mass.append(np.histogram(self.sand.x[:, 0], weights=mass, **along)[0])
            self.fastest = max(self.fastest, float(np.hypot(*self.sand["velocity"][:, :2].T).max()))
        self.frames, self.times = len(frames), (frames[0][0], frames[-1][0])
        self.flux, self.mass, self.air = np.array(self.flux), np.array(self.mass), np.concatenate(self.air)
        self.moments = np.array([t for t, _ in frames])

    def wind(self, x):
        """Heights over the ground (m) and mean speed along the wind (m/s) about a place."""
        near = self.air[np.abs(self.air[:, 0] - x) < REACH]
        height = near[:, 1] - self.ground.height(near[:, 0])
        rows = np.floor(height / self.spacing).astype(int)
        numbers = [r for r in range(rows.max() + 1) if (rows == r).sum() >= 3]
        return np.array([height[rows == r].mean() for r in numbers]), np.array([near[rows == r, 2].mean() for r in numbers])


def push_on_dune(air, ground, spacing):
    """N/m: sum of p dh/dx over cells of 1 mm, p the mean of the first row's particles within 2.5 mm."""
    first = air.x[:, 1] - ground.height(air.x[:, 0]) < spacing * np.hypot(1, ground.slope(air.x[:, 0]))
    order = np.argsort(air.x[first, 0])
    x, p = air.x[first, 0][order], air["pressure"][first][order]
    cells = np.arange(ground.toe, ground.end, 1e-3) + 5e-4
    sums = np.concatenate([[0], np.cumsum(p)])
    low, high = np.searchsorted(x, cells - 2.5e-3), np.searchsorted(x, cells + 2.5e-3)
    return float(((sums[high] - sums[low]) / np.maximum(high - low, 1) * ground.slope(cells)).sum() * 1e-3)


def through(folder, name, border):
    """Momentum and pressure of the air through a section (N/m); the air has coarser particles above the border (m)."""
    return sum(through_part(table(folder / f"profile_{name}{part}.csv"), *ends) for part, ends in (("", (0, border)), ("_above", (border, 1))))


def through_part(profile, low, high):
    known = np.isfinite(profile["velocity_mean_x"]) & (profile["y"] >= low) & (profile["y"] <= high)
    return float(np.trapz((DENSITY * (profile["velocity_mean_x"] ** 2 + profile["velocity_rms_x"] ** 2) + profile["pressure_mean"])[known], profile["y"][known]))


def driven_by(folder, ground, history, chosen):
    """Pa, for each metre of length: lid; momentum and pressure of the air that enters less what leaves; the same of the grains."""
    names = ("upstream", "far")
    places = [float(table(folder / f"profile_{name}.csv")["x"][0]) for name in names]
    grains = sum(sign * np.ptp(history[f"sand_{side}_momentum_x"][chosen]) for sign, side in ((1, "left_in"), (-1, "left_out"), (-1, "right_out")))
    return {"lid": DENSITY * FRICTION_VELOCITY**2, "air": (through(folder, names[0], BORDER) - through(folder, names[1], BORDER)) / (places[1] - places[0]),
            "grains": float(grains / np.ptp(history["time"][chosen]) / ground.length)}


def balance(folder, means, ground):
    """Momentum of the air between two sections, N/m: what drives it, and what it gives, each by name; what is left over, and that over all that drives."""
    low, high = SECTIONS
    wall = table(folder / "wall_shear_ground.csv")
    inside = (wall["x"] > low) & (wall["x"] < high)
    step = wall["x"][1] - wall["x"][0]
    terms = {"lid": DENSITY * FRICTION_VELOCITY**2 * (high - low), "through_the_sections": through(folder, "upstream", BORDER) - through(folder, "far", BORDER),
             "shear_of_the_ground": -float(wall["total_shear_stress_mean"][inside].sum() * step), "pressure_on_the_dune": -float(np.mean(means.pushes)),
             "grains_over_the_layers": -float(np.mean(means.taken))}
    left = sum(terms.values())
    return {"stress_places_m": list(STRESS), "stress_over_rho_u2": [float(np.interp(x, wall["x"], wall["total_shear_stress_mean"])) / (DENSITY * FRICTION_VELOCITY**2) for x in STRESS], "balance_N_m": terms, "balance_left_N_m": left, "balance_left_share": left / sum(v for v in terms.values() if v > 0)}


def wind_that_enters():
    """y (m) and speed (m/s)."""
    profile = table(SCENE.parent / "dune_wind.csv")
    return profile["y"], profile["velocity_x"]


def friction_velocity(height, speed):
    kept = (height > 0.02) & (height < 0.1)
    return float(np.polyfit(np.log(height[kept]), speed[kept], 1)[0] * KAPPA)


def at(wind, height):
    return float(np.interp(height, *wind))


def back(means, ground):
    """The lee near the ground (lowest row): the slowest mean wind, and where it turns forwards for good (m behind the crest)."""
    places = np.arange(ground.crest, ground.length - REACH, 0.01)
    speeds = np.array([means.wind(x)[1][0] for x in places])
    turned = np.nonzero(speeds < 0)[0]
    return float(speeds.min()), float(places[turned[-1]] + 0.005 - ground.crest) if len(turned) else 0.0


def erosion(means, ground):
    """What the dune loses: of its mass by time, and of the flux through its ends; the share of what passes the brink that does not leave the lee."""
    parts = (np.arange(means.flux.shape[1]) + 0.5) * PART
    dune = (parts > ground.toe) & (parts < ground.end + PART)
    flux = means.flux.mean(0) * 1e-3
    first, last = np.nonzero(dune)[0][[0, -1]]
    at = lambda edge: 0.5 * (flux[edge - 1] + flux[edge])  # noqa: E731
    mass = means.mass[:, dune].sum(1)
    brink = np.abs(parts - ground.crest) < PART
    behind = (parts > ground.end + ground.height_of_dune) & (parts < ground.end + 4 * ground.height_of_dune)
    return {"dune_kg_m": float(mass[0]), "dune_loses_kg_m_s": float(-np.polyfit(means.moments, mass, 1)[0]), "flux_out_less_in_kg_m_s": float(at(last + 1) - at(first)),
            "trapped_share": float(1 - flux[behind].mean() / flux[brink].mean())}


def measure(folder, begin, end):
    scene = tomllib.loads(SCENE.read_text())
    ground = Ground(scene)
    means = Means(folder, ground, scene, begin, end)
    entering = wind_that_enters()
    upstream, crest = means.wind(ground.toe - 0.1), means.wind(ground.crest)
    meant = np.interp(upstream[0] + ground.bed, *entering)
    off = upstream[1] / meant - 1
    layers = 1.5 * scene["spacing"]  # m over the ground: where the layers of one-dimensional wind end
    history = table(folder / "history.csv")
    chosen = (history["time"] >= begin) & (history["time"] <= end)
    parts = (np.arange(means.flux.shape[1]) + 0.5) * PART
    flux, error = means.flux.mean(0), means.flux.std(0) / math.sqrt(means.frames)
    before = parts < ground.toe
    reverse, length = back(means, ground)
    speed_up = at(crest, 0.01) / at(upstream, 0.01) - 1
    half = ground.windward / 2
    meant_speed_up = (1 + 2 * ground.height_of_dune / half) * (ground.top - ground.bed) / (ground.top - ground.bed - ground.height_of_dune) - 1
    stress = DENSITY * FRICTION_VELOCITY**2
    drives = driven_by(folder, ground, history, chosen) if abs(begin - scene["profile"][0]["start"]) < 0.01 else None
    return means, ground, {
        "driven_by_Pa": drives, "u_star_of_all_that_drives": math.sqrt(max(sum(drives.values()), 0) / DENSITY) if drives else None,
        "pressure_on_the_dune_N_m": float(np.mean(means.pushes)), "pressure_on_the_dune_over_length_Pa": float(np.mean(means.pushes)) / ground.length,
        "ground_stress_Pa": float(history["air-sand_ground_stress"][chosen].mean()),
        "times_s": means.times, "frames": means.frames, "u_star_upstream": friction_velocity(*upstream),
        "largest_difference_above_one_spacing": float(np.abs(off[1:]).max()),
        "wind_on_the_layers": [layers, at(upstream, layers), float(np.interp(layers + ground.bed, *entering))], "flux_g_m_s": flux.tolist(), "flux_error": error.tolist(), "part_m": PART,
        "flux_upstream": float(flux[before].mean()), "flux_upstream_error": float(means.flux[:, before].mean(1).std() / math.sqrt(means.frames)),
        "entered_g_m_s": float(1e3 * np.ptp(history["sand_left_in"][chosen]) / np.ptp(history["time"][chosen])), "flux_upstream_over_saturated": float(flux[before].mean() / SATURATED),
        "ground_stress_over_rho_u2": float(history["air-sand_ground_stress"][chosen].mean() / stress),
        "speed_up_10_mm": float(speed_up), "speed_up_2H_over_L_and_blockage": float(meant_speed_up), "reverse_m_s": reverse,
        "reverse_length_over_H": length / ground.height_of_dune, **erosion(means, ground), **(balance(folder, means, ground) if drives and (folder / "wall_shear_ground.csv").exists() else {}), "fastest_grain_m_s": means.fastest, "largest_density_error": float(history["largest_density_error"].max())}


def picture(means, ground):
    """The tunnel at one moment: the air as a smooth field, its bubble behind the dune, the sand."""
    plt = page.pyplot()
    from matplotlib.tri import LinearTriInterpolator, Triangulation
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(figsize=(10, 3.2), layout="constrained")
    x, u, spacing = means.whole[:, :2], means.whole[:, 2:], means.spacing
    xs = np.linspace(0, ground.length, 661)
    bed = ground.height(xs)
    rest = np.arange(0, ground.length + spacing, spacing)   # the ground belongs to the field: there the air is at rest
    places, speeds = np.concatenate([x, np.column_stack([rest, ground.height(rest)])]), np.concatenate([u[:, 0], np.zeros(len(rest))])
    ys = np.linspace(0, TOP, 261)
    grid = np.meshgrid(xs, ys)
    field = LinearTriInterpolator(Triangulation(*places.T), speeds)(*grid)
    field = np.ma.masked_where(grid[1] < ground.height(grid[0]), field)
    low, high = min(math.floor(field.min()), -1), math.ceil(speeds.max())
    backward = np.linspace([0.80, 0.36, 0.30], [0.93, 0.69, 0.63], 32 * -low)[:, :3]   # red up to zero: backward air is seen at once
    colours = ListedColormap(np.concatenate([backward, plt.get_cmap("Blues")(np.linspace(0.04, 1, 32 * high))[:, :3]]))
    drawn = axes.pcolormesh(xs * 100, ys * 100, field, cmap=colours, vmin=low, vmax=high, shading="nearest", rasterized=True)
    figure.colorbar(drawn, ax=axes, label="wind along x, m/s", pad=.01, aspect=11, shrink=.8, ticks=range(low - low % 2, high + 1, 2))
    axes.fill_between(xs * 100, bed * 100, 0, color=GROUND_COLOUR, lw=0)
    sand = means.sand
    axes.scatter(sand.x[:, 0] * 100, sand.x[:, 1] * 100, s=2.2, color=SAND_COLOUR, lw=0)
    axes.legend(handles=[Patch(color=colours(16)), Line2D([], [], color=SAND_COLOUR, marker="o", ls=""), Patch(color=GROUND_COLOUR)],
                labels=["backward air", "grains", "fixed sand"], loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)
    axes.set(aspect="equal", xlim=(0, ground.length * 100), ylim=(0, TOP * 100), xlabel="x, cm", ylabel="height, cm")
    figure.savefig(PICTURE, dpi=140)
    plt.close(figure)


def plots(means, ground, result):
    """Flux along x and the wind at four places."""
    plt = page.pyplot()
    plt.rcParams["font.size"] = 12.5
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 8), height_ratios=[1, 1.25])
    parts = (np.arange(len(result["flux_g_m_s"])) + 0.5) * PART
    top.errorbar(parts, result["flux_g_m_s"], result["flux_error"], marker="o")
    top.axhline(SATURATED, color="grey", ls="--", label="saturated at u* = 0.5 m/s, Creyssels et al. 2009")
    xs = np.linspace(0, ground.length, 661)
    top.fill_between(xs, 60 * (ground.height(xs) - ground.bed) / ground.height_of_dune, color="tan", alpha=.3, label="dune, without scale")
    top.set(xlim=(0, ground.length), ylim=(0, 85), xlabel="x, m", ylabel="flux, g/m/s", title=f"means of {means.times[0]:.2f} to {means.times[1]:.2f} s")
    top.legend()
    for name, place in (("10 cm before the toe", ground.toe - .1), ("crest", ground.crest), ("5 cm behind the slip face", ground.end + .05), ("far behind", ground.length - .06)):
        height, speeds = means.wind(place)
        bottom.plot(speeds, height, marker=".", label=f"{name}, x = {place:.2f} m")
    entering = wind_that_enters()
    bottom.plot(entering[1], entering[0] - ground.bed, "k--", label="enters")
    bottom.axvline(0, color="grey", lw=.7)
    bottom.set(yscale="log", ylim=(1e-3, .26), xlabel="mean wind, m/s", ylabel="height over the ground, m")
    bottom.legend(loc="lower center", bbox_to_anchor=(0.47, 1.0), ncols=2, frameon=False)
    figure.tight_layout()
    figure.savefig(PLOTS, dpi=100)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("barchan")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/barchan_tunnel"))
    parser.add_argument("--from", dest="begin", type=float)
    parser.add_argument("--to", dest="end", type=float)
    parser.add_argument("--draw", action="store_true", help="the pictures alone")
    options = parser.parse_args()
    seeds = range(1, RUNS + 1)
    if options.barchan != "none":
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda seed: run.scene(options.barchan, SCENE, options.out / f"seed_{seed}", [f"influx.0.seed={seed}", 'output.fields=["radius", "drag_acceleration"]'], threads=1), seeds))
    runs, shown = [], None
    for folder in (options.out / f"seed_{seed}" for seed in seeds):
        if not (folder / "history.csv").exists():
            continue
        end = options.end or float(table(folder / "history.csv")["time"][-1])
        measured = measure(folder, max(end - 0.5, 0) if options.begin is None else options.begin, end)
        runs.append(measured[2])
        shown = shown or measured
        if options.draw:
            break
    if not options.draw:
        store.keep(RESULT, {"runs": runs})
    picture(*shown[:2])
    plots(*shown)
    for name in runs[0]:
        print(name, *(each[name] if isinstance(each[name], (list, tuple, dict, type(None))) else round(each[name], 4) for each in runs))


if __name__ == "__main__":
    main()
