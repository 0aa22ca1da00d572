#!/usr/bin/env python3
"""Does what docs/my-own-method-and-scene.md says, in a copy of the repository, and fails where the
page is no longer true.

Of the page's blocks, `sh` are run, `text` must be in the output of the commands before, a block with
`file=` is written to that file, and `diff file=` changes one. `./lab build` is carried out with what a
build has compiled already: only what the walk adds is compiled, and linked with that build's libraries.

usage: docs_walk.py REPOSITORY BUILD        exit code 0 if all of it works, 1 if not, 77 if BUILD was
                                            not made with Ninja
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

PAGE = "docs/my-own-method-and-scene.md"
COPIED = ["algorithms", "cmake", "common", "data", "docs", "experiments", "report", "CMakeLists.txt"]
FENCE = re.compile(r"^```(\w+)?(?: file=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXIT_CODE = re.compile(r"<!-- exit code (\d+) -->\s*$")


class Failure(Exception):
    pass


def fail(message):
    raise Failure(message)


def run(words, folder, expected=0):
    """What a command writes, to either output."""
    done = subprocess.run(
        words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if done.returncode != expected:
        called = " ".join(str(word) for word in words)
        fail(f"{called}: exit code {done.returncode}, not {expected}\n{done.stdout}")
    return done.stdout


class Build:
    """Builds the copy's program from objects of the copy and libraries of the build."""

    def __init__(self, copy, build):
        self.copy = copy
        self.build = build
        self.folder = copy / "build" / "release"
        self.program = self.folder / "vislab"

    def cached(self, name):
        """A setting of the build that is there, as an argument for CMake."""
        cache = (self.build / "CMakeCache.txt").read_text()
        found = re.search(rf"^{name}:\w+=(.*)$", cache, re.MULTILINE)
        return [f"-D{name}={found.group(1)}"] if found else []

    def configure(self):
        names = ["CMAKE_BUILD_TYPE", "CMAKE_CXX_FLAGS", "CMAKE_CXX_COMPILER"]
        names += [f"CMAKE_CXX_FLAGS_{kind}" for kind in ("RELEASE", "DEBUG", "RELWITHDEBINFO")]
        settings = [setting for name in names for setting in self.cached(name)]
        settings += ["-DVISLAB_TESTS=OFF", "-DVISLAB_BENCHMARKS=OFF", "-DVISLAB_PRECOMPILED_HEADERS=OFF"]
        run(["cmake", "-S", self.copy, "-B", self.folder, "-G", "Ninja", *settings], self.copy)

    def link_words(self):
        """How the build links the program."""
        commands = run(["ninja", "-C", self.build, "-t", "commands", "vislab"], self.build)
        line = next(line for line in reversed(commands.splitlines()) if " -o vislab " in line)
        # ": && c++ … && :"
        return shlex.split(line.split("&&")[1])

    def make_one(self, file):
        """One file of the copy's build. Ninja itself would make all libraries before some of them."""
        commands = run(["ninja", "-C", self.folder, "-t", "commands", file], self.copy)
        (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
        run(["sh", "-c", commands.splitlines()[-1]], self.folder)

    def make(self):
        if not (self.folder / "build.ninja").exists():
            self.configure()
        run(["ninja", "-C", self.folder, "build.ninja"], self.copy)  # lists that have changed
        # What differs from the build that is there: the program's folders, the list of all cullers,
        # the hashes of sources, and the walk's own family. They come before the libraries, so that
        # what these have of the same names is not taken.
        main = "experiments/CMakeFiles/vislab.dir/vislab.cpp.o"
        objects = [
            "algorithms/CMakeFiles/vislab_cullers.dir/all_cullers.cpp.o",
            "experiments/context/CMakeFiles/vislab_context.dir/source_hashes.cpp.o",
        ]
        for source in sorted((self.copy / "algorithms" / "mine").glob("*.cpp")):
            objects.append(f"algorithms/mine/CMakeFiles/vislab_mine.dir/{source.name}.o")
        self.make_one("experiments/context/source_hashes.cpp")
        for file in objects:
            self.make_one(file)
        if not (self.folder / main).exists():
            self.make_one(main)
        words = []
        for word in self.link_words():
            if word == main:
                words += [self.folder / file for file in [main, *objects]]
            elif word == "vislab":
                words.append(self.program)
            else:
                words.append(word)
        run(words, self.build)
        return ""


def blocks(text):
    """Kind, file, content and expected exit code of each block."""
    for match in FENCE.finditer(text):
        code = EXIT_CODE.search(text[: match.start()])
        yield match.group(1), match.group(2), match.group(3), int(code.group(1)) if code else 0


def change(file, diff):
    """Replaces what the lines with - and blanks say by what those with + and blanks say."""
    text = file.read_text()
    for hunk in re.split(r"^@@\n", diff, flags=re.MULTILINE):
        lines = hunk.splitlines(keepends=True)
        old = "".join(line[1:] for line in lines if line[0] in " -")
        new = "".join(line[1:] for line in lines if line[0] in " +")
        if text.count(old) != 1:
            fail(f"{file}: is {text.count(old)} times in it, not once:\n{old}")
        text = text.replace(old, new)
    file.write_text(text)


def walk(page, build, copy):
    output = ""
    for kind, name, content, code in blocks(page):
        if kind == "diff":
            change(copy / name, content)
        elif name:
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_text(content)
        elif kind == "sh":
            commands = content.strip().splitlines()
            output = ""
            for command in commands:
                print(command, flush=True)
                if command == "./lab build":
                    output += build.make()
                else:
                    last = command == commands[-1]
                    output += run(["bash", "-c", command], copy, code if last else 0)
        elif kind == "text":
            for line in content.splitlines():
                if line not in output:
                    fail(f"the page shows '{line}', which is not in\n{output}")
                # Looked at here: once the method is right, its check takes the picture away.
                picture = re.fullmatch(r"Picture: (\S+)", line)
                if picture and not (copy / picture.group(1)).read_bytes().startswith(b"\x89PNG"):
                    fail(f"{picture.group(1)} is no picture")


def main():
    repository, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    if not (build / "build.ninja").exists():
        print(f"skipped: {build} was not made with Ninja")
        return 77
    # Always in the same place, so that the compiler's cache knows it.
    copy = build / "walk"
    shutil.rmtree(copy, ignore_errors=True)
    copy.mkdir()
    for name in COPIED:
        if (repository / name).is_dir():
            ignored = shutil.ignore_patterns("cache") if name == "data" else None
            shutil.copytree(repository / name, copy / name, ignore=ignored)
        else:
            shutil.copy(repository / name, copy / name)
    os.environ["CCACHE_BASEDIR"] = str(copy)
    os.environ["CCACHE_NOHASHDIR"] = "true"
    try:
        walk((repository / PAGE).read_text(), Build(copy, build), copy)
    except Failure as failure:
        print(f"{PAGE}: {failure}")
        return 1
    report = copy / "out" / "mine_report"
    if not (report / "report.pdf").read_bytes().startswith(b"%PDF-"):
        print(f"{report / 'report.pdf'} is no PDF")
        return 1
    page = (report / "index.html").read_text().replace("<wbr>", "")
    chapter = re.search(
        r'<h1[^>]* id="methods-of-the-family-mine">(.*?)(?=<h1|\Z)', page, re.DOTALL
    )
    if not chapter or "mine.all_planes" not in chapter.group(1):
        print(f"{report / 'index.html'} has no chapter on mine.all_planes")
        return 1
    shutil.rmtree(copy)
    return 0


if __name__ == "__main__":
    sys.exit(main())
