"""Ensembles of scenes without a wind profile, for ensemble.py: bodies, heaps, fluids.

Nobody knows the step better than by a few percent, nor where a particle of a fluid stands: time.safety (or a fixed step) is times 0.98, 1 and 1.02 in turn, fluids are
disturbed by 0.01 spacings and elastic bodies by 0.001 with another seed in each run, and precision and instruction sets change as in the ensembles of the wind. Asked: every run
reaches its end, all its numbers are finite, and no particle that moves is more than a spacing outside of the domain.
"""

import json
import math

import numpy
from barchan_bench.frame import Frame, series, table
from barchan_bench.table import head

PAGE_HEAD = head("scene", "runs", "reach the end", "stopped with a message", "steps", "largest density error", "largest speed, m/s",
                 "kinetic energy at the end, J", "user CPU s a run")


def is_wind(scene):
    velocities = [f.get("velocity") for f in scene["fill"] if f["phase"] == "air"]
    return any(isinstance(v, dict) and "log-profile" in v for v in velocities)


def members(scene, sets_of_instructions, options):
    """The runs of a scene: what differs, and the command's overrides."""
    time = scene["time"]
    disturbed = {"fluid": 0.01, "elastic": 0.001}  # spacings
    fills = [(k, f.get("perturb", disturbed[scene["phases"][f["phase"]]["kind"]])) for k, f in enumerate(scene["fill"]) if scene["phases"][f["phase"]]["kind"] in disturbed]
    for k in range(options.runs):
        factor = (.98, 1., 1.02)[k % 3]
        precision, instructions = ("mixed", "double")[k // 3 % 2], sets_of_instructions[k // 6 % len(sets_of_instructions)]
        sets = [f"time.step={time['step'] * factor!r}" if "step" in time else f"time.safety={time.get('safety', 1.) * factor!r}", f"precision={precision}"]
        for n, perturb in fills:
            sets += [f"fill.{n}.perturb={perturb!r}", f"fill.{n}.seed={k + 1}"]
        sets += [f"output.every={time['end']!r}", f"output.history-every={time['end'] / 100!r}", "output.walls=false"]
        yield {"run": k + 1, "seed": k + 1, "step_factor": factor, "precision": precision}, instructions, sets + options.set


def figures(out, name, scene):
    """What a finished run shows."""
    report = json.loads((out / "run.json").read_text())
    history = table(out / "history.csv")
    time, file = series(out / f"{name}.pvd")[-1]
    last = Frame(file, time)
    size, walls = numpy.array(scene["domain"]["size"]), [k for k, n in enumerate(last.names) if scene["phases"][n]["kind"] == "wall"]
    origin, margin = numpy.array(scene["domain"].get("origin", [0.] * len(size))), scene["spacing"]
    moving = ~numpy.isin(last["phase"], walls)
    place = last.x[moving][:, :len(size)]
    outside = ((place < origin - margin) | (place > origin + size + margin)).any(axis=1)
    kinetic = sum(values[-1] for title, values in history.items() if title.split(" [")[0].endswith("_kinetic_energy"))
    finite = bool(all(numpy.isfinite(values).all() for values in (*history.values(), last.x)))
    return {"instructions": report["instruction_set"].split(" (")[0], "ended_at": float(history["time"][-1]), "steps": report["steps"], "finite": finite, "left": int(outside.sum()),
            "density_error": float(history["largest_density_error"].max()), "fastest": float(history["largest_speed"].max()), "kinetic": float(kinetic),
            "cpu_seconds": round(report["cpu_seconds"], 1)}


def row(r):
    text = lambda key, form: "" if r.get(key) is None else format(r[key], form)
    return (f"| {r['run']} | {r['seed']} | {r['step_factor']:.2f} | {r['precision']} | {r.get('instructions', '')} | {r['status']} | {text('ended_at', '.4g')} | {r.get('steps', '')} | "
            f"{text('density_error', '.4f')} | {text('fastest', '.4g')} | {text('kinetic', '.4g')} | {text('cpu_seconds', '.0f')} | {r['message'].replace('|', '/')} |")


def verdict(result):
    runs = result["runs"]
    ended = sum(r["status"] == 0 for r in runs)
    wrong = sum(not r.get("finite", True) or bool(r.get("left")) for r in runs)
    lines = [f"{ended} of {len(runs)} reach the end; {wrong} have numbers that are not finite or particles outside the domain."]
    good = ended == len(runs) and wrong == 0
    return lines + ([] if good else ["**MISSED**"]), good


def page_row(result):
    """A scene in one row of docs/stability.md: least and largest of its runs."""
    runs = result["runs"]

    def span(key, form):
        values = [r[key] for r in runs if r.get(key) is not None and math.isfinite(r[key])]
        low, high = (format(f(values), form) for f in (min, max)) if values else ("", "")
        return low if low == high else f"{low} to {high}"

    ended = sum(r["status"] == 0 for r in runs)
    errors = [r["density_error"] for r in runs if r.get("density_error") is not None]
    return (f"| {result['scene']} | {len(runs)} | {ended}{'' if verdict(result)[1] else ' **MISSED**'} | {sum(r['status'] == 3 and bool(r['message']) for r in runs)} | {span('steps', 'd')} | "
            f"{max(errors, default=math.nan):.4f} | {span('fastest', '.4g')} | {span('kinetic', '.4g')} | {span('cpu_seconds', '.0f')} |")
