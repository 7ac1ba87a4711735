"""Attacks on those who write: killed, interrupted, many at a time."""
import signal
import subprocess

from failing import judge, some_job
from jobs import JOBS, WRITERS, calm, folders
from lab import DATES, Tally


def kills(lab, until):
    """SIGKILL at random moments, up to three in a row."""
    tally = Tally()
    while lab.time_is_left(until):
        job = some_job(lab, WRITERS)
        seconds = calm(lab, job).seconds
        store, products = folders(lab, job)
        outcome, moment, hit = None, 0, False
        for _ in range(lab.random.randint(1, 3)):
            moment = lab.random.uniform(0, seconds)
            line = job.line_again(lab, store, products) if hit else job.line(lab, store, products)
            outcome = lab.run_and_signal(line, moment)
            if outcome.code != 128 + signal.SIGKILL:  # it was done before
                break
            hit = True
            tally.runs += 1
            if job.verifies and (store / "store.json").exists():
                lab.verify(store, tally, f"{job.name} killed after {moment:.3f} s")
        if hit:
            judge(lab, job, tally, outcome, f"{job.name} killed after {moment:.3f} s", store, products, None)
    return tally


def signals(lab, until):
    """SIGINT and SIGTERM: 130, and the store as it was."""
    tally = Tally()
    while lab.time_is_left(until):
        job = some_job(lab, JOBS)
        seconds = calm(lab, job).seconds
        number = lab.random.choice((signal.SIGINT, signal.SIGTERM))
        store, products = folders(lab, job)
        # The first tens of milliseconds belong to the loader, and to nobody's handlers.
        outcome = lab.run_and_signal(job.line(lab, store, products), lab.random.uniform(0.15, seconds + 0.15), number)
        if outcome.code == 128 + signal.SIGTERM:
            continue  # before there was a handler
        if outcome.code != 0:  # where it was done, nobody knows whether the signal came before
            tally.runs += 1
        judge(lab, job, tally, outcome, f"{job.name}, {signal.Signals(number).name}", store, products, {0, 130})
    return tally


def crowds(lab, until):
    """Eight writers and two readers of one store at a time."""
    tally = Tally()
    while lab.time_is_left(until):
        store = lab.copy("one")
        names = [f"writer{i}" for i in range(8)]
        waiting, running = list(names), {}
        while waiting or running:
            for name in waiting[:]:
                words = (*lab.add(store, DATES[1]), "--name", name, "--no-align")
                running[name] = subprocess.Popen([lab.program, *map(str, words)], stdout=subprocess.DEVNULL,
                                                 stderr=subprocess.PIPE, text=True)
                waiting.remove(name)
            for reader in (("status", store), ("verify", store, "-q")):
                tally.runs += 1
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
