"""Completes a folder that holds the wheel's library and tool: what they link, a font, all licences, and for which systems it is.

usage: stage.py FOLDER MAP...      MAP: the linker's maps (-Wl,-Map), which name the archives that went in

Everything but the C library goes in: a system that has none of our packages is what the wheel is for. The library and the tool look
in their own folder first (their DT_RPATH), for what their libraries need too. auditwheel would do much of it, but leaves out what
it takes to be on every desktop (X11, zlib), and knows no archives. Licences are Debian's copyright files of the packages.
"""

import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

#: glibc's, which a manylinux system has, in the version that the wheel's name says or a later one.
SYSTEM = re.compile(r"(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util))\.so[.\d]*")
#: The compiler's own, whose licences except what is compiled with it.
COMPILERS = re.compile(r"lib(gcc|gcc_eh|c_nonshared|ssp_nonshared)\.a|libgcc_s\.so\.1")
#: What pictures are labelled in.
FONTS = [Path("/usr/share/fonts/truetype/dejavu", name) for name in ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf")]


def said(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def shared(program):
    """What the loader gives the program, all the way down, but for the C library."""
    lines = [line.split() for line in said("ldd", program).splitlines()]
    missing = [words[0] for words in lines if "not" in words and "found" in words]
    if missing:
        sys.exit(f"{program}: {' '.join(missing)} can't be found")
    found = [Path(words[2]) for words in lines if "=>" in words]
    return [path for path in found if not SYSTEM.fullmatch(path.name) and path.parent != program.parent]


def archives(link_map):
    return {Path(name) for name in re.findall(r"^(/\S+\.a)\(", link_map.read_text(), re.M)}


def package(path):
    """The Debian package that the file is of, which may call /usr/lib by its old name."""
    real = str(path.resolve())
    for name in (str(path), real, real.removeprefix("/usr"), "/usr" + str(path)):
        owner = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if owner.returncode == 0:
            return owner.stdout.split(":")[0]
    sys.exit(f"{path}: no package owns it, so its licence isn't known; the wheel is made on Debian, of Debian's packages")


def glibc(programs):
    """The newest version of the C library that any of them asks for."""
    versions = {int(minor) for path in programs for minor in re.findall(r"\bGLIBC_2\.(\d+)", said("objdump", "-T", path))}
    return max(versions)


def main():
    folder, maps = Path(sys.argv[1]).resolve(), [Path(name) for name in sys.argv[2:]]
    programs = [path for path in folder.iterdir() if path.name == "tides" or path.name.startswith("libtides")]
    linked = {path for program in programs for path in shared(program)}
    for path in linked:
        shutil.copy(path, folder / path.name)
    fonts = folder / "fonts"  # small systems have none
    fonts.mkdir(exist_ok=True)
    for path in FONTS:
        shutil.copyfile(path, fonts / path.name)
    shutil.copyfile(Path(__file__).with_name("fonts.conf"), fonts / "fonts.conf")
    licences = folder / "licences"
    licences.mkdir(exist_ok=True)
    inside = {path for path in linked.union(FONTS, *map(archives, maps)) if not COMPILERS.fullmatch(path.name)}
    names = sorted({package(path) for path in inside})
    for name in names:
        shutil.copyfile(f"/usr/share/doc/{name}/copyright", licences / f"{name}.txt")
    sources = said("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}\\n", *names)
    listed = "".join(sorted(set(sources.splitlines(keepends=True))))
    (licences / "SOURCES.txt").write_text(f"Debian's sources of what is inside (https://snapshot.debian.org):\n{listed}")
    machine = sysconfig.get_platform().split("-")[-1]
    everything = [*programs, *(folder / path.name for path in linked)]
    (folder / "platform").write_text(f"manylinux_2_{glibc(everything)}_{machine}\n")


if __name__ == "__main__":
    main()
