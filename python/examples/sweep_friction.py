#!/usr/bin/python3
"""How far two grains roll and slide, by friction: runs with several values of a key, and what became of each.

    PYTHONPATH=python /usr/bin/python3 python/examples/sweep_friction.py
"""

import barchan

SCENE = {
    "title": "A grain that slides over a floor", "spacing": 0.02,
    "domain": {"size": [1.0, 0.2], "gravity": [0, -9.81]},
    "phases": {"grain": {"kind": "grains", "density": 2000, "diameter": 0.02, "stiffness": 1e5, "restitution": 0.5, "rolling-friction": 0.2}, "floor": {"kind": "wall"}},
    "interactions": {"grain-floor": {"law": "linear"}},
    "fill": [{"phase": "floor", "shape": {"sides": ["bottom"]}}, {"phase": "grain", "shape": {"points": [[0.1, 0.01]]}, "velocity": [1, 0]}],
    "time": {"end": 0.2, "largest-speed": 2}, "output": {"every": 0.05, "history-every": 0.002},
}

print("friction   way, mm   speed at the end, m/s")
for friction in (0.0, 0.1, 0.5):
    try:
        run = barchan.run(SCENE, out=f"out/slide_{friction}", name="slide", set={"phases.grain.friction": friction}, threads=1)
    except barchan.Breakdown as error:  # the others still run
        print(f"{friction:8} {error}")
        continue
    way = run[-1]["position", "grain"][0, 0] - run[0]["position", "grain"][0, 0]
    print(f"{friction:8} {1e3 * way:9.1f} {run.history['grain_mean_vx'][-1]:23.3f}")
