"""Attacks by the system: every kind of call fails, or kills, at any of its turns, in every job."""
import collections
import re
import shutil
import signal
import subprocess

from jobs import JOBS, calm, ends_well, folders
from lab import Tally

# (calls, how they may fail). Not lseek: it does not read, so that no disk makes it fail; GDAL takes a failing one for the
# end of a file.
GROUPS = (
    ("openat", ("error=EMFILE", "error=ENFILE", "error=EIO", "error=ENOMEM")), ("read,pread64", ("error=EIO",)),
    ("write,pwrite64,writev", ("error=EIO", "error=ENOSPC")), ("fsync,fdatasync", ("error=EIO", "error=ENOSPC")),
    ("rename,renameat,renameat2", ("error=EIO", "error=ENOSPC")), ("link,linkat", ("error=EIO", "error=ENOSPC")),
    ("unlink,unlinkat", ("error=EIO",)), ("mkdir,mkdirat", ("error=EIO", "error=ENOSPC")),
    ("ftruncate", ("error=EIO", "error=ENOSPC")), ("fallocate", ("error=EIO", "error=ENOSPC")),
    ("flock", ("error=EIO", "error=ENOLCK")), ("getdents64", ("error=EIO", "error=ENOMEM")),
    ("newfstatat,fstat,lstat,stat,statx", ("error=EIO", "error=ENOMEM")),
    ("mmap", ("error=ENOMEM",)), ("brk", ("retval=0",)),  # where brk(2) fails, the system gives the old end
)
KILLED_AT = tuple(calls for calls, _ in GROUPS if calls not in ("mmap", "brk"))


def permitted():
    return shutil.which("strace") is not None and \
        subprocess.run(["strace", "-qq", "true"], capture_output=True).returncode == 0


def turns(lab, job):
    """{calls: (first, last)}: which turns of a thread's calls belong to the program and not to the loader."""
    store, products = folders(lab, job, "traced")
    log = lab.folder / "strace.log"
    every = ",".join(calls for calls, _ in GROUPS)
    done = lab.run(*job.line(lab, store, products),
                   prefix=("strace", "-f", "-qq", "--seccomp-bpf", "-o", log, "-e", f"trace={every},munmap"))
    if done.code != 0:
        raise SystemExit(f"torture: {job.name} under strace: exit {done.code}: {done.err}")
    loaded, counts, before = False, collections.Counter(), collections.Counter()
    for line in log.read_text(errors="replace").splitlines():
        match = re.match(r"(\d+) +(\w+)\(", line)
        if not match:
            continue
        thread, call = match.groups()
        if call == "munmap":  # of ld.so.cache: all libraries are there
            loaded = True
            continue
        counts[thread, call] += 1
        if not loaded:
            before[call] += 1
    found = {}
    for calls, _ in GROUPS:
        names = calls.split(",")
        first = sum(before[n] for n in names) + 1
        threads = {t for t, n in counts if n in names}
        last = max((sum(counts[t, n] for n in names) for t in threads), default=0)
        if last >= first:
            found[calls] = (first, last)
    return found


def failing_run(lab, job, calls, how, nth):
    """(outcome, whether it happened, store, products): a run in which a call fails, or kills."""
    store, products = folders(lab, job)
    log = lab.folder / "strace.log"
    quick = ("--seccomp-bpf",) if not how.startswith("signal") else ()  # with it strace sends no signals
    outcome = lab.run(*job.line(lab, store, products),
                      prefix=("strace", "-f", "-qq", *quick, "-o", log, "-e", f"trace={calls}",
                              f"-einject={calls}:{how}:when={nth}"))
    text = log.read_text(errors="replace")
    return outcome, "(INJECTED)" in text or outcome.code == 128 + signal.SIGKILL, store, products


def some_job(lab, jobs):
    """Quick ones more often: every job gets about the same time."""
    names = list(jobs)
    seconds = [lab.calm[name].seconds if name in lab.calm else JOBS[name].seconds for name in names]
    return JOBS[lab.random.choices(names, [1 / (s + 0.3) for s in seconds])[0]]


def judge(lab, job, tally, outcome, what, store, products, allowed):
    """A failed run left all that was there, and the job can still be done."""
    if allowed is not None and not tally.judge(outcome, allowed, what):
        return
    if job.verifies and store.exists() and (store / "store.json").exists():
        lab.verify(store, tally, what)
    ends_well(lab, job, store, products, tally, what, outcome.code == 0)


def errors(lab, until):
    """A system call fails: 5 and one line, or done all the same."""
    if not permitted():
        return Tally(skipped="strace is not there or not permitted")
    tally, known = Tally(), {}
    while lab.time_is_left(until):
        job = some_job(lab, JOBS)
        calm(lab, job)
        if job.name not in known:
            known[job.name] = turns(lab, job)
        calls, codes = lab.random.choice([group for group in GROUPS if group[0] in known[job.name]])
        how = lab.random.choice(codes)
        nth = lab.random.randint(*known[job.name][calls])
        outcome, happened, store, products = failing_run(lab, job, calls, how, nth)
        if not happened or outcome.code == 127:  # 127: the loader did not find its libraries
            continue
        tally.runs += 1
        # Whatever fails by the system is 5; a failed flock is another writer's, and what the disk cannot read `verify`
        # names as damaged. What is unharmed may go on.
        allowed = {0, 5} | ({6} if calls == "flock" else {4} if job.name == "verify" and "EIO" in how else set())
        judge(lab, job, tally, outcome, f"{job.name}, {how} at {calls} {nth}", store, products, allowed)
    return tally


def kills_at_calls(lab, until):
    """SIGKILL at a system call: nothing that was there is lost."""
    if not permitted():
        return Tally(skipped="strace is not there or not permitted")
    tally, known = Tally(), {}
    while lab.time_is_left(until):
        job = some_job(lab, JOBS)
        calm(lab, job)
        if job.name not in known:
            known[job.name] = turns(lab, job)
        calls = lab.random.choice([calls for calls in KILLED_AT if calls in known[job.name]])
        nth = lab.random.randint(*known[job.name][calls])
        outcome, happened, store, products = failing_run(lab, job, calls, "signal=SIGKILL", nth)
        if not happened:
            continue
        tally.runs += 1
        judge(lab, job, tally, outcome, f"{job.name}, killed at {calls} {nth}", store, products, None)
    return tally
