#!/usr/bin/python3
"""Are places in a file beyond 2^32 read right? A frame whose arrays begin 4.3 GB behind its head is compared with itself.

    bench/robustness/offsets.py PROGRAM

A short run writes the frame; a hole of 2^32 + 98760 bytes is put before its arrays and their offsets are moved by as much. The file is sparse: it takes
200 kB of the disk, but reading it takes about 8 GB of memory and a minute. Exits with 1 when `compare` does not call the two the same.
"""

import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run  # noqa: E402

HOLE = 2**32 + 98760


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        top = pathlib.Path(scratch)
        done = run.scene(program, "verification/still_tank", top, ["time.end=1e-3"], threads=None, shown=True)
        frame, sparse = done.series()[-1][1], top / "sparse.vtp"
        whole = frame.read_bytes()
        at = whole.index(b"_", whole.index(b"<AppendedData")) + 1
        head = re.sub(rb'offset="(\d+)"', lambda m: b'offset="%d"' % (int(m[1]) + HOLE), whole[:at])
        with open(sparse, "wb") as file:
            file.write(head)
            file.seek(len(head) + HOLE)
            file.write(whole[at:])
        status = sparse.stat()
        done = run.command([program, "compare", frame, sparse])
        print(f"{status.st_size} bytes, {512 * status.st_blocks} on the disk: status {done.status}, {(done.stdout + done.stderr).strip().splitlines()[-1]}")
        return done.status


if __name__ == "__main__":
    sys.exit(main())
