#!/usr/bin/env python3
"""Raw models in the window: shown coarsely, built, kept, cancelled, refused.

    opening_test.py PAGODA [FOLDER]    FOLDER: keeps what is written there

Truth comes from `pagoda build` and `pagoda render`. Python 3 standard library, Xvfb and xdotool;
exit code 77 without them."""
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

from picture import intersection_over_union, silhouette_of_depth, silhouette_of_png
from screen import Window, run_tests

WIDTH, HEIGHT = 640, 480
CAMERA = {"eye": [24, -30, 22], "target": [0, 0, 0], "up": [0, 0, 1]}


def check(condition, what):
    if not condition:
        raise AssertionError(what)


class Test:
    def __init__(self, binary, folder, screen):
        self.binary, self.folder, self.screen = binary, Path(folder), screen
        self.cache = self.folder / "cache"
        self.model = self.folder / "torus.ply"
        self.database = self.folder / "truth.pagoda"
        self.run("generate", "torus", "--triangles", 300000, "-o", self.model, "--force")
        self.run("build", self.model, "-o", self.database, "--force")

    def run(self, *arguments):
        return subprocess.run([self.binary, "--quiet", *map(str, arguments)], check=True,
                              capture_output=True, text=True)

    def open(self, *arguments, empties_cache=True):
        if empties_cache:
            shutil.rmtree(self.cache, ignore_errors=True)
        return Window(self.screen, self.binary, self.folder, *arguments, "--cache", self.cache,
                      "--threads", 1, "--size", f"{WIDTH}x{HEIGHT}")

    def cached(self):
        """What of databases, whole or not, is in the cache."""
        return [path for path in self.cache.rglob("*") if ".pagoda" in path.name]

    # Tests: what their names say.

    def test_a_coarse_picture_has_the_models_outline_and_the_database_its_every_byte(self):
        with self.open(self.model, "--camera", json.dumps(CAMERA)) as window:
            preview = window.wait_event("preview")
            check(preview["width"] == WIDTH and preview["discs"] > 0, preview)
            window.key("p")
            shot = Path(window.wait_event("screenshot")["file"])
            check(not any(line["event"] == "made" for line in window.lines()),
                  "the build was over before the picture was taken")
            window.seen = 0
            made = window.wait_event("made", is_built=True)
            window.wait_settled()
        depth = self.folder / "truth.pfm"
        self.run("render", self.database, "-o", self.folder / "truth.png", "--reference", "--depth",
                 depth, "--camera", json.dumps(dict(CAMERA, width=WIDTH, height=HEIGHT)))
        likeness = intersection_over_union(silhouette_of_png(shot),
                                           silhouette_of_depth(depth, WIDTH, HEIGHT))
        check(likeness >= 0.9, f"the silhouettes' intersection over union is {likeness:.3f}")
        built = Path(made["database"])
        check(built.read_bytes() == self.database.read_bytes(), "not what pagoda build makes")

    def test_one_moves_about_while_it_is_built_and_the_camera_stays_then(self):
        def along(line):
            way = [t - e for e, t in zip(line["eye"], line["target"])]
            return [x / math.dist(way, [0, 0, 0]) for x in way]

        def angle(line, other):
            return math.acos(min(1, sum(p * q for p, q in zip(along(line), along(other)))))

        def is_from_the_top(line):
            return along(line)[2] < -0.999

        with self.open(self.model) as window:
            first = window.wait_event("preview")
            window.drag((320, 240), (420, 260))
            window.wait_for("a turned preview", lambda line: line["event"] == "preview" and
                            angle(line, first) > 0.1)
            window.key("5")
            window.wait_for("a preview from the top", lambda line: line["event"] == "preview" and
                            is_from_the_top(line))
            check(not any(line["event"] == "made" for line in window.lines()),
                  "the build was over before the hand had moved")
            window.wait_event("opened")
            check(is_from_the_top(window.wait_settled()), "the camera jumped")

    def test_what_was_built_opens_from_the_cache_and_what_has_changed_is_built_anew(self):
        copy = self.folder / "copy.ply"
        shutil.copy(self.model, copy)
        with self.open(copy) as window:
            first = window.wait_event("made", is_built=True)["database"]
        with self.open(self.model, empties_cache=False) as window:  # the same under another name
            again = window.wait_event("made")
            check(again["database"] == first and not again["is_built"], again)
            stages = [line["stage"] for line in window.lines() if line["event"] == "stage"]
            check("survey" not in stages, f"it was built again: {stages}")
            window.wait_settled()
        data = bytearray(copy.read_bytes())
        data[len(data) // 4] ^= 1  # a coordinate
        times = os.stat(copy)
        copy.write_bytes(data)
        os.utime(copy, ns=(times.st_atime_ns, times.st_mtime_ns))
        with self.open(copy, empties_cache=False) as window:
            changed = window.wait_event("made")
            check(changed["database"] != first and changed["is_built"], changed)

    def test_escape_cancels_and_leaves_nothing_half_written_but_the_picture(self):
        with self.open(self.model) as window:
            window.wait_event("preview")
            window.key("Escape")
            window.wait_event("cancelled")
            check(not self.cached(), f"left in the cache: {self.cached()}")
            window.key("5")
            window.wait_event("preview")  # one moves about in what there is
            window.drop(self.model)
            window.wait_event("made", is_built=True)

    def test_it_closes_while_it_builds_and_leaves_nothing(self):
        with self.open(self.model) as window:
            window.wait_event("stage", stage="build nodes")
            window.key("ctrl+q")
            code, err = window.end()
            check(code == 0 and not err, f"exit code {code}: {err}")
            check(not self.cached(), f"left in the cache: {self.cached()}")

    def test_a_broken_model_is_named_in_the_window_which_goes_on(self):
        broken = self.folder / "broken.ply"
        broken.write_bytes(self.model.read_bytes()[:100000])
        with self.open(self.model) as window:
            window.wait_event("opened")
            window.drop(broken)
            said = window.wait_event("message", is_error=True)["text"]
            check("broken.ply" in said and ";" in said, said)
            window.key("5")
            window.wait_settled()  # what was open stays
        with self.open(broken) as window:
            said = window.wait_event("message", is_error=True)["text"]
            check("broken.ply" in said, said)
            check(window.process.poll() is None, "the window has gone")

    def test_a_model_without_random_access_shows_what_has_come_so_far(self):
        for name in ("hall.glb", "hall.obj"):
            model = self.folder / name
            self.run("generate", "interior", "--triangles", 100000, "-o", model, "--force")
            with self.open(model) as window:
                check(window.wait_event("preview")["triangles_seen"] > 0, "nothing was seen")
                window.wait_event("preview", is_whole=True)
                window.wait_event("made", is_built=True)
                window.wait_settled()

    def test_what_is_no_model_is_said_in_one_line(self):
        for name, word in (("notes.txt", "notes.txt"), ("house.ifc", "IfcConvert"),
                           ("nowhere.ply", "nowhere.ply")):
            path = self.folder / name
            if name != "nowhere.ply":
                path.write_text("nothing")
            code, err = self.open(path).end()
            check(code == 1 and word in err and err.count("\n") == 1, err)

    def test_without_a_display_it_names_the_commands_that_need_none(self):
        environment = {k: v for k, v in os.environ.items()
                       if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        run = subprocess.run([self.binary, "view", self.model, "--cache", self.cache],
                             env=environment, capture_output=True, text=True)
        check(run.returncode == 1, f"exit code {run.returncode}")
        check("build" in run.stderr and "render" in run.stderr and run.stderr.count("\n") == 1,
              run.stderr)


if __name__ == "__main__":
    sys.exit(run_tests(Test, __doc__, sys.argv[1:]))
