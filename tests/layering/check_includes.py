#!/usr/bin/env python3
"""Fails when an include points upwards. Standard library only.

    check_includes.py ROOT        checks every source file below ROOT
    check_includes.py --self-test plays wrong and right includes against the rules
"""
import pathlib
import re
import sys

# Folder -> folders that its files may include. The longest matching folder counts, on both sides.
# Run time code never includes a builder; vdr/ sees hlod/view and nothing else of hlod/.
RULES = {
    "ooc/base": {"ooc/base"},
    "ooc": {"ooc", "ooc/base"},
    "cache": {"cache", "ooc", "ooc/base"},
    "hlod/view": {"hlod/view", "cache", "ooc", "ooc/base"},
    "hlod/strategies": {"hlod/strategies", "hlod/view", "cache", "ooc", "ooc/base"},
    "hlod/raster": {"hlod/raster", "hlod/view", "cache", "ooc", "ooc/base"},
    "hlod/build": {"hlod/build", "ooc", "ooc/base"},
    "vdr": {"vdr", "hlod/view", "cache", "ooc", "ooc/base"},
    "vdr/build": {"vdr/build", "vdr", "ooc", "ooc/base"},
    "viewer": {"viewer", "hlod/view", "hlod/strategies", "hlod/raster", "vdr", "cache", "ooc",
               "ooc/base"},
    "tools": None,  # None: may include everything
    "tests": None,
}

# Outside headers that only some folders may include, and why.
OUTSIDE = [
    (re.compile(r"(epoxy|GL|GLES\d?|EGL|GLFW|KHR|glad)/|imgui|backends/imgui"),
     ("viewer", "tests"), "only viewer/ speaks to GL, EGL, GLFW and ImGui"),
    (re.compile(r"OpenMesh/"), ("vdr/build", "tests"), "OpenMesh is heavy to install"),
    (re.compile(r"embree\d?/"), ("tests",), "Embree serves the tests only"),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
SUFFIXES = {".h", ".hpp", ".cpp", ".inl", ".c"}


def folder_of(path):
    """The rule's folder for a path from the root, or None where no rule knows it."""
    matches = [folder for folder in RULES if path.startswith(folder + "/")]
    return max(matches, key=len, default=None)


def fault_of(path, quoted, angled):
    """What is wrong with one include in the file `path`, or None."""
    source = folder_of(path)
    if source is None:
        return "lies in no known folder"
    name = quoted or angled
    target = folder_of(name)
    if target is None:
        for pattern, allowed, why in OUTSIDE:
            if pattern.match(name) and not any(path.startswith(f + "/") for f in allowed):
                return f"includes {name}: {why}"
        return f'includes "{name}": write it from the repository root' if quoted else None
    if angled:
        return f"includes <{name}>: our own headers take quotes"
    if RULES[source] is not None and target not in RULES[source]:
        return f"includes {name}: {source}/ must not know {target}/"
    return None


def check_text(path, text):
    faults = []
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        fault = match and fault_of(path, match.group(1), match.group(2))
        if fault:
            faults.append(f"{path}:{number}: {fault}")
    return faults


def check_tree(root):
    files = [file for folder in sorted({f.split("/")[0] for f in RULES})
             for file in sorted((root / folder).rglob("*")) if file.suffix in SUFFIXES]
    if not files:
        return [f"{root}: no source files; is this the repository?"], 0
    faults = []
    for file in files:
        path = file.relative_to(root).as_posix()
        faults += check_text(path, file.read_text(encoding="utf-8"))
    return faults, len(files)


def self_test():
    wrong = [
        ("ooc/base/file.cpp", '#include "ooc/lattice.h"'),
        ("ooc/readers/ply.cpp", '#include "hlod/view/camera.h"'),
        ("cache/residency.h", '#include "hlod/strategies/frustum.h"'),
        ("hlod/view/camera.h", '#include "hlod/build/builder.h"'),
        ("hlod/strategies/coh.cpp", '#  include "viewer/device.h"'),
        ("hlod/strategies/coh.cpp", "#include <epoxy/gl.h>"),
        ("hlod/build/builder.cpp", '#include "hlod/view/camera.h"'),
        ("viewer/scene.cpp", '#include "hlod/build/builder.h"'),
        ("viewer/scene.cpp", '#include "device.h"'),
        ("viewer/scene.cpp", "#include <ooc/lattice.h>"),
        ("viewer/scene.cpp", '#include "tools/session.h"'),
        ("vdr/cut.h", '#include "hlod/strategies/frustum.h"'),
        ("vdr/cut.h", '#include "vdr/build/order.h"'),
        ("tools/commands/render.cpp", "#include <EGL/egl.h>"),
        ("hlod/build/merge.cpp", "#include <OpenMesh/Core/Mesh/TriMesh.hh>"),
    ]
    right = [
        ("ooc/store/database.h", '#include "ooc/base/file.h"'),
        ("vdr/cut.h", '#include "hlod/view/camera.h"'),
        ("viewer/device.cpp", "#include <epoxy/gl.h>"),
        ("tools/commands/build.cpp", '#include "hlod/build/builder.h"'),
        ("tests/viewer/truth_test.cpp", "#include <embree3/rtcore.h>"),
        ("hlod/build/merge.cpp", "// #include \"viewer/device.h\""),
        ("ooc/lattice.h", "#include <vector>"),
    ]
    faults = [f"missed: {path}: {line}" for path, line in wrong if not check_text(path, line)]
    for path, line in right:
        faults += ["wrongly found: " + fault for fault in check_text(path, line)]
    return faults, len(wrong) + len(right)


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    if arguments[0] == "--self-test":
        faults, count = self_test()
    else:
        faults, count = check_tree(pathlib.Path(arguments[0]))
    for fault in faults:
        print(fault)
    print(f"{count} checked, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
