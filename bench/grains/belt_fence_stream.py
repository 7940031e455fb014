#!/usr/bin/python3
"""Figures of three scenes: hopper_belt.toml, fence_tunnel.toml and water_over_sand.toml.

    /usr/bin/python3 bench/grains/belt_fence_stream.py build/barchan [belt] [fence] [stream] --out /tmp/three    runs them, writes bench/grains/results/belt_fence_stream.csv
    /usr/bin/python3 bench/grains/belt_fence_stream.py none belt --out out                                       measures a run that is there, in out/hopper_belt

Each with what is known: the rate of a slot (Beverloo et al. 1961, for a slot Nedderman 1992), the height of a layer on a belt (mass that passes), the flow behind a fence,
the bedload of Wong & Parker 2006. An error is that of the mean of blocks of a tenth of the time measured.
"""
import argparse
import json
import math
import pathlib
import sys
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402

RESULT = pathlib.Path(__file__).resolve().parent / "results/belt_fence_stream.csv"
NAMES = {"belt": "hopper_belt", "fence": "fence_tunnel", "stream": "water_over_sand"}
G = 9.81


def scene_of(name):
    return tomllib.loads((ROOT / f"scenes/{NAMES[name]}.toml").read_text())


def frames(folder, begin, end):
    return [(time, path) for time, path in series(next(folder.glob("*.pvd"))) if begin <= time <= end + 1e-9]


def masses(sand, phase):
    """kg by metre of the slab's depth."""
    return phase.get("density", 2650.0) * math.pi / 6 * (2 * sand["radius"]) ** 3 / phase["diameter"]["mean"]


def mean(values):
    """Mean, and its error from ten blocks."""
    blocks = [b.mean() for b in np.array_split(np.asarray(values), 10)]
    return [float(np.mean(values)), float(np.std(blocks, ddof=1) / math.sqrt(len(blocks)))]


# --- a hopper over a belt ---------------------------------------------------------------------------------------------

SLOT, FLOOR, TOP_OF_BELT, SPEED = 0.014, 0.030, 0.001, 0.5  # m, m, m, m/s
DRAINING, STEADY = (0.2, 0.9), (0.65, 0.9)                  # s: the slot is measured, the layer is measured
LAYER, BIN = (0.11, 0.20), 0.002                            # m, along x
BULK = ((0.015, 0.045), (0.065, 0.065))                     # m: lower and upper corner of the box in which the bulk density is measured, until its sand sinks below 75 mm
C, K = 1.03, 1.4                                            # of a slot, Nedderman 1992; of round grains, Beverloo et al. 1961


def belt(folder):
    phase = scene_of("belt")["phases"]["sand"]
    d = phase["diameter"]["mean"]
    times, inside, heights, loads, speeds = [], [], [], [], []
    bulks = []
    for time, path in frames(folder, 0, STEADY[1]):
        sand = Frame(path, phase="sand")
        m, x, y = masses(sand, phase), sand.x[:, 0], sand.x[:, 1]
        times.append(time)
        inside.append(m[y > FLOOR].sum())
        if DRAINING[0] - 1e-9 <= time <= 0.65:
            (left, low), (right, high) = BULK
            bulks.append(m[(x > left) & (x < right) & (y > low) & (y < high)].sum() / (right - left) / (high - low))
        if time >= STEADY[0] - 1e-9:
            on = (x > LAYER[0]) & (x < LAYER[1]) & (y < FLOOR)
            tops = [(y + sand["radius"])[on & (x >= left) & (x < left + BIN)].max(initial=TOP_OF_BELT) for left in np.arange(*LAYER, BIN)]
            heights.append(np.mean(tops) - TOP_OF_BELT)
            loads.append(m[on].sum() / (LAYER[1] - LAYER[0]))
            speeds.append(np.average(sand["velocity"][on, 0], weights=m[on]))
    times, inside, bulk = np.array(times), np.array(inside), float(np.mean(bulks))
    chosen = (times >= DRAINING[0] - 1e-9) & (times <= DRAINING[1] + 1e-9)
    rate = -float(np.polyfit(times[chosen], inside[chosen], 1)[0])
    halves = [-float(np.polyfit(t, m, 1)[0]) for t, m in zip(np.array_split(times[chosen], 2), np.array_split(inside[chosen], 2))]
    history = table(folder / "history.csv")
    late = (history["time"] >= STEADY[0]) & (history["time"] <= STEADY[1])
    left = float(np.polyfit(history["time"][late], history["sand_right_out"][late], 1)[0])
    beverloo = C * bulk * math.sqrt(G) * (SLOT - K * d) ** 1.5
    return {"bulk_density_in_the_hopper_kg_m3": bulk, "rate_kg_m_s": rate, "rate_in_halves": halves, "beverloo_kg_m_s": beverloo, "rate_over_beverloo": rate / beverloo,
            "height_m": float(np.mean(heights)), "height_expected_m": rate / bulk / SPEED, "height_over_expected": float(np.mean(heights)) / (rate / bulk / SPEED),
            "load_kg_m2": float(np.mean(loads)), "load_expected_kg_m2": rate / SPEED, "bulk_density_on_the_belt_kg_m3": float(np.mean(loads) / np.mean(heights)),
            "speed_of_layer_m_s": float(np.mean(speeds)), "leaves_kg_m_s": left, "force_x_N_m": mean(history["belt_force_x"][late]), "force_x_expected_N_m": -rate * SPEED,
            "mass_balance": float((inside[0] - inside[-1] - (masses(Frame(path, phase="sand"), phase)[Frame(path, phase="sand").x[:, 1] <= FLOOR].sum())
                                   - history["sand_right_out"][-1]) / inside[0])}


# --- a fence in a wind tunnel -----------------------------------------------------------------------------------------

FENCE, BACK, HEIGHT, GROUND = 0.12, 0.136, 0.024, 0.0065  # m
WIND, CELL = (0.1, 0.2), 0.008                            # s, m


def fence(folder):
    scene = scene_of("fence")
    air, sands = [], []
    chosen = frames(folder, *WIND)
    for _, path in chosen:
        for name in ("air", "above"):
            part = Frame(path, phase=name)
            air.append(np.column_stack([part.x[:, :2], part["velocity"][:, :2]]))
    air = np.concatenate(air)
    sand = Frame(chosen[-1][1], phase="sand")
    m = masses(sand, scene["phases"]["sand"])

    def speed(x, height, reach=CELL):
        near = (np.abs(air[:, 0] - x) < reach) & (np.abs(air[:, 1] - GROUND - height) < CELL / 2)
        return float(air[near, 2].mean()) if near.any() else math.nan

    places = np.arange(BACK + CELL / 2, scene["domain"]["size"][0], CELL)
    low = np.array([speed(x, CELL / 2, CELL / 2) for x in places])
    back = np.nonzero(low < 0)[0]
    before = np.arange(CELL / 2, FENCE, CELL)
    lower = np.array([speed(x, CELL / 2, CELL / 2) for x in before])
    front = np.nonzero(lower < 0)[0]
    upstream = {h: speed(FENCE - 3 * HEIGHT, h * HEIGHT) for h in (0.5, 1.0)}
    at_rest = np.hypot(*sand["velocity"][:, :2].T) < 0.02
    x = sand.x[:, 0]
    zones = {"before": x < FENCE - 4 * HEIGHT, "4_H_before": (x >= FENCE - 4 * HEIGHT) & (x < FENCE), "0_to_4_H_behind": (x >= BACK) & (x < BACK + 4 * HEIGHT),
             "4_to_8_H_behind": (x >= BACK + 4 * HEIGHT) & (x < BACK + 8 * HEIGHT), "farther": x >= BACK + 8 * HEIGHT}
    history = table(folder / "history.csv")
    late = (history["time"] >= WIND[0]) & (history["time"] <= WIND[1])

    def rate(name):
        return float(np.ptp(history[name][late]) / np.ptp(history["time"][late]))

    return {"reverse_length_over_H": float((places[back[-1]] + CELL / 2 - BACK) / HEIGHT) if len(back) else 0.0, "slowest_m_s": float(low.min()),
            "reverse_before_over_H": float((FENCE - before[front[0]] + CELL / 2) / HEIGHT) if len(front) else 0.0,
            "speed_over_upstream": {f"{h} H high": {f"{n} H behind": speed(BACK + n * HEIGHT, h * HEIGHT) / upstream[h] for n in (2, 4, 6, 8, 10, 12, 13)} for h in upstream},
            "entered_kg_m_s": rate("sand_left_in"), "left_kg_m_s": rate("sand_right_out"), "left_backwards_kg_m_s": rate("sand_left_out"),
            "at_rest_g_m": {k: float(1e3 * m[z & at_rest].sum()) for k, z in zones.items()}, "in_flight_g_m": {k: float(1e3 * m[z & ~at_rest].sum()) for k, z in zones.items()},
            "passed_the_fence_g_m": float(1e3 * (m[x > BACK].sum() + history["sand_right_out"][-1])), "entered_g_m": float(1e3 * history["sand_left_in"][-1]),
            "largest_density_error": float(history["largest_density_error"].max())}


# --- water over sand --------------------------------------------------------------------------------------------------

CALM = 1.0  # s: measured from then on


def meyer_peter(shields):
    """Meyer-Peter & Mueller 1948."""
    return 8 * max(shields - 0.047, 0.0) ** 1.5


def wong_parker(shields):
    """Their data again: Wong & Parker 2006, eq. (24)."""
    return 3.97 * max(shields - 0.0495, 0.0) ** 1.5


def stream(folder):
    scene = scene_of("stream")
    water, sand = scene["phases"]["water"], scene["phases"]["sand"]
    d, ratio = sand["diameter"]["mean"], sand["density"] / water["density"]
    u = scene["constants"]["u"]
    heavy = (ratio - 1) * G * d                                 # m2/s2
    unit = sand["density"] * math.sqrt((ratio - 1) * G * d**3)  # kg/m/s
    history = table(folder / "history.csv")
    late = history["time"] >= CALM
    flux, stress = mean(history["sand_flux"][late]), mean(history["water-sand_ground_stress"][late])
    measured = stress[0] / water["density"] / heavy

    def rate(name):
        return float(np.ptp(history[name][late]) / np.ptp(history["time"][late]))

    return {"friction_velocity_m_s": u, "shields_of_the_stream": u**2 / heavy, "shields": measured, "ground_stress_Pa": stress,
            "flux_kg_m_s": flux, "flux_dimensionless": [f / unit for f in flux], "wong_parker": wong_parker(measured), "meyer_peter": meyer_peter(measured),
            "over_wong_parker": flux[0] / unit / wong_parker(measured), "over_meyer_peter": flux[0] / unit / meyer_peter(measured),
            "enters_kg_m_s": rate("sand_left_in"), "leaves_kg_m_s": rate("sand_right_out"), "bed_m": [float(history["sand_bed"][late][k]) for k in (0, -1)],
            "time_s": [CALM, float(history["time"][-1])], "mean_speed_of_the_water_m_s": mean(history["water_mean_vx"][late]),
            "largest_density_error": float(history["largest_density_error"].max())}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("barchan")
    parser.add_argument("scenes", nargs="*", choices=[*NAMES, []])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/belt_fence_stream"))
    options = parser.parse_args()
    results = store.load(RESULT, {})
    for name in options.scenes or NAMES:
        folder = options.out / NAMES[name]
        if options.barchan != "none":
            run.scene(options.barchan, ROOT / f"scenes/{NAMES[name]}.toml", folder, threads=1, check=True)
        results[name] = {"belt": belt, "fence": fence, "stream": stream}[name](folder)
        print(name, json.dumps(results[name], indent=1))
    store.keep(RESULT, results)


if __name__ == "__main__":
    main()
