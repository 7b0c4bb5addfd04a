#!/usr/bin/env python3
"""How soon `pagoda view` shows a raw model recognisably, with nothing built yet.

    first_picture.py PAGODA [--triangles N] [--runs N] [--keep FOLDER] [--warm] [--whole]

A torus is generated as binary PLY, its pages are dropped from the page cache, and the window opens it
on a virtual screen, 640x480, with an empty cache of databases. Screenshots follow each other (the P
key) for some seconds; the first whose silhouette meets that of `pagoda render --reference` by an intersection over
union of the goal gives the time, from the start of the process to the screenshot's end (so writing
the PNG counts). The reference is a torus of a million triangles, the same but for 2e-6 of its size.
Memory: the greatest anonymous resident set until the last screenshot, and until the window is
closed. Prints JSON.
Xvfb, xdotool, Python 3 standard library."""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "window"))
from picture import intersection_over_union, silhouette_of_depth, silhouette_of_png  # noqa: E402
from screen import Screen, Window  # noqa: E402

WIDTH, HEIGHT = 640, 480
CAMERA = {"eye": [24, -30, 22], "target": [0, 0, 0], "up": [0, 0, 1], "width": WIDTH,
          "height": HEIGHT}


def drop_from_page_cache(path):
    with open(path, "rb") as file:
        os.fsync(file.fileno())
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


class AnonymousPeak(threading.Thread):
    """Watches RssAnon of a process, in bytes."""

    def __init__(self, pid):
        super().__init__(daemon=True)
        self.path, self.peak = f"/proc/{pid}/status", 0
        self.start()

    def run(self):
        while True:
            try:
                for line in Path(self.path).read_text().splitlines():
                    if line.startswith("RssAnon"):
                        self.peak = max(self.peak, 1024 * int(line.split()[1]))
            except OSError:
                return
            time.sleep(0.01)


def measure(options, folder, screen, truth, model):
    cache = folder / "cache"
    shutil.rmtree(cache, ignore_errors=True)
    if not options.warm:
        drop_from_page_cache(model)
    with Window(screen, options.binary, folder, model, "--cache", cache, "--size",
                f"{WIDTH}x{HEIGHT}", "--camera", json.dumps(CAMERA)) as window:
        memory = AnonymousPeak(window.process.pid)
        first = window.wait_event("preview")
        shots = []  # one after the other; they are looked at afterwards, which takes its time
        while not shots or shots[-1]["steady_s"] < window.started + options.seconds:
            window.key("p")
            shots.append(window.wait_event("screenshot"))
        result = {"first_preview_s": first["steady_s"] - window.started, "recognisable_s": None,
                  "screenshots": len(shots), "peak_bytes": memory.peak}
        for shot in shots:
            likeness = intersection_over_union(silhouette_of_png(shot["file"]), truth)
            result.update(likeness=likeness, picture=shot["file"])
            if likeness >= options.goal:
                result["recognisable_s"] = shot["steady_s"] - window.started
                break
        if options.whole:
            window.seen = 0
            whole = window.wait_event("preview", is_whole=True)
            window.key("p")
            shot = window.wait_event("screenshot")
            result.update(whole_s=whole["steady_s"] - window.started,
                          whole_likeness=intersection_over_union(silhouette_of_png(shot["file"]),
                                                                 truth))
        window.key("ctrl+q")
        result["exit_code"] = window.end()[0]
        result["peak_bytes_at_end"] = memory.peak
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", type=lambda text: Path(text).resolve())
    parser.add_argument("--triangles", type=int, default=10_000_000)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--goal", type=float, default=0.9)
    parser.add_argument("--seconds", type=float, default=4, help="how long screenshots are taken")
    parser.add_argument("--warm", action="store_true", help="the model stays in the page cache")
    parser.add_argument("--whole", action="store_true", help="also when all has been read")
    parser.add_argument("--keep", type=Path, help="folder that keeps models and pictures")
    options = parser.parse_args()

    def run(*arguments):
        subprocess.run([options.binary, "--quiet", *map(str, arguments)], check=True,
                       stdout=subprocess.DEVNULL)

    with tempfile.TemporaryDirectory() as temporary, Screen() as screen:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        model = folder / f"torus-{options.triangles}.ply"
        depth = folder / "truth.pfm"
        if not model.exists():
            run("generate", "torus", "--triangles", options.triangles, "-o", model)
        if not depth.exists():
            run("generate", "torus", "--triangles", 1_000_000, "-o", folder / "truth.ply", "--force")
            run("build", folder / "truth.ply", "-o", folder / "truth.pagoda", "--force")
            run("render", folder / "truth.pagoda", "-o", folder / "truth.png", "--reference",
                "--depth", depth, "--camera", json.dumps(CAMERA))
        truth = silhouette_of_depth(depth, WIDTH, HEIGHT)
        for _ in range(options.runs):
            print(json.dumps(measure(options, folder, screen, truth, model)), flush=True)


if __name__ == "__main__":
    main()
