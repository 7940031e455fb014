#!/usr/bin/python3
"""What helps a person along: list, new, names of scenes, constants, completion, the manual page, the schema, the terminal.

    test_habits.py PROGRAM SOURCE_DIR
"""
import fcntl
import json
import os
import pty
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import tomllib
import unittest
from pathlib import Path

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
SCENES = sorted((SOURCE / "scenes").glob("**/*.toml"))


def run(*words, folder=None, status=0):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=300)
    if done.returncode != status:
        raise AssertionError(f"{words}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Lists(Case):
    def test_every_scene_and_state_has_a_line(self):
        shown = json.loads(run("list", "--json"))
        names = {scene["name"]: scene for scene in shown["scenes"]}
        self.assertEqual(sorted(names), sorted(str(s.relative_to(SOURCE / "scenes").with_suffix("")) for s in SCENES))
        lines = run("list").splitlines()
        states = {state["name"] for state in shown["states"]}
        for name, scene in names.items():
            document = tomllib.loads(Path(scene["file"]).read_text())
            self.assertEqual(scene["title"], document["title"])
            said = [" ".join(line.split()[1:]) for line in lines if line.split()[:1] == [name]]
            self.assertEqual(len(said), 1, name)
            self.assertTrue(len(said[0]) > 10 and (scene["shows"] or scene["title"]).startswith(said[0].removesuffix("...")), said)
            for state in filter(None, scene["state"].split(",")):
                self.assertIn(state.strip(), states)
        self.assertLessEqual(max(map(len, lines)), 100)
        for state in shown["states"]:
            self.assertTrue((SOURCE / "pvstate" / f"{state['name']}.py").is_file() and len(state["shows"]) > 10, state)

    def test_keys_of_a_scene(self):
        keys = run("list", "keys", "--names", "--of", "saltation").split()
        for key in ("time.end", "constants.d", "phases.sand.diameter.mean", "interactions.air-sand.drag", "fill.2.shape.points"):
            self.assertIn(key, keys)
        for key in ("phases.air.shifting", "fill.3.phase", "phases.dust.density"):  # of another kind; not there
            self.assertNotIn(key, keys)
        self.assertIn("phases.NAME.density", run("list", "keys", "--names").split())


class News(Case):
    def test_every_scene_can_be_copied_and_planned_from(self):
        for scene in SCENES:
            name = str(scene.relative_to(SOURCE / "scenes").with_suffix(""))
            run("new", f"{name}/mine", "--from", name, folder=self.folder)
            made = self.folder / name / "mine.toml"
            self.assertEqual(tomllib.loads(made.read_text()), tomllib.loads(scene.read_text()))
            self.assertEqual(re.findall("^#.*title.*$", made.read_text(), re.M), re.findall("^#.*title.*$", scene.read_text(), re.M))
            run("list", "keys", "--of", made)  # which reads and checks it with its files

    def test_a_copy_runs_where_it_is(self):
        run("new", "place/mine", "--from", "gears", folder=self.folder)
        shutil.move(self.folder / "place", self.folder / "other")
        run("run", "mine.toml", "--quiet", "--set", "time.end=1e-5", "--threads", "1", folder=self.folder / "other")
        self.assertTrue((self.folder / "other/out/mine/mine.pvd").is_file())

    def test_nothing_is_overwritten(self):
        (self.folder / "mine.toml").write_text("mine")
        self.assertIn("is there already", run("new", "mine", "--from", "gears", folder=self.folder, status=2))
        (self.folder / "gears").mkdir()
        (self.folder / "gears/gear_20.csv").write_text("mine")
        self.assertIn("another file than that of gears", run("new", "yours", "--from", "gears", folder=self.folder, status=2))
        self.assertEqual(sorted(p.name for p in self.folder.rglob("*")), ["gear_20.csv", "gears", "mine.toml"])
        self.assertEqual((self.folder / "mine.toml").read_text(), "mine")


class Names(Case):
    def test_a_name_is_the_scene_that_comes_along(self):
        run("run", "hop", "--quiet", "--set", "time.end=1e-4", "--threads", "1", folder=self.folder)
        self.assertTrue((self.folder / "out/hop/hop.pvd").is_file())

    def test_a_file_of_that_name_comes_first(self):
        (self.folder / "hop").write_text("no scene")
        self.assertIn("hop:1:", run("run", "hop", folder=self.folder, status=2))

    def test_dry_is_plan(self):
        def steady(text):
            return [line for line in text.splitlines() if "estimate" not in line and " s " not in line and "MB" not in line][:20]
        self.assertEqual(steady(run("run", "hop", "--dry", folder=self.folder)), steady(run("plan", "hop", folder=self.folder)))
        self.assertEqual(list(self.folder.iterdir()), [])


class Constants(Case):
    SCENE = """spacing = "d"
[constants]
d = 0.1
wide = "3*d"  # 0.30000000000000004 in binary; the number meant is 0.3
[domain]
size = ["wide", 1]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
[interactions]
water-water = 2.1
[[fill]]
phase = "water"
shape = "the-rest"
velocity = ["x/wide", "0.1*sin(d)"]
[time]
end = "d/1000"
"""

    def plain(self):
        text = re.sub(r"\[constants\]\n.*\n.*\n", "", self.SCENE)
        for formula, number in (('"d"', "0.1"), ('"wide"', "0.3"), ("x/wide", "x/0.3"), ("sin(d)", "sin(0.1)"), ('"d/1000"', "1e-4")):
            text = text.replace(formula, number)
        return text

    def frames(self, text, *words):
        place = Path(tempfile.mkdtemp(dir=self.folder))
        (place / "s.toml").write_text(text)
        run("run", "s.toml", "--quiet", "--threads", "1", "--out", "o", *words, folder=place)
        return {file.name: file.read_bytes() for file in (place / "o").iterdir() if file.suffix in (".vtp", ".csv")}, place

    def test_the_same_bits_as_with_numbers(self):
        with_names, _ = self.frames(self.SCENE)
        with_numbers, _ = self.frames(self.plain())
        self.assertGreater(len(with_names), 2)
        self.assertEqual(with_names, with_numbers)

    def test_a_checkpoint_goes_on(self):
        _, place = self.frames(self.SCENE)
        (place / "s.toml").write_text(self.SCENE.replace('"d/1000"', "2e-4"))
        run("run", "s.toml", "--quiet", "--threads", "1", "--out", "o", "--restart", "latest", folder=place)

    def test_one_override_changes_every_length(self):
        coarse, _ = self.frames(self.SCENE, "--set", "constants.d=0.2")
        self.assertNotEqual(coarse["s_000000.vtp"], self.frames(self.SCENE)[0]["s_000000.vtp"])
        keys = json.loads(run("plan", "saltation", "--json", "--set", "constants.d=4e-4"))
        self.assertAlmostEqual(keys["dx"] if "dx" in keys else 4e-4, 4e-4)

    def test_what_is_wrong_is_named(self):
        for before, after, expected in (
                ("d = 0.1", "d = 0.1\nk = 2", "s.toml:4:1: constants.k: nothing uses it"),
                ("d = 0.1", "d = 0.1\nx = 2", "constants.x: the name stands for something else in formulas"),
                ("d = 0.1", 'd = "wide"', "needs"),
                ("d = 0.1", "d = true", "expected a number or a formula of other constants"),
                ('["wide", 1]', '["wied", 1]', 's.toml:6:9: domain.size: the formula "wied" is malformed'),
                ('["wide", 1]', '["-wide", 1]', "s.toml:6:9: domain.size: -0.3 is out of range"),
                ('"d/1000"', '"d/0"', "has no finite value")):
            with self.subTest(after=after):
                self.assertIn(before, self.SCENE)
                (self.folder / "s.toml").write_text(self.SCENE.replace(before, after))
                self.assertIn(expected, run("run", "s.toml", folder=self.folder, status=2))


class Shells(Case):
    def complete(self, *words):
        """What bash offers for the last word."""
        script = run("completion", "bash")
        line = " ".join(f"'{word}'" for word in words)
        done = subprocess.run(["bash", "-c", f"{script}\nCOMP_WORDS=('{PROGRAM}' {line}); COMP_CWORD={len(words)}; _barchan; printf '%s\\n' \"${{COMPREPLY[@]}}\""],
                              capture_output=True, text=True, timeout=60, cwd=self.folder)
        self.assertEqual(done.stderr, "")
        return done.stdout.split("\n")[:-1]

    def test_bash(self):
        self.assertEqual(self.complete("ru"), ["run"])
        self.assertIn("report", self.complete(""))
        self.assertEqual(self.complete("run", "--th"), ["--threads"])
        self.assertEqual(self.complete("completion", "b"), ["bash"])
        self.assertEqual(self.complete("run", "--instructions", "avx"), ["avx2", "avx512"])
        (self.folder / "mine.toml").write_text("")
        self.assertEqual(sorted(self.complete("run", "m")), ["mine.toml", "minimal"])
        self.assertIn("dune", self.complete("run", "du"))
        self.assertEqual(self.complete("run", "saltation", "--set", "phases.s"), ["phases.sand."])
        self.assertEqual(self.complete("run", "--threads", "1", "saltation", "--set", "constants."), ["constants.d=", "constants.scale="])
        self.assertIn("time.end=", self.complete("plan", "saltation", "--set", "time.e"))
        self.assertIn("phases.", self.complete("plan", "missing.toml", "--set", "ph"))
        self.assertEqual(self.complete("new", "mine", "--from", "gea"), ["gears"])

    def test_the_scripts_are_read_by_their_shells(self):
        for shell, check in (("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")):
            if shutil.which(shell):
                file = self.folder / shell
                file.write_text(run("completion", shell))
                done = subprocess.run([shell, check, file], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), shell)

    def test_fish_offers_keys(self):
        if not shutil.which("fish"):
            self.skipTest("no fish")
        script = f"function barchan; {PROGRAM} $argv; end\n" + run("completion", "fish")
        done = subprocess.run(["fish", "-c", script + "\ncomplete -C 'barchan run saltation --set constants.'\ncomplete -C 'barchan ne'"],
                              capture_output=True, text=True, cwd=self.folder, env={**os.environ, "HOME": str(self.folder)})
        for word in ("constants.d=", "constants.scale=", "new"):
            self.assertIn(word, done.stdout, done.stderr)

    def test_options_of_the_python_commands_are_those_of_python(self):
        for command in ("report", "sweep"):
            said = run(command, "--help")
            options = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", said.split("options:")[1].split("Exit status")[0])) - {"--help"}
            listed = set(re.findall(r"--[a-z-]+", next(line for line in run("completion", "bash").splitlines()
                                                       if line.startswith(f'      "{command}")')))) - {"--help"}
            self.assertEqual(options - {"--threads"}, listed - {"--threads"}, command)


class Manual(Case):
    def test_every_command_and_option_is_there(self):
        page = run("man").replace("\\-", "-")
        for command in re.findall(r"^  ([a-z]+) ", run("--help").split("Subcommands:")[1], re.M):
            self.assertIn(f".SS {command}\n", page)
        for option in re.findall(r"--[a-z]+", run("run", "--help")):
            self.assertIn(option, page)

    def test_man_and_mandoc_have_no_complaint(self):
        file = self.folder / "barchan.1"
        file.write_text(run("man"))
        if shutil.which("man") and shutil.which("groff"):
            done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", file], capture_output=True, text=True,
                                  env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        if shutil.which("mandoc"):
            done = subprocess.run(["mandoc", "-Tlint", "-W", "error", file], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (0, ""))


class Schema(Case):
    FILE = SOURCE / "scenes/scene.schema.json"

    def test_the_file_beside_the_scenes_is_what_the_program_says(self):
        if os.environ.get("BARCHAN_WRITE_DOCS"):
            self.FILE.write_text(run("schema"))
        self.assertEqual(self.FILE.read_text(), run("schema"), "`build/barchan schema > scenes/scene.schema.json` brings it up to date")

    def test_every_scene_names_it(self):
        for scene in SCENES:
            line = scene.read_text().split("\n")[0]
            self.assertTrue(line.startswith("#:schema "), f"{scene}: the first line names the schema: #:schema ./scene.schema.json, ../ in a folder")
            self.assertEqual((scene.parent / line.removeprefix("#:schema ")).resolve(), self.FILE.resolve())

    def test_every_scene_fits_and_mistakes_do_not(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("no python3-jsonschema")
        schema = json.loads(self.FILE.read_text())
        self.assertEqual(schema["$schema"], "http://json-schema.org/draft-04/schema#")
        jsonschema.Draft4Validator.check_schema(schema)
        check = jsonschema.Draft4Validator(schema)
        for scene in SCENES:
            problems = [error.message for error in check.iter_errors(tomllib.loads(scene.read_text()))]
            self.assertEqual(problems, [], scene)
        dune = tomllib.loads((SOURCE / "scenes/dune.toml").read_text())
        for wrong in ({"spacing": 0}, {"spaceing": 1}, {"dimensions": 4}, {"phases": {"a-b": {}}}, {"constants": {"d": True}}):
            self.assertFalse(check.is_valid({**dune, **wrong}), wrong)


class Terminals(Case):
    def shown(self, *words, columns=80, **environment):
        """What the program writes on a terminal of so many columns."""
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([PROGRAM, *words], stdout=slave, stderr=slave, stdin=subprocess.DEVNULL, cwd=self.folder,
                                   env={**{k: v for k, v in os.environ.items() if k != "NO_COLOR"}, "TERM": "xterm", **environment})
        os.close(slave)
        text = b""
        try:
            while part := os.read(master, 65536):
                text += part
        except OSError:
            pass  # the program has ended
        os.close(master)
        process.wait()
        return text.decode().replace("\r\n", "\n")

    def test_messages_fit(self):
        plain = subprocess.run([PROGRAM, "run", "gersho"], capture_output=True, text=True).stderr
        for columns in (80, 120):
            said = self.shown("run", "gersho", columns=columns, NO_COLOR="1")
            self.assertLessEqual(max(map(len, said.split("\n"))), columns)
            self.assertEqual(said.split(), plain.split())
        self.assertGreater(max(map(len, plain.split("\n"))), 120)  # in a file each problem is one line
        for words in (["plan", "hop"], ["list"], ["run", "--help"], ["list", "keys"]):
            said = self.shown(*words, NO_COLOR="1")
            long = [line for line in said.split("\n") if len(line) > 80 and " " in line.strip()]
            self.assertEqual(long, [], words)

    def test_colour_on_a_terminal_only(self):
        self.assertIn("\033[1;31mbarchan:\033[0m", self.shown("run", "gersho"))
        self.assertNotIn("\033", self.shown("run", "gersho", NO_COLOR="1"))
        self.assertNotIn("\033", self.shown("run", "gersho", TERM="dumb"))
        self.assertNotIn("\033", run("run", "gersho", status=2))


class Versions(Case):
    def test_an_old_checkpoint_is_refused_and_nothing_is_written(self):
        run("run", "hop", "--quiet", "--threads", "1", "--set", "time.end=1e-4", folder=self.folder)
        checkpoint = self.folder / "out/hop/hop.checkpoint"
        newer, page = checkpoint.read_bytes(), (SOURCE / "docs/versions.md").read_text()
        checkpoint.write_bytes(newer.replace(b"barchan checkpoint 2", b"barchan checkpoint 1", 1))
        before = {file: file.read_bytes() for file in (self.folder / "out/hop").iterdir()}
        said = run("run", "hop", "--quiet", "--threads", "1", "--set", "time.end=2e-4", "--restart", str(checkpoint), folder=self.folder, status=2)
        message = said.strip().split(": ", 2)[2]
        self.assertIn(message, page)  # as docs/versions.md says
        self.assertEqual({file: file.read_bytes() for file in (self.folder / "out/hop").iterdir()}, before)
        checkpoint.write_bytes(newer)
        run("run", "hop", "--quiet", "--threads", "1", "--set", "time.end=2e-4", "--restart", str(checkpoint), folder=self.folder)


class Citation(Case):
    def test_versions_agree(self):
        project = re.search(r"project\(barchan VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        cited = re.search(r"^version: (\S+)$", (SOURCE / "CITATION.cff").read_text(), re.M)[1]
        self.assertEqual(cited, project)
        self.assertEqual(json.loads((SOURCE / "docs/sbom.json").read_text())["metadata"]["component"]["version"], project)
        self.assertIn(f'version("{project}")', (SOURCE / "packaging/spack/package.py").read_text())
        self.assertIn(f"barchan {project} ", run("--version"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
