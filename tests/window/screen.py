"""A virtual screen (Xvfb), real input events on it (xdotool) and the window's own log. Nothing waits
for a time to pass: all waits are for a line in the log, and end only with a failure."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PATIENCE_S = 120  # a sanitized build on a busy machine; what is waited for comes much sooner


class Screen:
    """An Xvfb of its own; the display's number is chosen by the server."""

    def __init__(self, width=1280, height=800):
        read, write = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24",
             "-nolisten", "tcp"], pass_fds=[write], stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.display = ":" + number.readline().strip()
        if self.display == ":":
            raise RuntimeError("Xvfb does not start")
        self.environment = dict(os.environ, DISPLAY=self.display)
        for name in ("WAYLAND_DISPLAY", "XAUTHORITY"):
            self.environment.pop(name, None)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


class Window:
    """`pagoda view` on a screen."""

    def __init__(self, screen, binary, folder, *arguments):
        self.screen = screen
        self.log = Path(folder) / "state.jsonl"
        self.log.unlink(missing_ok=True)
        self.started = time.monotonic()
        self.process = subprocess.Popen(
            [str(binary), "view", *map(str, arguments), "--log-state", str(self.log),
             "--output-folder", str(folder)],
            env=screen.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True)
        self.seen = 0  # lines that what comes next must come after

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def lines(self):
        if not self.log.exists():
            return []
        return [json.loads(line) for line in self.log.read_text().split("\n")[:-1]]

    def mark(self):
        """What is waited for from now on happens after this."""
        self.seen = len(self.lines())

    def wait_for(self, what, condition):
        """The first line since mark() that meets `condition`."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            lines = self.lines()
            for line in lines[self.seen:]:
                if condition(line):
                    return line
            if self.process.poll() is not None:
                raise AssertionError(f"{what}: the window ended, {self.process.returncode}: "
                                     f"{self.process.stderr.read()}")
            time.sleep(0.01)
        raise AssertionError(f"{what}: never happened; the last lines: {self.lines()[-3:]}")

    def wait_event(self, event, **values):
        return self.wait_for(f"{event} {values}", lambda line: line["event"] == event and all(
            line.get(key) == value for key, value in values.items()))

    def wait_settled(self, **values):
        return self.wait_event("frame", settled=True, **values)

    def frames(self):
        return [line for line in self.lines() if line["event"] == "frame"]

    def xdotool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.screen.environment,
                              check=True, capture_output=True, text=True).stdout

    def key(self, name):
        self.mark()
        self.xdotool("key", name)

    def move(self, x, y):
        self.xdotool("mousemove", x, y)

    def click(self, x, y, button=1):
        self.mark()
        self.xdotool("mousemove", x, y, "click", button)

    def drag(self, begin, end, button=1, steps=6):
        """A button held from one place to another, by some places between."""
        self.mark()
        arguments = ["mousemove", *begin, "mousedown", button]
        for step in range(1, steps + 1):
            x = begin[0] + (end[0] - begin[0]) * step // steps
            y = begin[1] + (end[1] - begin[1]) * step // steps
            arguments += ["mousemove", x, y, "sleep", "0.02"]
        self.xdotool(*arguments, "mouseup", button)

    def resize(self, width, height):
        self.mark()
        window = self.xdotool("search", "--name", "Pagoda").split()[0]
        self.xdotool("windowsize", window, width, height)

    def drop(self, file):
        self.mark()
        window = self.xdotool("search", "--name", "Pagoda").split()[0]
        subprocess.run([sys.executable, Path(__file__).parent / "drop.py", window, file],
                       env=self.screen.environment, check=True, timeout=PATIENCE_S)

    def end(self):
        """Waits for the end: (exit code, stderr)."""
        _, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, err


def run_tests(test_class, usage, arguments):
    """Runs every test_... of `test_class`(binary, folder, screen) whose name holds $ONLY; returns the
    exit code. `arguments`: PAGODA [FOLDER]; the folder keeps what is written there."""
    if len(arguments) not in (1, 2):
        print(usage, file=sys.stderr)
        return 2
    missing = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
    if missing:
        print(f"SKIPPED: the window is not tested: no {' and no '.join(missing)}; "
              "tools/install-packages.sh test", file=sys.stderr)
        return 77
    failures = 0
    with tempfile.TemporaryDirectory() as temporary, Screen() as screen:
        folder = arguments[1] if len(arguments) == 2 else temporary
        test = test_class(Path(arguments[0]).resolve(), folder, screen)
        only = os.environ.get("ONLY", "")
        for name in [n for n in dir(test_class) if n.startswith("test_") and only in n]:
            try:
                getattr(test, name)()
                print("passed", name[5:].replace("_", " "), flush=True)
            except (AssertionError, subprocess.SubprocessError) as error:
                failures += 1
                print("FAILED", name[5:].replace("_", " ") + ":", error, flush=True)
    return 1 if failures else 0
