"""Attacks on those who write: killed, interrupted, failed by the system, many at a time."""
import shutil
import signal
import subprocess
import time

from lab import DATES, Tally

# (command, store before, store after)
JOBS = (("add", "one", "two"), ("process", "two", "whole"))


def words_of(lab, job, store):
    return lab.add(store, DATES[1]) if job == "add" else ("process", store, "-q")


def end_well(lab, job, store, after, tally, what):
    """The same command, undisturbed, ends with what it makes in peace."""
    if tally.judge(lab.run(*words_of(lab, job, store)), {0}, f"{what}, run again"):
        lab.run("gc", store, "-q")
        lab.same(store, after, tally, what)


def kills(lab, until):
    """SIGKILL at random moments, up to three in a row."""
    tally = Tally()
    while time.monotonic() < until:
        job, before, after = JOBS[tally.runs % len(JOBS)]
        store = lab.copy(before)
        for _ in range(lab.random.randint(1, 3)):
            moment = lab.random.uniform(0, lab.seconds[job])
            lab.run_and_signal(words_of(lab, job, store), moment)
            tally.runs += 1
            lab.verify(store, tally, f"{job} killed after {moment:.3f} s")
        end_well(lab, job, store, after, tally, f"{job} killed")
    return tally


def signals(lab, until):
    """SIGINT and SIGTERM: 130, and the store as it was."""
    tally = Tally()
    while time.monotonic() < until:
        job, before, after = JOBS[tally.runs % len(JOBS)]
        number = lab.random.choice((signal.SIGINT, signal.SIGTERM))
        store = lab.copy(before)
        # The first tens of milliseconds belong to the loader, and to nobody's handlers.
        outcome = lab.run_and_signal(words_of(lab, job, store), lab.random.uniform(0.15, lab.seconds[job] + 0.15), number)
        what = f"{job}, {signal.Signals(number).name}"
        if not tally.judge(outcome, {0, 130}, what):
            continue
        lab.verify(store, tally, what)
        end_well(lab, job, store, after, tally, what)
    return tally


CALLS = ("write", "pwrite64", "fsync", "fdatasync", "rename,renameat,renameat2", "link,linkat", "unlink,unlinkat",
         "read,pread64", "mkdir,mkdirat", "ftruncate", "flock")


def system_calls(lab, until):
    """A system call that kills, or fails with an input/output error or a full disk."""
    if shutil.which("strace") is None or subprocess.run(["strace", "-qq", "true"], capture_output=True).returncode != 0:
        return Tally(skipped="strace is not there or not permitted")
    tally = Tally()
    while time.monotonic() < until:
        job, before, after = JOBS[tally.runs % len(JOBS)]
        calls, how = lab.random.choice(CALLS), lab.random.choice(("error=EIO", "error=ENOSPC", "signal=SIGKILL"))
        nth = int(lab.random.expovariate(1 / 20)) + 1
        if calls.startswith("read"):
            nth += 100  # the loader's own reads
        store = lab.copy(before)
        outcome = lab.run(*words_of(lab, job, store),
                          prefix=("strace", "-f", "-qq", "-o", "/dev/null", f"-einject={calls}:{how}:when={nth}"))
        what = f"{job}, {how} at {calls} {nth}"
        if outcome.code == 127:  # the loader did not find its libraries
            continue
        if how.startswith("signal"):
            tally.runs += 1
        # Whatever fails by the system is 5; a failed flock is another writer's. What is unharmed may go on.
        elif not tally.judge(outcome, {0, 5, 6} if calls == "flock" else {0, 5}, what):
            continue
        lab.verify(store, tally, what)
        end_well(lab, job, store, after, tally, what)
    return tally


def crowds(lab, until):
    """Eight writers and two readers of one store at a time."""
    tally = Tally()
    while time.monotonic() < until:
        store = lab.copy("one")
        names = [f"writer{i}" for i in range(8)]
        waiting, running, readers = list(names), {}, 0
        while waiting or running:
            for name in waiting[:]:
                words = (*lab.add(store, DATES[1]), "--name", name, "--no-align")
                running[name] = subprocess.Popen([lab.program, *map(str, words)], stdout=subprocess.DEVNULL,
                                                 stderr=subprocess.PIPE, text=True)
                waiting.remove(name)
            for reader in (("status", store), ("verify", store, "-q")):
                readers += 1
                tally.judge(lab.run(*reader), {0}, f"{reader[0]} beside writers")
            for name, process in list(running.items()):
                if process.poll() is None:
                    continue
                err = process.stderr.read()
                del running[name]
                tally.runs += 1
                if process.returncode == 6:
                    waiting.append(name)  # another one was writing
                elif process.returncode != 0:
                    tally.find("wrong", f"writer: exit {process.returncode}: {err[-300:]}")
        scans = lab.scans(store) or []
        missing = [name for name in names if not any(scan.endswith(name) for scan in scans)]
        if missing:
            tally.find("lost", f"scans of {missing}")
        lab.verify(store, tally, "eight writers")
    return tally
