"""Attacks on what the program has: memory, file descriptors, disk, power."""
import contextlib
import fcntl
import os
import resource
import shutil
import signal
import subprocess
import time

from failing import judge, some_job
from jobs import JOBS, WRITERS, calm, folders
from lab import Tally, content

CUT = ("add", "process", "update", "export", "remove", "revert", "repair", "registry rename", "gc")
# EXT4_IOC_SHUTDOWN, XFS_IOC_GOINGDOWN: drop what is not on disk.
SHUTDOWN, WITHOUT_LOG = 0x8004587D, b"\x02\x00\x00\x00"


def resources(lab, until):
    """Little address space, few descriptors, small files, little --memory: 5 and a line, or done."""
    tally = Tally()
    while lab.time_is_left(until):
        job = some_job(lab, JOBS)
        calm(lab, job)
        what, limit, value = lab.random.choice((
            ("address space", resource.RLIMIT_AS, lab.random.randint(250, 900) << 20),
            ("descriptors", resource.RLIMIT_NOFILE, lab.random.randint(4, 40)),
            ("file size", resource.RLIMIT_FSIZE, lab.random.randint(1, 2000) << 10),
            ("--memory", None, lab.random.choice(("1", "64M", "256M", "300M")))))
        store, products = folders(lab, job)
        words = job.line(lab, store, products)
        if limit is None:
            outcome = lab.run(*words, "--memory", value)
        else:
            outcome = lab.run(*words, prepare=lambda: resource.setrlimit(limit, (value, value)))
        if outcome.code in (1, 127) and "rayfield: " not in outcome.err and "shared" in outcome.err:
            continue  # not even the loader had room
        tally.runs += 1
        judge(lab, job, tally, outcome, f"{job.name}, {what} {value}", store, products,
              {0, 2, 5} if limit is None else {0, 5})
    return tally


class Mounted:
    """A file system of its own for the time of a `with`."""

    def __init__(self, lab, *options, source="none"):
        self.path = lab.folder / "mounted"
        self.path.mkdir(exist_ok=True)
        self.command = ["mount", *options, str(source), str(self.path)]

    def __enter__(self):
        subprocess.run(self.command, check=True, capture_output=True)
        return self.path

    def __exit__(self, *_):
        for _ in range(50):
            if subprocess.run(["umount", str(self.path)], capture_output=True).returncode == 0:
                return
            time.sleep(0.1)
        raise SystemExit(f"torture: {self.path} cannot be unmounted")


def kilobytes_in_pages(folder):
    """What tmpfs needs for a copy of a folder: whole pages, one at least for each file or folder."""
    page = resource.getpagesize()
    return sum(max(1, -(-p.lstat().st_size // page)) for p in folder.rglob("*")) * page >> 10


def full_disks(lab, until):
    """A small disk that gets full."""
    tally = Tally()
    while lab.time_is_left(until):
        job = some_job(lab, WRITERS)
        calm(lab, job)
        used = kilobytes_in_pages(lab.stores[job.before]) if job.before else 0
        size = used + lab.random.randint(40, 6000)
        try:
            with Mounted(lab, "-t", "tmpfs", "-o", f"size={size}k") as disk:
                store, products = disk / "block", disk / "out"
                if job.before:
                    shutil.copytree(lab.stores[job.before], store, symlinks=True)
                products.mkdir()
                outcome = lab.run(*job.line(lab, store, products))
                tally.runs += outcome.code != 0
                what = f"{job.name} with {size - used} kB left"
                if tally.judge(outcome, {0, 5}, what) and job.verifies and (store / "store.json").exists():
                    lab.verify(store, tally, what)
        except subprocess.CalledProcessError as e:
            tally.notes.append(f"tmpfs cannot be mounted: {e}")
            return tally if tally.runs else Tally(skipped=tally.notes[-1])
    return tally


def cut_power(disk):
    handle = os.open(disk, os.O_RDONLY)
    fcntl.ioctl(handle, SHUTDOWN, WITHOUT_LOG)
    os.close(handle)


def one_cut(lab, image, tally, job, prefix=(), after_end=0.3):
    """Returns whether what the program had said was done is there, after a cut at a random moment or, with the chance
    `after_end`, at its end."""
    expected = calm(lab, job)
    with Mounted(lab, "-o", "loop", source=image) as disk:
        for folder in ("block", "out"):
            shutil.rmtree(disk / folder, ignore_errors=True)
        shutil.copytree(lab.stores[job.before], disk / "block", symlinks=True)
        (disk / "out").mkdir()
        os.sync()
        words = [*prefix, lab.program, *map(str, job.line(lab, disk / "block", disk / "out"))]
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            process.wait(timeout=None if lab.random.random() < after_end else lab.random.uniform(0, expected.seconds))
        except subprocess.TimeoutExpired:
            pass
        done = process.poll() == 0
        cut_power(disk)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)  # strace does not take what it follows with it
        process.wait()
    tally.runs += 1
    with Mounted(lab, "-o", "loop", source=image) as disk:
        store = disk / "block"
        whole = not job.verifies and not done or lab.run("verify", store, "--all", "-q").code == 0
        return whole and (not done or (lab.scans(store) == expected.scans and
                                       content(disk / "out") == expected.products))


def image_of(lab, system, megabytes):
    image = lab.folder / f"{system}.img"
    with open(image, "wb") as file:
        file.truncate(megabytes << 20)
    subprocess.run([f"mkfs.{system}", "-q", str(image)], check=True, capture_output=True)
    return image


def power_cuts(lab, until):
    """The power fails: what was not flushed is gone. Without fsync the same must lose something."""
    tally = Tally()
    images = []
    for system, megabytes in (("ext4", 128), ("xfs", 320)):
        try:
            images.append(image_of(lab, system, megabytes))
            one_cut(lab, images[-1], Tally(), JOBS["add"])
        except (OSError, subprocess.CalledProcessError) as e:
            images = images[:-1] if images and images[-1].name.startswith(system) else images
            tally.notes.append(f"{system}: left out: {e}")
    if not images:
        return Tally(skipped="no file system can be mounted: " + "; ".join(tally.notes))
    while lab.time_is_left(until):
        job = some_job(lab, CUT)
        image = images[tally.runs % len(images)]
        if not one_cut(lab, image, tally, job):
            tally.find("lost", f"{job.name} on {image.stem}")
    if shutil.which("strace") is not None:
        lying = ("strace", "-f", "-qq", "-o", "/dev/null", "-einject=fsync,fdatasync,sync_file_range:retval=0")
        # At the end of the program: something was promised then, and the file system has had no time to flush it.
        control = [one_cut(lab, images[0], Tally(), JOBS["add"], lying, after_end=1) for _ in range(6)]
        tally.notes.append(f"control without fsync: {control.count(False)} of {len(control)} lost, as they should")
        if all(control):
            tally.find("wrong", "cuts lose nothing even where nothing is flushed: they are no cuts")
    return tally

