"""What run.json and saltation_NAME.json hold, by type. A file may be damaged or another person's: a value of another type than expected is left out, and a remark says which."""

import math

NUMBER, TEXT, ANY = "a number", "a text", "*"

RUN = {
    "version": TEXT, "commit": TEXT, "compiler": TEXT, "instruction_set": TEXT, "vtk": TEXT, "threads": NUMBER,
    "scene": {"title": TEXT, "file": TEXT, "sha256": TEXT, "set": [TEXT], "state": TEXT, "spacing": NUMBER},
    "end_reason": TEXT, "process": NUMBER, "host": TEXT, "warnings": [TEXT], "steps": NUMBER, "simulated_time": NUMBER,
    "particles": {ANY: NUMBER}, "pairs": {ANY: NUMBER}, "passes": [TEXT],
    "particle_steps_per_second": NUMBER, "wall_seconds": NUMBER, "cpu_seconds": NUMBER, "seconds": {ANY: NUMBER}, "time_step_limits": {ANY: NUMBER}, "budgets": {ANY: NUMBER},
    "repeats": [{"name": TEXT, "of": TEXT, "interval": NUMBER, "calls": NUMBER, "seconds": NUMBER}],
    "threads_used": [{"threads": NUMBER, "steps": NUMBER, "seconds": NUMBER}],
    "measured": [{"kind": TEXT, "name": TEXT, "files": [TEXT], "samples": NUMBER}],
    "retreats": {"count": NUMBER, "list": [{"step": NUMBER, "time": NUMBER, "back_to": NUMBER, "share_of_step": NUMBER, "reason": TEXT}]},
}
DECAY = {"height": NUMBER, "standard_error": NUMBER, "slices": NUMBER}
SALTATION = {"flux": NUMBER, "flux_in_flight": NUMBER, "bed": NUMBER, "flux_decay": DECAY, "concentration_decay": DECAY}

NAMES = {bool: "true or false", int: NUMBER, float: NUMBER, str: TEXT, list: "a list", dict: "a table"}
MOST_REMARKS = 20


def fitting(value, shape, file, remarks):
    """The parts of a document of JSON that have the types of `shape`; of the others a remark. null is a number that is not there: JSON has no other word for nan."""
    wrong = []
    found = _fitting(value, shape, "", wrong)
    remarks += [f"{file}: {each}" for each in wrong[:MOST_REMARKS]]
    if len(wrong) > MOST_REMARKS:
        remarks.append(f"{file}: {len(wrong) - MOST_REMARKS} further values are of another type than expected")
    return shape.__class__() if found is None else found


def _fitting(value, shape, where, wrong):
    kind = NUMBER if shape == NUMBER else TEXT if shape == TEXT else NAMES[type(shape)]
    if value is None:
        return None
    if kind == NUMBER and NAMES[type(value)] == NUMBER and not (math.isfinite(value) and abs(value) < 1e300):
        wrong.append(f"{where} is {str(value)[:40]}; expected a finite number: it is left out")
        return None
    if NAMES[type(value)] != kind:
        wrong.append(f"{where or 'it'} is {NAMES[type(value)]}; expected {kind}: it is left out")
        return None
    if isinstance(shape, list):
        return [part for k, each in enumerate(value) if (part := _fitting(each, shape[0], f"{where}[{k}]", wrong)) is not None]
    if isinstance(shape, dict):
        parts = {key: _fitting(each, shape.get(key, shape.get(ANY)), f"{where}.{key}".lstrip(".")[:80], wrong) for key, each in value.items() if key in shape or ANY in shape}
        return {key: part for key, part in parts.items() if part is not None}
    return value
