#!/usr/bin/env python3
"""The window under real input events on a virtual screen.

    window_test.py PAGODA [FOLDER]    FOLDER: keeps what is written there

Truth comes from `pagoda render`, which shares no code with the window's loop, and from geometry.
Python 3 standard library, Xvfb and xdotool; exit code 77 without them."""
import array
import json
import math
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

from screen import Window, run_tests

WIDTH, HEIGHT = 640, 480


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def distance(a, b):
    return math.dist(a, b)


class Test:
    def __init__(self, binary, folder, screen):
        self.binary, self.folder, self.screen = binary, Path(folder), screen
        self.database = self.folder / "room.pagoda"
        self.run("generate", "interior", "--triangles", 60000, "-o", self.folder / "room.glb",
                 "--force")
        self.run("build", self.folder / "room.glb", "-o", self.database, "--up", "z",
                 "--node-triangles", 1024, "--force")
        info = json.loads(self.run("info", self.database, "--json").stdout)
        self.objects = info["objects"]
        self.middle = [(a + b) / 2 for a, b in zip(info["box"]["min"], info["box"]["max"])]

    def run(self, *arguments, **popen):
        return subprocess.run([self.binary, "--quiet", *map(str, arguments)], check=True,
                              capture_output=True, text=True, **popen)

    def open(self, *arguments):
        return Window(self.screen, self.binary, self.folder, self.database, "--size",
                      f"{WIDTH}x{HEIGHT}", *arguments)

    # Tests: what their names say.

    def test_the_first_picture_settles_and_a_still_window_draws_nothing(self):
        with self.open() as window:
            window.wait_settled(width=WIDTH, height=HEIGHT)
            # Keys that mean nothing and a mouse that only moves are handled before the screenshot.
            window.mark()
            window.move(300, 400)
            window.xdotool("key", "F7")
            window.xdotool("key", "p")
            window.wait_event("screenshot")
            since = [line["event"] for line in window.lines()[window.seen:]]
            check("frame" not in since, f"a still window drew frames: {since}")

    def test_dragging_turns_and_pans_and_the_wheel_goes_nearer(self):
        with self.open() as window:
            first = window.wait_settled()
            window.drag((320, 240), (420, 260))
            turned = window.wait_settled()
            check(distance(first["eye"], turned["eye"]) > 0.01, "the eye did not move")
            check(first["mode"] == turned["mode"] == "orbit", "the mode changed")
            window.drag((320, 240), (380, 240), button=3)
            panned = window.wait_settled()
            eye = [b - a for a, b in zip(turned["eye"], panned["eye"])]
            target = [b - a for a, b in zip(turned["target"], panned["target"])]
            check(distance(eye, [0, 0, 0]) > 0.01, "panning did not move the eye")
            check(distance(eye, target) < 1e-6 * distance(panned["eye"], [0, 0, 0]),
                  "panning turned the view")
            window.click(320, 240)
            picked = window.wait_event("pick")["point"]
            window.click(320, 240, button=4)
            # The pick's box and what the leaves said may have asked for a frame of the old view.
            nearer = window.wait_for("another view", lambda line: line["event"] == "frame" and
                                     line["settled"] and line["eye"] != panned["eye"])
            check(distance(nearer["eye"], picked) < distance(panned["eye"], picked),
                  "the wheel did not go nearer to what is under the cursor")

    def test_keys_frame_axis_views_modes_strategies_and_tau(self):
        with self.open("--strategy", "frustum") as window:
            first = window.wait_settled()
            window.key("5")
            top = window.wait_settled()
            along = [t - e for e, t in zip(top["eye"], top["target"])]
            check(abs(along[2]) > 0.999 * distance(along, [0, 0, 0]) and along[2] < 0,
                  f"the view from the top looks along {along}")
            window.key("h")
            home = window.wait_settled()
            check(distance(home["eye"], first["eye"]) < 1e-9 * distance(first["eye"], [0, 0, 0]),
                  "home is elsewhere")
            window.key("ctrl+c")
            window.wait_event("camera")
            window.key("7")
            window.wait_settled()
            window.key("ctrl+v")
            pasted = window.wait_settled()
            check(distance(pasted["eye"], home["eye"]) < 1e-9 * distance(home["eye"], [0, 0, 0]),
                  "the pasted camera is not the copied one")
            window.key("t")
            check(window.wait_settled()["strategy"] == "bool", "T did not switch the strategy")
            window.key("period")
            check(window.wait_settled()["tau"] > home["tau"], "tau did not rise")
            window.key("g")
            check(window.wait_settled()["mode"] == "fly", "G does not fly")
            before = window.frames()[-1]["eye"]
            window.mark()
            window.xdotool("keydown", "w", "sleep", "0.2", "keyup", "w")
            check(distance(window.wait_settled()["eye"], before) > 1e-3, "W does not fly on")

    def test_a_pick_is_where_render_says_and_a_screenshot_is_its_picture(self):
        with self.open("--strategy", "frustum") as window:
            window.wait_settled()
            window.key("ctrl+c")
            camera = json.loads(window.wait_event("camera")["json"])
            window.key("p")
            shot = Path(window.wait_event("screenshot")["file"])
            window.click(250, 300)
            pick = window.wait_event("pick")
        exact = self.folder / "exact.png"
        depth, ids = self.folder / "exact.pfm", self.folder / "exact.ids"
        camera_file = self.folder / "camera.json"
        camera_file.write_text(json.dumps(camera))
        self.run("render", self.database, "-o", exact, "--camera", camera_file, "--strategy",
                 "frustum", "--depth", depth, "--ids", ids)
        check(shot.read_bytes() == exact.read_bytes(), "the screenshot is not render's picture")
        pixels = array.array("f", depth.read_bytes()[-4 * WIDTH * HEIGHT:])
        along = pixels[(HEIGHT - 1 - 300) * WIDTH + 250]
        forward = [t - e for e, t in zip(camera["eye"], camera["target"])]
        length = distance(forward, [0, 0, 0])
        seen = sum((p - e) * f / length for p, e, f in zip(pick["point"], camera["eye"], forward))
        check(abs(seen - along) < 1e-5 * along, f"picked at {seen}, render says {along}")
        table = json.loads((self.folder / "exact.ids.json").read_text())
        words = array.array("I", ids.read_bytes())
        node, triangle = words[2 * (300 * WIDTH + 250):][:2]
        check(pick["node"] == table["nodes"][node - 1] and pick["triangle"] == triangle,
              f"picked {pick}, render drew {table['nodes'][node - 1]} {triangle}")

    def test_a_click_names_the_object_and_hiding_it_shows_what_is_behind(self):
        camera = json.dumps({"eye": [-9, -7, 12], "target": [4, 4, 1.5], "up": [0, 0, 1]})
        with self.open("--strategy", "coh", "--tau", 8, "--camera", camera) as window:
            window.wait_settled()
            window.click(330, 250)
            first = window.wait_event("exact")
            check(first["path"] and first["faults"] == [], f"no name: {first}")
            window.key("Delete")
            check(window.wait_for("something hidden", lambda line: line["event"] == "frame" and
                                  line["settled"] and line["hidden_objects"] > 0), "")
            window.click(330, 250)
            second = window.wait_event("exact")
            check(second["point"] is None or second["object"] != first["object"],
                  "the hidden object was picked")
            if second["point"]:
                eye = json.loads(camera)["eye"]
                check(distance(second["point"], eye) > distance(first["point"], eye),
                      "what is behind is nearer")
                check(abs(second["from_last"] - distance(second["point"], first["point"])) < 1e-9,
                      "the distance between both picks is wrong")
            window.key("u")
            window.wait_settled(hidden_objects=0)
            window.click(330, 250)
            check(window.wait_event("exact")["object"] == first["object"], "it did not come back")
            window.key("shift+Delete")
            window.wait_for("the others hidden", lambda line: line["event"] == "frame" and
                            line["settled"] and line["hidden_objects"] > 0)
            window.click(330, 250)
            check(window.wait_event("exact")["object"] == first["object"], "it is not alone")

    def test_a_pick_is_exact_whatever_is_resident(self):
        camera = json.dumps({"eye": [-9, -7, 12], "target": [4, 4, 1.5], "up": [0, 0, 1]})
        points = []
        for tau in (64, 0.25):
            with self.open("--strategy", "frustum", "--tau", tau, "--camera", camera) as window:
                window.wait_settled()
                window.click(300, 280)
                points.append(window.wait_event("exact"))
        for key in ("point", "leaf", "triangle", "object", "path"):
            check(points[0][key] == points[1][key], f"{key} depends on tau: {points}")

    def test_a_section_lets_the_eye_and_the_pick_in(self):
        with self.open("--strategy", "coh") as window:
            window.wait_settled()
            window.click(330, 250)
            before = window.wait_event("exact")
            window.key("n")
            window.wait_settled(section=True)
            window.click(330, 250)
            after = window.wait_event("exact")
            check(after["point"] is None or after["point"] != before["point"],
                  "the cut away surface was picked")
            if after["point"]:
                # The default plane: x, in the middle; what is greater is cut away.
                check(after["point"][0] <= self.middle[0] + 1e-6, f"{after} lies beyond the plane")
            window.key("n")
            window.wait_settled(section=False)

    def test_the_tree_of_objects_is_read_when_it_is_opened_and_names_are_found(self):
        with self.open() as window:
            window.wait_settled()
            check(not [line for line in window.lines() if line["event"] == "objects"],
                  "objects were read though nobody asked")
            window.key("b")
            window.wait_for("rows of the tree", lambda line: line["event"] == "objects" and
                            line["tree"] == self.objects and line["rows"] > 0)
            window.click(500, 57)  # the search
            window.xdotool("type", "oo")
            found = window.wait_for("matches", lambda line: line["event"] == "objects" and
                                    line["matches"] > 0 and not line["searching"])
            check(found["matches"] <= self.objects, f"{found}")

    def test_what_is_frozen_stays_while_the_eye_leaves(self):
        with self.open("--strategy", "coh") as window:
            first = window.wait_settled()
            window.key("z")
            frozen = window.wait_settled(frozen=True)
            check(frozen["drawn_nodes"] == first["drawn_nodes"], "freezing changed the cut")
            window.key("5")
            above = window.wait_settled(frozen=True)
            check(above["drawn_nodes"] <= frozen["drawn_nodes"], "the frozen cut grew")
            check(above["eye"] != frozen["eye"], "the eye stayed")
            window.key("z")
            window.wait_settled(frozen=False)

    def test_the_picture_follows_the_windows_size(self):
        with self.open() as window:
            window.wait_settled()
            window.resize(800, 500)
            window.wait_event("resized", width=800, height=500)
            window.wait_settled(width=800, height=500)

    def test_a_recorded_path_is_replayed_frame_by_frame(self):
        with self.open() as window:
            window.wait_settled()
            window.key("r")
            window.drag((320, 240), (390, 200))
            window.wait_settled()
            window.key("p")
            first = Path(window.wait_event("screenshot")["file"])
            window.key("r")
            written = window.wait_event("path")
            path = json.loads(Path(written["file"]).read_text())
            check(len(path["frames"]) == written["frames"] >= 2, "the path is too short")
            window.key("h")
            window.wait_settled()
            window.key("shift+r")
            window.wait_event("message", text="replayed")
            eyes = [line["eye"] for line in window.lines()[window.seen:] if line["event"] == "frame"]
            for number, frame in enumerate(path["frames"]):
                check(frame["eye"] in eyes, f"frame {number} of the path was not drawn")
            window.key("p")
            second = Path(window.wait_event("screenshot")["file"])
            check(first.read_bytes() == second.read_bytes(), "the replay's picture differs")

    def test_a_dropped_database_opens_and_what_is_none_is_said_in_the_window(self):
        other = self.folder / "other.pagoda"
        shutil.copy(self.database, other)
        wrong = self.folder / "wrong.pagoda"
        wrong.write_bytes(b"no database at all" * 100)
        with self.open() as window:
            window.wait_settled()
            window.drop(wrong)
            said = window.wait_event("message", is_error=True)
            check("wrong.pagoda" in said["text"], said["text"])
            window.drop(other)
            check(window.wait_event("opened")["file"] == str(other), "another file was opened")
            window.wait_settled()

    def test_it_closes_while_it_loads(self):
        with self.open("--disk", "1MB/s,200ms") as window:
            window.wait_for("a frame with pages missing", lambda line: line["event"] == "frame" and
                            line["missing_pages"] > 0)
            window.key("ctrl+q")
            code, err = window.end()
            check(code == 0 and not err, f"exit code {code}: {err}")
            check(window.lines()[-1]["event"] == "closed", "it did not come to its end")

    def test_a_view_beside_the_model_comes_to_rest(self):
        camera = '{"eye": [100, 100, 100], "target": [200, 200, 200], "up": [0, 0, 1]}'
        with self.open("--camera", camera) as window:
            check(window.wait_settled()["drawn_nodes"] == 0, "something is in view")

    def test_ctrl_c_in_the_terminal_ends_it(self):
        with self.open() as window:
            window.wait_settled()
            window.process.send_signal(signal.SIGINT)
            code, _ = window.end()
            check(code == 130, f"exit code {code}")

    def test_without_a_display_it_names_the_commands_that_need_none(self):
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        run = subprocess.run([self.binary, "view", self.database], env=environment,
                             capture_output=True, text=True)
        check(run.returncode == 1, f"exit code {run.returncode}")
        check("pagoda render" in run.stderr and run.stderr.count("\n") == 1, run.stderr)

    def test_what_is_no_database_is_said_in_one_line(self):
        broken = self.folder / "broken.pagoda"
        broken.write_bytes(b"no database at all" * 100)
        window = Window(self.screen, self.binary, self.folder, broken)
        code, err = window.end()
        check(code == 1 and "broken.pagoda" in err and err.count("\n") == 1, err)


if __name__ == "__main__":
    sys.exit(run_tests(Test, __doc__, sys.argv[1:]))
