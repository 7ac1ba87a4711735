"""Attacks on what is stored: bits flipped, files cut, emptied, filled with zeros or taken away, values changed and
sealed anew, and the store used."""
import re
import shutil
import subprocess

from lab import DATES, Tally, content


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


def damage(lab, until):
    """Damage is named by `verify`, and no product made of it is wrong without a word."""
    tally = Tally()
    calm = content(lab.folder / "maps")
    by_kind = {}
    for path in sorted(p for p in lab.stores["whole"].rglob("*") if p.is_file() and p.name != "lock"):
        name = path.relative_to(lab.stores["whole"]).as_posix()
        by_kind.setdefault(kind_of(name), []).append(name)
    kinds = sorted(by_kind)
    while lab.time_is_left(until):
        name = lab.random.choice(by_kind[kinds[tally.runs % len(kinds)]])
        store = lab.copy("whole")
        before = (store / name).read_bytes()
        what = f"{name}: {hurt(store / name, lab.random)}"
        if (store / name).exists() and (store / name).read_bytes() == before:
            continue
        verified = lab.run("verify", store, "--all")
        tally.runs += 1
        if verified.code not in (0, 4):
            tally.find("crashed", f"verify, {what}: exit {verified.code}: {verified.err[-300:]}")
        elif verified.code == 0:
            tally.find("wrong", f"verify finds nothing: {what}")
        elif name not in verified.out + verified.err:
            tally.find("unclear", f"verify does not name the file: {what}: {verified.out[-300:]}{verified.err[-300:]}")
        maps = lab.folder / "damaged_maps"
        shutil.rmtree(maps, ignore_errors=True)
        exported = lab.run("export", store, "-o", maps, "-q")
        if tally.judge(exported, {0, 2, 3, 4}, f"export, {what}") and exported.code == 0 and content(maps) != calm:
            tally.find("wrong", f"other products without a word: {what}")
    return tally


FLIPS_AT_ONCE = 2000


def flips(lab, until):
    """The same in the process that reads, hundreds of times a second: tests/fault/store_damage.cpp."""
    if not lab.damager.exists():
        return Tally(skipped=f"{lab.damager} is not built")
    tally = Tally()
    store = lab.copy("whole", "flipped")
    while lab.time_is_left(until):
        done = subprocess.run([lab.damager, "flip", store, str(FLIPS_AT_ONCE), str(lab.random.getrandbits(40))],
                              capture_output=True, text=True, errors="replace")
        for line in done.stdout.splitlines():
            kind, _, text = line.partition(" ")
            if kind.endswith(":"):
                tally.find(kind[:-1], text)
            else:
                tally.runs += int(text)
        if done.returncode not in (0, 1):
            tally.find("crashed", f"store_damage: exit {done.returncode}: {done.stderr[-300:]}")
    return tally


USES = (("verify", "--all"), ("status",), ("info",), ("log",), ("registry", "list"),
        ("export", "--format", "geotiff,gpkg,png,ply,las,csv,geojson"), ("report",), ("compare", *DATES), ("compare",),
        ("zones",), ("process",), ("process", "--set", "posts.panel_length_m=2.5"), ("gc", "--dry-run"),
        ("repair", "--dry-run"))


def use(lab, store, words):
    """Runs one of USES on a store."""
    verb, *options = words
    line = [verb, *options[:1], store, *options[1:]] if verb == "registry" else [verb, store, *options]
    products = lab.folder / "resealed_products"
    shutil.rmtree(products, ignore_errors=True)
    if verb in ("export", "zones"):
        line += ["-o", products]
    elif verb == "report":
        line += ["-o", products.with_suffix(".html")]
    elif verb == "compare":
        line += ["-o", products] if len(options) else []
    return lab.run(*line, "-q")


def resealed(lab, until):
    """Somebody has changed values, and all digests fit: an error or a result, but no crash and no hang."""
    if not lab.damager.exists():
        return Tally(skipped=f"{lab.damager} is not built")
    tally = Tally()
    while lab.time_is_left(until):
        store = lab.copy("whole", "resealed")
        seed = lab.random.getrandbits(40)
        changed = subprocess.run([lab.damager, "reseal", store, str(seed)], capture_output=True, text=True, check=True)
        what = f"{changed.stdout.strip()} (seed {seed})"
        for words in lab.random.sample(USES, 3):
            tally.runs += 1
            tally.judge(use(lab, store, words), {0, 2, 3, 4, 5}, f"{' '.join(words)}, {what}")
    return tally
