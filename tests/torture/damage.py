"""Attacks on what is stored: bits flipped, files cut, emptied, filled with zeros or taken away, and the store used."""
import re
import shutil
import time

from lab import Tally, content


def kind_of(name):
    """Files of one kind have one place and one ending; identities and numbers are left out."""
    return re.sub(r"[0-9a-f]{16,}|-?\d+", "#", name)


def hurt(path, random):
    """Damages a file, and says how."""
    data = bytearray(path.read_bytes())
    how = random.choice(("flip", "flip", "flip", "cut", "zeros", "empty", "gone")) if data else "gone"
    if how == "flip":
        at = random.randrange(len(data))
        data[at] ^= 1 << random.randrange(8)
        how = f"bit flipped at byte {at}"
    elif how == "cut":
        del data[random.randrange(len(data)):]
    elif how == "zeros":
        begin = random.randrange(len(data))
        end = min(len(data), begin + random.choice((1, 16, 512, 4096)))
        if not any(data[begin:end]):
            begin, end = 0, min(len(data), 16)
        data[begin:end] = bytes(end - begin)
        how = f"zeros at bytes {begin} to {end}"
    elif how == "empty":
        data.clear()
    path.chmod(0o644)
    if how == "gone":
        path.unlink()
    else:
        path.write_bytes(data)
    return how


def flips(lab, until):
    """Damage is named by `verify`, and no product made of it is wrong without a word."""
    tally = Tally()
    calm = content(lab.folder / "maps")
    by_kind = {}
    for path in sorted(p for p in lab.stores["whole"].rglob("*") if p.is_file() and p.name != "lock"):
        name = path.relative_to(lab.stores["whole"]).as_posix()
        by_kind.setdefault(kind_of(name), []).append(name)
    kinds = sorted(by_kind)
    while time.monotonic() < until:
        name = lab.random.choice(by_kind[kinds[tally.runs % len(kinds)]])
        store = lab.copy("whole")
        before = (store / name).read_bytes()
        what = f"{name}: {hurt(store / name, lab.random)}"
        harmless = (store / name).exists() and (store / name).read_bytes() == before
        verified = lab.run("verify", store, "--all")
        tally.runs += 1
        if verified.code not in (0, 4):
            tally.find("crashed", f"verify, {what}: exit {verified.code}: {verified.err[-300:]}")
        elif verified.code == 0 and not harmless:
            tally.find("wrong", f"verify finds nothing: {what}")
        elif verified.code == 4 and name not in verified.out + verified.err:
            tally.find("unclear", f"verify does not name the file: {what}: {verified.out[-300:]}{verified.err[-300:]}")
        maps = lab.folder / "damaged_maps"
        shutil.rmtree(maps, ignore_errors=True)
        exported = lab.run("export", store, "-o", maps, "-q")
        if tally.judge(exported, {0, 2, 3, 4}, f"export, {what}") and exported.code == 0 and content(maps) != calm:
            tally.find("wrong", f"other products without a word: {what}")
    return tally
