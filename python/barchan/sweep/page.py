"""The page of a sweep: what was varied, how the runs ended, a plot of each measure, the table."""

import math

from ..report import page as report_page, parts, plots


MOST_LABELS = 14  # in a legend


def as_number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def axis_of(lines, keys):
    """The key that stands along x: of those with numbers alone the one with most values; and its values by text. Words stand at 0, 1, 2, ..."""
    values = {key: list(dict.fromkeys(line[key] for line in lines)) for key in keys}
    numeric = [key for key in keys if all(as_number(v) is not None for v in values[key])]
    key = max(numeric or keys, key=lambda k: len(values[k]))
    return key, {v: as_number(v) if key in numeric else float(k) for k, v in enumerate(values[key])}, key in numeric


def plot(lines, keys, measure):
    """An <svg> of one measure over the key along x, a line for each combination of the others; crosses on the lower edge: runs that did not end well."""
    along, place, numeric = axis_of(lines, keys)
    groups = {}
    for line in lines:
        groups.setdefault(", ".join(f"{k} = {line[k]}" for k in keys if k != along), []).append(line)
    bad = [place[line[along]] for line in lines if line["status"] != 0]
    figure, axes = plots.panel([*list(groups)[:MOST_LABELS], *["did not end well"] * bool(bad)] if len(groups) > 1 or bad else [], 5.6, 2.6)
    for k, (label, members) in enumerate(groups.items()):
        good = sorted((place[m[along]], m[measure]) for m in members if m["status"] == 0 and math.isfinite(m[measure]))
        if k < 4 * len(plots.COLOURS) and good:
            axes.plot(*zip(*good), plots.STYLES[k // len(plots.COLOURS) % 4], color=plots.COLOURS[k % len(plots.COLOURS)], marker="os^Dv"[k % 5], markersize=4, label=label if k < MOST_LABELS else None)
    if bad:
        axes.plot(bad, [0] * len(bad), "x", color="#D55E00", transform=axes.get_xaxis_transform(), clip_on=False, label="did not end well")
    axes.set(xlabel=along)
    if not numeric:
        axes.set_xticks(list(place.values()), [str(v)[:24] for v in place])
    elif len(place) > 2 and min(place.values()) > 0 and max(place.values()) > 30 * min(place.values()):
        axes.set_xscale("log")
    axes.legend_below()
    return plots.svg(figure)


def make(scene, command, lines, expected, keys, measures, notes):
    """The whole page as text. `lines`: those of the table; `expected`: how many cases there are; `notes`: texts for the top."""
    names = [f"{column}:{way}" for column, way in measures]
    ended = sum(line["status"] == 0 for line in lines)
    faults = [line for line in lines if line["status"] != 0]
    head = f"{ended} of {expected} runs ended well" + (f", {len(faults)} did not" if faults else "") + (f", {expected - len(lines)} have not run" if expected > len(lines) else "") + "."
    out = f'<div class="notice {"good" if ended == expected else "warn"}"><b>{head}</b>'
    if faults:
        out += "<ul>" + "".join(f"<li><code>{parts.esc(f['run'])}</code>: status {f['status']}: {parts.esc(f['end_reason'][:500])}</li>" for f in faults[:30]) + "</ul>"
    out += "</div>" + "".join(f'<div class="notice note">{parts.esc(note)}</div>' for note in notes)
    shown = [(name.replace(":", ", "), plot(lines, keys, name)) for name in names if any(math.isfinite(line[name]) for line in lines)] if lines else []
    out += parts.section("Results", parts.grid_of(shown), "results")
    columns = [*keys, "status", *names, "simulated_time", "steps", "wall_seconds", "end_reason"]
    text = lambda line, c: parts.number(line[c]) if not isinstance(line[c], str) else parts.esc(line[c] if len(line[c]) < 90 else line[c][:90] + " ...")
    table = parts.rows_table([parts.esc(c.replace("_", " ")) if c not in keys else parts.esc(c) for c in columns], [[text(line, c) for c in columns] for line in lines])
    out += parts.section("Table", table + '<p class="hint">The same numbers are in <code>sweep.csv</code>; each run has its folder beside this page.</p>', "table")
    out += parts.section("Command", f"<pre>{parts.esc(command)}</pre>", "command")
    return report_page.frame(f"Sweep of {scene} - Barchan", f"Sweep of {parts.esc(scene)}", f"{expected} runs; varied: {', '.join(keys)}", out)
