"""Rigid bodies against exact solutions: cases of bench/impacts/cases.py and their tables on docs/impacts.md."""

import math

import numpy as np

G = 9.81  # m/s2


def top(run_of):
    run = run_of("verification/free_top")
    energy = run["top_kinetic_energy"]
    momentum = np.array([run[f"top_angular_momentum_{d}"] for d in "xyz"])
    return {"energy": float(abs(energy / energy[0] - 1).max()),
            "momentum": float(np.linalg.norm(momentum.T - momentum[:, 0], axis=1).max() / np.linalg.norm(momentum[:, 0])),
            "steps": run.report["steps"], "turns": 10 * float(run["time"][-1]) / (2 * math.pi)}


def elliptic(k):
    """Complete integral of the first kind by the arithmetic and geometric mean."""
    a, b = 1.0, math.sqrt(1 - k * k)
    for _ in range(30):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (2 * a)


def pendulum(run_of):
    length, table = 0.5, []
    for across in (2, 4, 8):
        dx = 0.02 / across
        run = run_of("verification/compound_pendulum", [f"spacing={dx!r}"])
        t, angle = run["time"], run["bar_angle"] + math.pi / 2
        zeros = [t[k] - angle[k] * (t[k + 1] - t[k]) / (angle[k + 1] - angle[k]) for k in range(len(t) - 1) if angle[k] * angle[k + 1] < 0]
        exact = 4 * math.sqrt((length**2 / 3 + 0.02**2 / 12) / (G * length / 2)) * elliptic(math.sin(math.pi / 4))
        table.append({"across": across, "period": float(zeros[-1] - zeros[0]) * 2 / (len(zeros) - 1), "exact": exact,
                      "amplitude": float(angle.max())})
    return {"table": table}


def rolling(run_of):
    table = []
    for name, share, counts in (("disc", 2 / 3, (10, 20, 40)), ("sphere", 5 / 7, (5, 10, 20))):
        for count in counts:
            run = run_of("verification/rolling_" + name, [f"spacing={0.05 / count!r}"])
            t, x, v = run["time"], run["ball_x [m]"], run["ball_velocity_x"]
            spin = abs(run["ball_angular_velocity" + ("" if name == "disc" else "_z")])
            exact = share * G * math.sin(math.radians(15))
            table.append({"shape": name, "count": count, "acceleration": float(2 * (x[-1] - x[0]) / t[-1]**2), "exact": exact,
                          "slip": float(abs(v[-1] - 0.05 * spin[-1]) / v[-1])})
    return {"table": table}


def gears(run_of):
    run = run_of("gears")
    t, driver, driven = run["time"], run["driver_angle"], run["driven_angle"]
    first = int(np.searchsorted(t, t[-1] / 3))  # two thirds of a turn of the driven gear: 20 teeth
    turned = float((driven[-1] - driven[first]) / (driver[-1] - driver[first]))
    torques = [float(run[name][first:].mean()) for name in ("driver_torque", "driven_torque")]
    speed = run["driven_angular_velocity"][first:]
    return {"ratio": turned, "driver": torques[0], "driven": torques[1], "spread": float(speed.std() / abs(speed.mean())),
            "overlap": float(run["driver_driven_overlap"].max() / 1.25e-3), "touching": float((run["driver_driven_overlap"][first:] > 0).mean())}


CASES = {"top": top, "pendulum": pendulum, "rolling": rolling, "gears": gears}


def page(results):
    lines = []
    if "top" in results:
        r = results["top"]
        lines += ["### A free asymmetric top", "", f"{r['turns']:.0f} turns about its middle axis in {r['steps']} steps, tumbling: the kinetic energy of its particles "
                  f"changes by {r['energy']:.1e}, the angular momentum by {r['momentum']:.1e} (bound 1e-6).", ""]
    if "pendulum" in results:
        lines += ["### A bar that swings about its end, 90 degrees to both sides", "",
                  "| particles across | period [s] | over that of the smooth bar (elliptic integral) |", "| --- | --- | --- |"]
        lines += [f"| {r['across']} | {r['period']:.5f} | {100 * (r['period'] / r['exact'] - 1):+.4f} % |" for r in results["pendulum"]["table"]] + [""]
    if "rolling" in results:
        lines += ["### What rolls down a plane at 15 degrees", "",
                  "| shape | particles a radius | acceleration [m/s2] | over the analytic one | slip over speed |", "| --- | --- | --- | --- | --- |"]
        lines += [f"| {r['shape']} | {r['count']} | {r['acceleration']:.5f} | {100 * (r['acceleration'] / r['exact'] - 1):+.3f} % | {r['slip']:.1e} |"
                  for r in results["rolling"]["table"]] + [""]
    if "gears" in results:
        r = results["gears"]
        lines += ["### Gears of 20 and 30 teeth", "", "| figure | measured | exact |", "| --- | --- | --- |",
                  f"| mean speed of the driven gear over the driver's | {r['ratio']:.5f} | {-20 / 30:.5f} |",
                  f"| mean torque on the driven gear [N m/m] | {r['driven']:.3f} | -100, against the load |",
                  f"| mean torque on the driver over that on the driven gear | {r['driver'] / r['driven']:.5f} | {20 / 30:.5f} |",
                  f"| deepest overlap of the teeth [dx] | {r['overlap']:.4f} | |",
                  f"| time in which the teeth touch | {100 * r['touching']:.1f} % | 100 % |",
                  f"| spread of the speed of the driven gear | {100 * r['spread']:.2f} % | 0 |", "",
                  "Outlines that do not overlap do not feel each other: the distance at which the force begins is 0.", ""]
    return lines
