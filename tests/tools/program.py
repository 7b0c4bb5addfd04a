"""The program `pagoda` as a script sees it: what it says, its exit code, its peak memory, and what
it leaves in a folder. For the tests beside this file; Python 3 standard library only."""
import collections
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

Run = collections.namedtuple("Run", "code out err peak_bytes")  # code < 0: that signal; None: timeout


class Program:
    def __init__(self, binary):
        self.binary = str(binary)

    def start(self, *arguments, **popen):
        """Popen with pipes; for tests that send signals."""
        popen.setdefault("stdout", subprocess.PIPE)
        popen.setdefault("stderr", subprocess.PIPE)
        return subprocess.Popen([self.binary, *map(str, arguments)], stdin=subprocess.DEVNULL, **popen)

    def run(self, *arguments, timeout=None, **popen):
        """Runs to the end; the peak is that of this process alone (wait4, not a sum of children)."""
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            process = self.start(*arguments, stdout=out, stderr=err, **popen)
            late = threading.Event()

            def kill():
                late.set()
                os.kill(process.pid, 9)  # not reaped yet: wait4() below is the only one that reaps

            timer = threading.Timer(timeout, kill) if timeout else None
            if timer:
                timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            if timer:
                timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            texts = []
            for stream in (out, err):
                stream.seek(0)
                texts.append(stream.read().decode("utf-8", "replace"))
            code = None if late.is_set() else process.returncode
            return Run(code, *texts, usage.ru_maxrss * 1024)


def is_one_error_line(run):
    """Exit code 1 and what every failure promises: one line that begins with the program."""
    return run.code == 1 and run.err.startswith("pagoda: ") and run.err.count("\n") == 1 \
        and run.err.endswith("\n") and len(run.err) < 1000


class Folder:
    """A new folder for one run; names() is what lies in it."""

    def __init__(self, parent=None):
        self.path = Path(tempfile.mkdtemp(prefix="pagoda-test-", dir=parent))

    def names(self):
        return sorted(os.listdir(self.path))

    def __truediv__(self, name):
        return self.path / name

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)


def counted_models(data):
    """stats.json of the test models: name -> counts. Leaves loudly (ctest: skipped) without it."""
    stats = Path(data) / "stats.json"
    if not stats.is_file():
        print(f"SKIPPED: no models in {data}; set PAGODA_TEST_DATA")
        sys.exit(77)
    return json.loads(stats.read_text())
