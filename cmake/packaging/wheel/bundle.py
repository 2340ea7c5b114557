#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Puts the libraries that a wheel needs into it: bundle.py WHEEL OUT_FOLDER

What auditwheel does, which Debian does not have: each library that is not part of every Linux
system is copied into fcl_ccd.libs under a name of its own, so that no other copy is taken for it,
and is found beside the module. The tag says which glibc is needed. Needs patchelf, objdump and
python3-wheel.
"""

import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Every system has these; they must be as new as those of the machine that made the wheel.
SYSTEM = re.compile(r"(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so.*")


def run(*command: object) -> str:
    words = [str(word) for word in command]
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def needed(file: Path, place: Path) -> "dict[str, Path]":
    """The libraries that the loader takes for a file, by the names that the file has for them.

    place: where the file was copied from, which has its own neighbours.
    """
    direct = set(run("patchelf", "--print-needed", file).split())
    found = re.findall(r"^\s*(\S+) => (\S+) \(", run("ldd", place), re.MULTILINE)
    libraries = {name: Path(path) for name, path in found if name in direct}
    missing = {name for name in direct - libraries.keys() if not SYSTEM.fullmatch(name)}
    if missing:
        sys.exit(f"{file.name} needs {', '.join(sorted(missing))}, which the loader does not find")
    return {name: path for name, path in libraries.items() if not SYSTEM.fullmatch(name)}


def own_name(library: Path) -> str:
    """libfcl.so.0.7 becomes libfcl-1a2b3c4d.so.0.7."""
    digest = hashlib.sha256(library.read_bytes()).hexdigest()[:8]
    stem, rest = library.name.split(".so", 1)
    return f"{stem}-{digest}.so{rest}"


def bundle(module: Path, folder: Path) -> None:
    """Copies the libraries of a module, and theirs, and lets each file find its own."""
    folder.mkdir()
    todo, names = [(module, module, f"$ORIGIN/../{folder.name}")], {}
    while todo:
        file, place, path = todo.pop()
        for name, library in needed(file, place).items():
            if library not in names:
                names[library] = own_name(library)
                copy = folder / names[library]
                shutil.copy2(library, copy)
                copy.chmod(0o755)
                run("patchelf", "--set-soname", copy.name, copy)
                todo.append((copy, library, "$ORIGIN"))
            run("patchelf", "--replace-needed", name, names[library], file)
        run("patchelf", "--force-rpath", "--set-rpath", path, file)


def least_glibc(files: "list[Path]") -> "tuple[int, int]":
    """The newest version of a name of glibc that the files use."""
    versions = [(2, 17)]
    for file in files:
        for major, minor in re.findall(r"GLIBC_(\d+)\.(\d+)", run("objdump", "-T", file)):
            versions.append((int(major), int(minor)))
    return max(versions)


def main() -> None:
    wheel, out = Path(sys.argv[1]), Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as work:
        run(sys.executable, "-m", "wheel", "unpack", "-d", work, wheel)
        (root,) = Path(work).iterdir()
        (module,) = root.glob("fcl_ccd/_core*.so")
        bundle(module, root / "fcl_ccd.libs")
        major, minor = least_glibc([module, *(root / "fcl_ccd.libs").iterdir()])
        (info,) = root.glob("*.dist-info/WHEEL")
        text = info.read_text(encoding="utf-8")
        text = re.sub(r"(Tag: \S+-)linux_", rf"\1manylinux_{major}_{minor}_", text)
        info.write_text(text, encoding="utf-8")
        run(sys.executable, "-m", "wheel", "pack", "-d", out, root)


if __name__ == "__main__":
    main()
