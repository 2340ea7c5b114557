#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy-14 on the sources of src/: tidy.py BUILD_FOLDER JOBS

Most of its time goes into headers of FCL, Eigen and the standard library, which each source
reads again. So the sources of a folder are checked as one text, with #line directives that keep
names and numbers of lines. Sources that do not compile together, for example because two of
them have a constant of one name, are checked in smaller groups.
"""

import collections
import concurrent.futures
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

BUILD, JOBS = Path(sys.argv[1]).resolve(), int(sys.argv[2])
SOURCE = Path(__file__).resolve().parent.parent
WORK = BUILD / "tidy"


def groups():
    """The sources that are compiled alike, by folder. One that includes itself is alone."""
    found = collections.defaultdict(list)
    for entry in json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8")):
        paths = [path for path in compiled(Path(entry["file"])) if SOURCE / "src" in path.parents]
        if not paths:
            continue
        command = shlex.split(entry["command"])
        if "ccache" in command[0]:
            command = command[1:]
        for option in ("-o", "-c"):
            at = command.index(option)
            del command[at : at + 2]
        command = without_precompiled(command)
        for path in paths:
            alone = "foreach_target.h" in path.read_text(encoding="utf-8")
            found[path if alone else path.parent, tuple(command)].append(path)
    return [(list(command), sorted(paths)) for (_, command), paths in found.items()]


def compiled(file):
    """The sources that the compiler reads in this file: those that CMake has joined, or itself."""
    if "Unity" not in file.parts:
        return [file]
    return [Path(name) for name in re.findall('#include "(.*)"', file.read_text(encoding="utf-8"))]


def without_precompiled(command):
    """The command without CMake's precompiled header, which another compiler cannot read."""
    left = []
    words = iter(word for word in command if word != "-Xclang")
    for word in words:
        if word in ("-include", "-include-pch"):
            next(words)
        elif word != "-Winvalid-pch":
            left.append(word)
    return left


def joined(command, paths):
    """The command for all sources as one file."""
    if len(paths) == 1:
        return [*command, "-c", str(paths[0])]
    folder, size = paths[0].parent, len(paths)
    name = f"{folder.relative_to(SOURCE)}/{paths[0].stem}_and_{size - 1}_more.cpp"
    file = WORK / name.replace("/", "_")
    texts = [f'#line 1 "{path}"\n{path.read_text(encoding="utf-8")}' for path in paths]
    file.write_text("\n".join(texts), encoding="utf-8")
    return [*command, "-iquote", str(folder), "-c", str(file)]


def refused(command, paths):
    """The sources in which the compiler finds errors, or all if they are elsewhere."""
    silent = [*command, "-fsyntax-only", "-w", "-ferror-limit=0"]
    done = subprocess.run(silent, cwd=BUILD, capture_output=True, text=True, check=False)
    named = [path for path in paths if re.search(f"^{path}:[0-9:]* error", done.stderr, re.MULTILINE)]
    return named if named or done.returncode == 0 else paths


def parts(command, paths):
    """Groups of these sources that compile."""
    if len(paths) == 1:
        return [paths]
    wrong = refused(joined(command, paths), paths)
    if not wrong:
        return [paths]
    # What is left compiles, most often; if not, the halves.
    left = [path for path in paths if path not in wrong]
    if not left:
        left, wrong = paths[: len(paths) // 2], paths[len(paths) // 2 :]
    return parts(command, left) + parts(command, wrong)


def findings(command):
    """What clang-tidy says, or nothing."""
    source = command[-1]
    # A database of its own: clang-tidy reads all of it.
    database = WORK / (source.replace("/", "_") + "_database")
    database.mkdir(exist_ok=True)
    entry = {"directory": str(BUILD), "arguments": command, "file": source}
    (database / "compile_commands.json").write_text(json.dumps([entry]), encoding="utf-8")
    tidy = ["clang-tidy-14", "--quiet", f"--config-file={SOURCE / '.clang-tidy'}", "-p", str(database)]
    # Its stderr only counts findings in headers of other projects.
    done = subprocess.run([*tidy, source], capture_output=True, text=True, check=False)
    return (done.stdout or done.stderr) if done.returncode != 0 else ""


def check(command, paths):
    """The findings of a group. Those of sources that were joined are looked for in each one."""
    found = []
    for part in parts(command, paths):
        text = findings(joined(command, part))
        if text and len(part) > 1:
            found += [findings(joined(command, [path])) for path in part]
        else:
            found.append(text)
        place = part[0] if len(part) == 1 else part[0].parent
        print(f"   {place.relative_to(SOURCE)} ({len(part)} of {len(paths)} files)", flush=True)
    return found


def main():
    WORK.mkdir(exist_ok=True)
    # The largest first, so that the last one is short.
    work = sorted(groups(), key=lambda group: -sum(path.stat().st_size for path in group[1]))
    assert sum(len(paths) for _, paths in work) == len(list((SOURCE / "src").rglob("*.cpp")))
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        texts = [text for found in pool.map(lambda group: check(*group), work) for text in found]
    found = [text for text in texts if text]
    print("\n".join(found), end="")
    sys.exit(1 if found else 0)


main()
