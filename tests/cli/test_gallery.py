#!/usr/bin/python3
"""Every scene has a picture, a state that exists, and a line in the list of the gallery.

    /usr/bin/python3 tests/cli/test_gallery.py PROGRAM ROOT"""

import json
import pathlib
import struct
import sys
import tomllib
import unittest

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2])
sys.path.insert(0, str(ROOT / "bench"))
import gallery  # noqa: E402

SCENES = {str(path.relative_to(ROOT)): path for path in (ROOT / "scenes").rglob("*.toml")}
STATES = {path.stem for path in (ROOT / "pvstate").glob("*.py") if not path.stem.startswith(("barchan_", "render_"))}


class Gallery(unittest.TestCase):
    entries = json.loads(gallery.LIST.read_text())

    def test_every_scene_is_in_the_list_once(self):
        self.assertEqual(sorted(e["scene"] for e in self.entries), sorted(SCENES))
        self.assertEqual(len({e["picture"] for e in self.entries}), len(self.entries))

    def test_every_scene_names_states_that_exist_and_the_picture_has_one_of_them(self):
        for entry in self.entries:
            scene = tomllib.loads(SCENES[entry["scene"]].read_text())
            states = [name.strip() for name in scene.get("state", "").split(",")]
            self.assertLessEqual(set(states), STATES, entry["scene"])
            self.assertIn(entry["state"], states, entry["scene"])

    def test_every_picture_is_there_and_small(self):
        for entry in self.entries:
            file = gallery.PICTURES / entry["picture"]
            self.assertTrue(file.is_file(), f"{entry['scene']}: /usr/bin/python3 bench/gallery.py build/barchan --only {file.stem}")
            self.assertLessEqual(file.stat().st_size, gallery.LARGEST, file)
            head = file.read_bytes()[:24]
            self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n", file)
            width, height = struct.unpack(">II", head[16:24])
            self.assertTrue(500 <= width <= 1000 and 120 <= height <= 1000, f"{file}: {width} x {height}")

    def test_the_list_says_what_is_seen_and_when(self):
        for entry in self.entries:
            self.assertRegex(entry["seen"], r"^[A-Z].{15,200}\.$", entry["scene"])
            self.assertGreater(entry["time"], 0, entry["scene"])
            self.assertTrue(all("=" in setting for setting in entry["settings"]), entry["scene"])

    def test_no_picture_without_a_scene(self):
        self.assertEqual({f"scenes/{file.name}" for file in (gallery.PICTURES / "scenes").iterdir()}, {e["picture"] for e in self.entries})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
