"""Dams whose water runs far, and water that stays at rest or swings for long: measurements of the front and of the pressure; rest."""

import math

import numpy

from cases_surface import COLUMN, SCHEMES, damped_cosine, front, wave_amplitude
from harness import attempt, document, options, report, run, tell, toml

GRAVITY = 9.81
BOTH = {name: SCHEMES[name] for name in ("consistent", "plain, radius 3.0")}


def both(name, n, case, wall="tank"):
    for scheme, overrides in BOTH.items():
        attempt(name, scheme, n, lambda: case(scheme, [o.format("water", wall) for o in overrides]))


# ---- the front of a dam, far --------------------------------------------------------------------------------------------

# Martin & Moyce 1952, a = 2.25 in, T = n t sqrt(g/a), Z = z/a. n^2 = 1: as Xie 2021 (arXiv:2108.08769, figure 7) shows the points, read from that figure within
# 0.05 in T and 0.02 in Z. n^2 = 2: their figure 3, as the tables of PySPH have it (pysph/examples/db_exp_data.py).
FAR = {1: ((3.90, 6), (4.49, 7), (5.17, 8), (5.91, 9), (6.74, 10), (7.72, 11), (8.58, 12), (9.53, 13)),
       2: ((1.997, 2.292), (2.547, 2.995), (3.345, 4.134), (4.034, 4.944), (4.418, 5.881), (5.091, 6.980), (5.685, 7.945), (6.306, 8.966),
           (6.822, 9.986), (7.439, 10.963), (8.031, 11.977), (8.633, 13.005), (9.237, 13.970))}
# The water's height at the closed end over a n^2, n^2 = 1, the same figure.
HEIGHTS = ((.80, .89), (1.29, .78), (1.74, .67), (2.15, .56), (2.57, .44), (3.08, .33), (4.27, .22), (6.30, .11))


def far_front(ratio, n):
    """The front of a column a wide and ratio a high in a tank of 16 a, and for ratio = 1 the height at the closed end."""
    dx, a = COLUMN / n, COLUMN
    sound = 20 * math.sqrt(GRAVITY * ratio * a)
    scale = math.sqrt(ratio * GRAVITY / a)
    scene = [f"spacing={dx!r}", f"domain.size=[{16 * a!r}, {4 * a!r}]", f"fill.1.shape.box.max=[{a!r}, {ratio * a!r}]", f"phases.water.sound-speed={sound!r}",
             f"time.end={(FAR[ratio][-1][0] + .2) / scale!r}", f"output.every={.05 / scale!r}", f"probe.0.at=[{15.9 * a!r}, 0.0057]"]
    name = f"front of a dam, n^2 = {ratio}"

    def case(scheme, overrides):
        frames, seconds = run("dam_break", scene + overrides, "water")
        t = numpy.array([f.time for f in frames]) * scale
        z = numpy.array([front(f, dx) for f in frames]) / a
        times, places = numpy.array(FAR[ratio]).T
        error = numpy.interp(times, t, z) / places - 1
        report(name, scheme, n, f"front against {len(times)} measured places, {error[0]:+.3f} at the first, {error[-1]:+.3f} at the last: largest error",
               abs(error).max(), .05, seconds)
        speed = lambda x: numpy.polyfit(times, x, 1)[0]
        report(name, scheme, n, "speed of the front over these places/measured, error", abs(speed(numpy.interp(times, t, z)) / speed(places) - 1), .05, seconds)
        if ratio == 1:
            high = numpy.array([f.x[f.x[:, 0] < 2 * dx, 1].max(initial=0) + .5 * dx for f in frames]) / a
            times, heights = numpy.array(HEIGHTS).T
            report(name, scheme, n, "height at the closed end against 8 measured ones, largest difference/a", abs(numpy.interp(times, t, high) - heights).max(),
                   .05, seconds)
    both(name, n, case)


# ---- the pressure of a dam on a wall ------------------------------------------------------------------------------------

# Buchner 2002 (thesis, Delft), 0.6 m of water 1.2 m long, in a tank of 3.22 m; a sensor of 90 mm, its middle 0.16 m above the floor. p/(rho g H) against
# t sqrt(g/H), every few points of the record that TrixiParticles.jl keeps (validation/dam_break_2d/exp_pressure_sensor_P1.csv).
PRESSURE = ((2.025, 0), (2.43, 0), (2.491, .154), (2.616, .371), (2.650, .562), (2.689, .662), (2.774, .687), (2.903, .661), (3.022, .643), (3.132, .579),
            (3.368, .541), (3.679, .541), (4.060, .556), (4.453, .551), (4.720, .538), (4.917, .513), (5.159, .514), (5.304, .526), (5.445, .549),
            (5.586, .588), (5.692, .634), (5.781, .675), (5.806, .716), (5.833, .877), (5.882, .798), (5.921, .724), (5.968, .648), (6.051, .579),
            (6.150, .543), (6.315, .606), (6.411, .519), (6.561, .468), (6.742, .539), (6.880, .417), (7.001, .438), (7.110, .493), (7.299, .416))
H = .6  # m
SENSORS = {"sensor": .115, "lower": .07}  # m, the lower edge


def dam_scene(n, far, scheme):
    """Buchner's dam: the column of dam_break.toml, its size and its tank changed, and the force on the wall behind the sensor at each place."""
    scene = document("dam_break")
    scene["spacing"] = H / n
    scene["domain"]["size"] = [far, 2.4]
    scene["phases"]["water"] |= {"sound-speed": 20 * math.sqrt(GRAVITY * H)} | ({} if scheme == "consistent" else {"scheme": "plain"})
    if scheme != "consistent":
        scene["interactions"] |= {"water-water": 3., "water-tank": 3.}
    scene["fill"][1]["shape"]["box"]["max"] = [2 * H, H]
    del scene["probe"]
    scale = math.sqrt(GRAVITY / H)
    scene["time"] = {"end": 7.4 / scale, "largest-speed": 5}
    scene["output"] = {"every": .1 / scale, "history-every": .005 / scale, "walls": False}
    sensors = (f'[[force]]\nname = "{name}"\nphase = "tank"\nbox = {{ min = [{far!r}, {low}], max = [{far + 4 * H / n!r}, {low + .09}] }}\n'
               for name, low in SENSORS.items())
    return toml(scene) + "".join(sensors)


def impulse(x, y, a, b):
    """The integral of y from a to b."""
    return numpy.trapz(numpy.interp(numpy.linspace(a, b, 2001), x, y), numpy.linspace(a, b, 2001))


def report_pressure(name, scheme, n, t, p, seconds):
    """Impulse, plateau, first and second peak of p/(rho g H) by t sqrt(g/H), beside the measured ones."""
    times, measured = numpy.array(PRESSURE).T
    ours, theirs = (impulse(*xy, 2.1, 7.25) for xy in ((t, p), (times, measured)))
    report(name, scheme, n, f"impulse to t sqrt(g/H) = 7.25, {ours:.3f} beside {theirs:.3f}: error", abs(ours / theirs - 1), .1, seconds)
    mean = numpy.convolve(p, numpy.ones(11) / 11, "same")  # over 0.055 sqrt(H/g), 14 ms
    arrival = lambda x, y: x[numpy.argmax(y > .3)]
    tell(name, scheme, n, "t sqrt(g/H) at which the pressure passes 0.3 rho g H", f"{arrival(t, mean):.2f}", f"{arrival(times, measured):.2f}", seconds)
    tell(name, scheme, n, "first peak/(rho g H), mean over 14 ms", f"{mean[t < 3.3].max():.3f}", ".687", seconds)
    level = lambda x, y: impulse(x, y, 3.4, 5) / 1.6
    report(name, scheme, n, f"pressure from 3.4 to 5, {level(t, mean):.3f} beside {level(times, measured):.3f}: error",
           abs(level(t, mean) / level(times, measured) - 1), .1, seconds)
    second = t > 5.2
    at = t[second][numpy.argmax(mean[second])]
    tell(name, scheme, n, "second impact: peak/(rho g H) and its t sqrt(g/H)", f"{mean[second].max():.3f} at {at:.2f}", ".877 at 5.83", seconds)


def dam_pressure(n):
    """Pressure on the sensor at the place that is told, and with its upper edge where its middle was (so Greco 2001, Adami et al. 2012)."""
    dx, far = H / n, 5.366 * H

    def case(scheme, _):
        (history,), seconds = run(dam_scene(n, far, scheme), [], "water", files=("history.csv",))
        t = history["time [s]"] * math.sqrt(GRAVITY / H)
        for sensor, low in SENSORS.items():
            rows = sum(low < (j + .5) * dx < low + .09 for j in range(n))
            p = history[f"{sensor}_force_x"] / (rows * dx) / (1000 * GRAVITY * H)
            report_pressure(f"pressure of a dam, middle of the sensor {low + .045:g} m high", scheme, n, t, p, seconds)
    both("pressure of a dam", n, case)


# Lobovsky et al. 2014, J. Fluids Struct. 48, 407: 0.3 m of water, 0.6 m long, in a tank of 1.61 m; sensors of 4.2 mm on the far wall. Table 2: the largest
# pressure of each of 100 runs in mbar, by the height of the sensor's middle (mm): median, 2.5 % and 97.5 % of the runs.
PEAKS = {3: (91.44, 75.06, 130.98), 15: (57.49, 53.26, 63.31), 30: (43.76, 39.79, 49.62), 80: (30.15, 24.18, 36.32)}
# The record of the sensor at 30 mm, t sqrt(g/H) against p/(rho g H), every few points of what PySPH keeps (pysph/examples/db_exp_data.py).
RECORD = ((2.461, .006), (2.516, .083), (2.538, .395), (2.564, .778), (2.592, 1.092), (2.624, 1.372), (2.671, 1.495), (2.774, 1.518), (2.848, 1.480),
          (2.937, 1.306), (3.039, 1.131), (3.119, .962), (3.193, .779), (3.342, .625), (3.548, .572), (3.753, .592), (4.008, .564), (4.250, .564), (4.509, .605),
          (4.713, .568), (5.021, .591), (5.329, .576), (5.636, .623), (5.824, .687), (5.932, .874), (6.025, .796), (6.158, .896), (6.300, .805), (6.508, .798),
          (6.684, .710), (6.814, .710), (6.966, .649))
PLATEAU = 3.5, 5.6  # t sqrt(g/H), between the two impacts
COLUMN_PRESSURE = 997 * GRAVITY * .3  # Pa, rho g H of the experiment


def sensors_scene(n, scheme, seed):
    """dam_gate.toml with n spacings over the depth, disturbed, up to the second impact, and the force on the far wall behind each sensor."""
    scene, dx = document("dam_gate"), .3 / n
    length = dx * round(1.61 / dx)
    scene["spacing"], scene["domain"]["size"] = dx, [length, .6]
    scene["fill"][1]["shape"]["box"]["max"] = [.6 + 5 * dx, .45]
    scene["fill"][2] |= {"perturb": .1, "seed": seed}
    if scheme != "consistent":
        scene["phases"]["water"]["scheme"] = "plain"
        scene["interactions"] |= {"water-water": 3., "water-tank": 3., "water-gate": 3.}
    scene["force"] = []
    rows = {}
    for z in PEAKS:
        inside = [j for j in range(n) if abs((j + .5) * dx - 1e-3 * z) < max(dx, 2.1e-3)]
        low, high = inside[0] * dx, (inside[-1] + 1) * dx
        rows[z] = high - low
        scene["force"].append({"name": f"at{z}", "phase": "tank", "box": {"min": [length, low], "max": [length + 4 * dx, high]}})
    scene["time"] = {"end": 1.25, "largest-speed": 4.5}
    scene["output"] = {"every": .5, "history-every": 2.5e-4, "walls": False}
    return toml(scene), rows


def dam_sensors(n):
    """Five runs that differ by their disturbance: impulse and plateau at 30 mm; told: the largest pressure at each sensor."""
    def case(scheme, _):
        runs = []
        for seed in range(1, 6):
            scene, rows = sensors_scene(n, scheme, seed)
            (h,), seconds = run(scene, [], "water", files=("history.csv",))
            runs.append((h["time [s]"] * math.sqrt(GRAVITY / .3), {z: h[f"at{z}_force_x"] / high / (1000 * GRAVITY * .3) for z, high in rows.items()}))
        name = "dam, sensors of Lobovsky et al."
        for z, measured in PEAKS.items():
            middle, low, high = (100 * m / COLUMN_PRESSURE for m in measured)
            peaks = sorted(p[z].max() for _, p in runs)
            tell(name, scheme, n, f"{z} mm: largest pressure/(rho g H), median of five runs", f"{peaks[2]:.2f} ({peaks[0]:.2f} to {peaks[-1]:.2f})",
                 f"{middle:.2f} ({low:.2f} to {high:.2f} of 100 runs)", seconds)
        times, measured = numpy.array(RECORD).T
        impulses = sorted(impulse(t, p[30], 2.4, 6.9) for t, p in runs)
        report(name, scheme, n, f"30 mm: impulse of t sqrt(g/H) = 2.4 to 6.9, median {impulses[2]:.2f} ({impulses[0]:.2f} to {impulses[-1]:.2f}), beside "
               f"{impulse(times, measured, 2.461, 6.9):.2f}: error", abs(impulses[2] / impulse(times, measured, 2.461, 6.9) - 1), .1, seconds)
        levels = sorted(impulse(t, p[30], *PLATEAU) / (PLATEAU[1] - PLATEAU[0]) for t, p in runs)
        level = impulse(times, measured, *PLATEAU) / (PLATEAU[1] - PLATEAU[0])
        report(name, scheme, n, f"30 mm: pressure/(rho g H) from t sqrt(g/H) = {PLATEAU[0]} to {PLATEAU[1]}, median {levels[2]:.3f} ({levels[0]:.3f} to {levels[-1]:.3f}), beside "
               f"{level:.3f}: error", abs(levels[2] / level - 1), .1, seconds)
        arrivals = sorted(t[numpy.argmax(p[30] > .3)] for t, p in runs)
        tell(name, scheme, n, "30 mm: t sqrt(g/H) at which the pressure passes 0.3 rho g H, from the gate's start", f"{arrivals[2]:.2f}", "2.53", seconds)
        second = sorted(p[30][t > 5.2].max() for t, p in runs)
        tell(name, scheme, n, "30 mm: second peak/(rho g H)", f"{second[2]:.2f} ({second[0]:.2f} to {second[-1]:.2f})", ".90", seconds)
    both("dam, sensors of Lobovsky et al.", n, case)


# ---- rest and waves, for long -------------------------------------------------------------------------------------------

def long_rest(dimensions, n):
    """1000 crossings of sound: the largest speed, whether it falls, the volume; on rows and disturbed."""
    name = f"still tank, {dimensions}D, 1000 crossings"
    scene = document("still_tank")
    scene["spacing"] = 1 / n
    if dimensions == 3:
        scene["dimensions"], scene["domain"] = 3, {"size": [.5, 1.5, .5], "gravity": [0, -GRAVITY, 0]}
        scene["fill"][0]["shape"]["sides"] += ["front", "back"]
        scene["fill"][1]["shape"]["box"] = {"min": [0, 0, 0], "max": [.5, 1, .5]}
    scene["time"]["end"] = 1000 / 62.6
    scene["output"] = {"every": 20 / 62.6, "history-every": .25 / 62.6, "walls": False}

    def case(scheme, overrides):
        for start, disturbed, bound in (("rows", 0, 1e-5), ("disturbed by 0.1 spacings", .1, 1e-3)):
            scene["fill"][1]["perturb"] = disturbed
            frames, (history,), seconds = run(toml(scene), overrides, "water", also=("history.csv",))
            t, speed = history["time [s]"] * 62.6, history["water_largest_speed [m/s]"] / math.sqrt(GRAVITY)
            last, before = speed[t > 900].max(), speed[(t > 450) & (t < 550)].max()
            label = f"{scheme}, {start}"
            report(name, label, n, "largest speed/sqrt(gH) in the last 100 crossings", last, bound, seconds)
            report(name, label, n, "the same over that of crossings 450 to 550", last / before, 1, seconds)
            report(name, label, n, "largest speed/sqrt(gH) at any time", speed.max(), None, seconds)
            volume = frames[-1].x[:, 1].mean() / frames[0].x[:, 1].mean() - 1
            report(name, label, n, f"volume (height of the centre of mass) {volume:+.5f}, size of the change", abs(volume), 1e-3, seconds)

    for scheme in BOTH:
        changes = ["phases.water.scheme=plain", "interactions.water-water=3.0", "interactions.water-tank=3.0"] if scheme != "consistent" else []
        attempt(name, scheme, n, lambda: case(scheme, changes))


LOSS = {25: .01, 50: .002, 100: .0005}


def long_wave(n):
    """The standing wave over 30 periods: frequency and loss."""
    def case(scheme, overrides):
        name = "standing wave, 30 periods"
        frames, seconds = run("standing_wave", [f"spacing={1 / n!r}", "time.end=34.02"] + overrides, "water")
        t, a = numpy.array([f.time for f in frames]), numpy.array([wave_amplitude(f, math.pi) for f in frames])
        omega, gamma = damped_cosine(t, a)
        exact = math.sqrt(GRAVITY * math.pi * math.tanh(math.pi))
        report(name, scheme, n, "frequency, error/sqrt(g k tanh kH)", abs(omega / exact - 1), .003, seconds)
        loss = 1 - math.exp(-gamma * 2 * math.pi / exact)
        report(name, scheme, n, f"amplitude that a period takes {loss:+.5f}, size", abs(loss), LOSS[n], seconds)
        swing = lambda of: math.sqrt(2 * (of**2).mean())
        tell(name, scheme, n, "amplitude of the last five periods/that of the first five", f"{swing(a[-100:]) / swing(a[:100]):.4f}", "1", seconds)
    both("standing wave, 30 periods", n, case, "floor")


CASES = {
    "far-front": (lambda: [far_front(ratio, n) for ratio in (1, 2) for n in (20, 40, 80) if n <= options.largest],
                  "The front of a dam, far (Martin & Moyce 1952)"),
    "dam-pressure": (lambda: [dam_pressure(n) for n in (20, 40, 80) if n <= options.largest], "The pressure of a dam on a wall (Buchner 2002)"),
    "dam-sensors": (lambda: [dam_sensors(n) for n in (40, 80) if n <= options.largest], "The pressure of a dam with a gate at four sensors (Lobovsky et al. 2014)"),
    "long-rest": (lambda: [long_rest(2, n) for n in (12, 25, 50)] + [long_rest(3, n) for n in (8, 12, 16)], "Water at rest, 1000 crossings of sound"),
    "long-wave": (lambda: [long_wave(n) for n in (25, 50, 100) if n <= options.largest], "Standing gravity wave, 30 periods"),
}
