"""Results that are kept in bench/: one .csv a case, read and written here alone.

A file is a few tables; each has a line before it that says what it is, with NAME the path of keys to it, joined by ` > `:

    [NAME]      facts: a line `key,value` each
    [[NAME]]    a list: a line of columns, then a line a record
    [NAME > *]  records by a key: the first column is the key

A cell is JSON where it can be read as such (a number, true, null, a list), else the word itself; a word that would be read as JSON stands in its own
quotes. An empty cell: the record has no such column. What a run writes in time (a history, a profile of each frame) is not kept: it is measured again.
"""

import csv
import io
import json

from barchan_bench import ROOT

JOIN = " > "
LONGEST = 50  # numbers of one list in a cell: more are a history


def load(file, default=None):
    """What `keep` wrote: dictionaries, lists, numbers and words. `default` if the file is not there."""
    return decode(file.read_text()) if file.exists() else default


def keep(file, results, leave=()):
    """Writes results, a dictionary or a list of records, to their file, without the keys `leave` wherever they stand. Throws ValueError for a list that is
    too long for a cell, and for the path of this repository on this machine."""
    text = encode(without(results, leave))
    if f"{ROOT}/" in text:
        raise ValueError(f"{file.name}: a path of this machine: {ROOT}")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def without(value, leave):
    if isinstance(value, dict):
        return {key: without(v, leave) for key, v in value.items() if key not in leave}
    return [without(v, leave) for v in value] if isinstance(value, list) else value


def to_cell(value):
    if not isinstance(value, str):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return json.dumps(value, ensure_ascii=False) if value == "" or from_cell(value) != value else value


def from_cell(cell):
    try:
        return json.loads(cell)
    except json.JSONDecodeError:
        return cell


def is_records(value):
    return isinstance(value, list) and value != [] and all(isinstance(v, dict) and v for v in value)


def encode(results):
    out = io.StringIO()
    line = csv.writer(out, lineterminator="\n").writerow

    def mark(text):
        out.write(("\n" if out.tell() else "") + text + "\n")

    def look(value, place):
        if isinstance(value, list):
            if len(value) > LONGEST and not is_records(value):
                raise ValueError(f"{JOIN.join(place)}: {len(value)} values in a cell; keep what is concluded from them")
            for v in value:
                look(v, place)
        elif isinstance(value, dict):
            for key, v in value.items():
                if JOIN in key or key == "*":
                    raise ValueError(f"{key}: no name of a result")
                look(v, (*place, key))

    def table(rows, first=()):
        columns = list(dict.fromkeys(key for _, row in rows for key in row))
        line([*first, *columns])
        for key, row in rows:
            line([*key, *(to_cell(row[c]) if c in row else "" for c in columns)])

    def by_key(value):
        """Records that a table with a line each shows well: they have words and numbers, and no cell has a table inside."""
        def has_table(cell):
            return is_records(cell) or isinstance(cell, dict) and any(isinstance(x, dict) for x in cell.values())
        return len(value) > 1 and all(isinstance(v, dict) and v and not any(map(has_table, v.values())) and not all(isinstance(c, dict) for c in v.values())
                                      for v in value.values())

    def write(value, place):
        if isinstance(value, list):
            mark(f"[[{JOIN.join(place)}]]")
            table([((), v) for v in value])
            return
        if by_key(value):
            mark(f"[{JOIN.join((*place, '*'))}]")
            table([((key,), v) for key, v in value.items()], ("",))
            return
        inside = {key: v for key, v in value.items() if is_records(v) or isinstance(v, dict) and v}
        if len(inside) < len(value) or not value:
            mark(f"[{JOIN.join(place)}]")
            for key, v in value.items():
                if key not in inside:
                    line([key, to_cell(v)])
        for key, v in inside.items():
            write(v, (*place, key))

    look(results, ())
    write(results, ())
    return out.getvalue()


def decode(text):
    results, where, kind, columns = {}, (), "[]", None
    found = results

    def at(place):
        inside = results
        for key in place:
            inside = inside.setdefault(key, {})
        return inside

    for cells in csv.reader(io.StringIO(text)):
        if not cells:
            columns = None
            continue
        if columns is None:
            mark = ",".join(cells)
            kind = "[[]]" if mark.startswith("[[") else "[*]" if mark.endswith("*]") else "[]"
            where = tuple(filter(None, (mark[2:-2] if kind == "[[]]" else mark[1:-1]).split(JOIN)))
            columns = []
            if kind == "[[]]":
                found = []
                if where:
                    at(where[:-1])[where[-1]] = found
                else:
                    results = found
            else:
                found = at(where[:-1] if kind == "[*]" else where)
        elif kind == "[]":
            found[cells[0]] = from_cell(cells[1])
        elif not columns:
            columns = cells
        else:
            row = {name: from_cell(cell) for name, cell in zip(columns, cells) if name and cell != ""}
            if kind == "[[]]":
                found.append(row)
            else:
                found[cells[0]] = row
    return results
