"""Runs many cases of a scene, some at a time. A case that has ended is not run again, one that was stopped goes on from its checkpoint.

Each folder gets `case.json` when its run ends: settings, a checksum of the scene's text, exit status and what the program said. A case whose file says the same settings and the same
scene is done. Runs end with this process (Linux: PR_SET_PDEATHSIG): they are sent SIGTERM, finish their step and write a checkpoint.
"""

import ctypes
import dataclasses
import fcntl
import hashlib
import json
import pathlib
import signal
import subprocess
import tempfile
import time

from .. import files
from ..errors import Unreadable

LONGEST_WAIT = 120  # s for a run of before that still writes its checkpoint


@dataclasses.dataclass
class Ended:
    """A case that has run: exit status, what the program said on its standard error, seconds of wall time of this call; `again`: it was done before."""
    case: object
    folder: pathlib.Path
    status: int
    said: str
    seconds: float = 0.
    again: bool = False


class Runner:
    """Runs the cases of the scene `file` into folders of `out`, `jobs` at a time, each with `threads` threads. `tell(ended)` is called for each in the order in which they end."""

    def __init__(self, program, file, out, jobs, threads=1, tell=lambda ended: None):
        self.program, self.file, self.out, self.jobs, self.threads, self.tell = str(program), pathlib.Path(file), pathlib.Path(out), jobs, threads, tell
        self.checksum = hashlib.sha256(self.file.read_bytes()).hexdigest()
        self.stopped = None  # the signal that ended this call
        self._running = {}
        self._libc = ctypes.CDLL(None)  # before a fork

    def go(self, cases):
        """Runs them; returns a list of Ended in the order of `cases`, without those that did not end because of a signal."""
        handlers = {number: signal.signal(number, self._stop) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        done, waiting = {}, list(cases)
        try:
            while (waiting and self.stopped is None) or self._running:
                while waiting and len(self._running) < self.jobs and self.stopped is None:
                    case = waiting.pop(0)
                    before = self.result(case)
                    if before:
                        done[case.folder] = before
                        self.tell(before)
                    else:
                        self._start(case)
                ended = self._collect()
                for each in ended:
                    done[each.case.folder] = each
                    self.tell(each)
                if not ended and self._running:
                    time.sleep(.02)
        finally:
            for process, *_ in self._running.values():
                process.terminate()
            for number, handler in handlers.items():
                signal.signal(number, handler)
        return [done[case.folder] for case in cases if case.folder in done]

    def result(self, case):
        """What is known of a case that ran before to its end with these settings and this scene; else None."""
        try:
            found = files.document(files.below(self.out, self.out / case.folder / "case.json"))
        except Unreadable:
            return None
        if not isinstance(found, dict) or type(found.get("status")) is not int or not isinstance(found.get("said"), str):
            return None
        if found.get("scene") != self.checksum or found.get("settings") != list(case.settings) or found.get("options", []) != list(case.options):
            return None
        return Ended(case, self.out / case.folder, found["status"], found["said"], again=True)

    def _start(self, case):
        folder = self.out / case.folder
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "case.json").unlink(missing_ok=True)
        wait_for(folder)
        restart = [] if not any(folder.glob("*.checkpoint*")) else ["--restart", "latest"]
        self._launch(case, folder, restart)

    def _launch(self, case, folder, restart):
        words = [self.program, "run", str(self.file), "--out", str(folder), "--quiet", "--threads", str(self.threads), *restart, *case.options,
                 *(word for each in case.settings for word in ("--set", each))]
        said = tempfile.TemporaryFile("w+", errors="replace")
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, start_new_session=True, preexec_fn=self._end_with_me)
        self._running[case.folder] = (process, case, folder, said, time.monotonic(), restart)

    def _end_with_me(self):
        self._libc.prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG

    def _stop(self, number, _):
        self.stopped = number
        for process, *_ in self._running.values():
            process.send_signal(signal.SIGTERM)

    def _collect(self):
        """The runs that have ended since the last call."""
        ended = []
        for name, (process, case, folder, said, begin, restart) in list(self._running.items()):
            if process.poll() is None:
                continue
            del self._running[name]
            said.seek(0)
            text = said.read()
            said.close()
            status = process.returncode if process.returncode >= 0 else 128 - process.returncode
            if status == 2 and restart and self.stopped is None:  # the checkpoint is of another scene, or damaged: from the beginning
                self._launch(case, folder, [])
                continue
            if self.stopped is not None and status > 128:
                continue  # not done: it goes on next time
            ended.append(Ended(case, folder, status, text, time.monotonic() - begin))
            if status <= 128:  # a run that a signal ended from outside, or that crashed, is told but not done
                files.write_whole(folder / "case.json", json.dumps({"settings": list(case.settings), "options": list(case.options), "scene": self.checksum, "status": status, "said": text}, indent=1) + "\n")
        return ended


def wait_for(folder):
    """Waits until no other process runs in this folder, as after a sweep that was killed: its runs still write their checkpoints."""
    lock = folder / "barchan.lock"
    begin = time.monotonic()
    while lock.exists() and time.monotonic() - begin < LONGEST_WAIT:
        try:
            with lock.open() as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return
        except OSError:
            time.sleep(.1)
