#!/usr/bin/env python3
"""Checks that what the repository's texts point at is there.

    scripts/check_links.py [FOLDER]     (default: this repository)

- Links of Markdown files to files and to headings (`page.md#heading`, `#heading`), and images.
- Paths in backticks in Markdown files that begin with a folder of the repository (`sim/sites/*.toml`).
- Pages named anywhere in sources, scripts and build files (docs/page.md), and sections named with them:
  docs/page.md, "Section". Line breaks of comments in between are no matter.
- References to sections of a text that is not in the repository: "method, section N".

Prints file:line: what; exit code 1 if anything was found.
"""
import glob
import os
import pathlib
import re
import subprocess
import sys

TEXTS = {".cpp", ".h", ".in", ".md", ".cmake", ".txt", ".sh", ".py", ".toml", ".yml", ".yaml", ".json", ".cff"}
LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
PAGE = re.compile(r"(?<![\w./-])docs/[\w./-]*\w")
SECTION = re.compile(r"(?<![\w./-])(?:docs/)?([\w-]+\.md)\)?,\s+\"([^\"]+)\"")
METHOD = re.compile(r"\(method[,:]|\bmethod, (?:section|chapter)", re.IGNORECASE)
COMMENT_BREAK = re.compile(r"[ \t]*\n[ \t]*(?:///?<?|#|\*)?[ \t]*")
FENCE = re.compile(r"^(```|~~~)")


def blank(text):
    """The text's line breaks alone, so that line numbers behind it stay right."""
    return re.sub(r"[^\n]", " ", text)


def without_code(text, inline=True):
    """Markdown without code: fenced blocks and, if wanted, spans in backticks."""
    lines, fenced = [], False
    for line in text.split("\n"):
        fence = FENCE.match(line.lstrip())
        lines.append(blank(line) if fenced or fence else line)
        fenced ^= bool(fence)
    text = "\n".join(lines)
    return re.sub(r"(`+)(?:.|\n)*?\1", lambda code: blank(code[0]), text) if inline else text


def plain(heading):
    """A heading as it is read: without the marks of code, links and emphasis."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.strip().rstrip("#").strip())
    return re.sub(r"[`*]", "", heading)


class Page:
    """Headings of a Markdown file, and the anchors that they have on GitHub."""

    def __init__(self, path):
        text = without_code(path.read_text(encoding="utf-8"), inline=False)
        self.headings = [plain(h) for h in re.findall(r"^#{1,6}[ \t]+(.*)$", text, re.MULTILINE)]
        self.anchors = set(re.findall(r"<a\s+(?:id|name)=\"([^\"]+)\"", text))
        count = {}
        for heading in self.headings:
            slug = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            seen = count.get(slug, 0)
            count[slug] = seen + 1
            self.anchors.add(f"{slug}-{seen}" if seen else slug)


class Checker:
    def __init__(self, root):
        self.root = root
        listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                                check=True, capture_output=True).stdout.decode()
        self.files = sorted(name for name in listed.split("\0") if name and (root / name).is_file())
        self.folders = {name.split("/")[0] for name in self.files if "/" in name}
        self.pages = {}
        self.findings = []

    def page(self, path):
        if path not in self.pages:
            self.pages[path] = Page(path)
        return self.pages[path]

    def complain(self, name, text, position, what):
        self.findings.append((name, text.count("\n", 0, position) + 1, what))

    def check_markdown(self, name, text):
        path = self.root / name
        for link in LINK.finditer(without_code(text)):
            target = link[1]
            if re.match(r"[a-z][a-z0-9+.-]*:", target):
                continue
            file, _, anchor = target.partition("#")
            place = pathlib.Path(os.path.normpath(path.parent / file)) if file else path
            if not place.exists() or not place.is_relative_to(self.root):
                self.complain(name, text, link.start(), f"no such file: {target}")
            elif anchor and place.suffix == ".md" and anchor not in self.page(place).anchors:
                self.complain(name, text, link.start(), f"no such heading: {target}")
        for code in re.finditer(r"`([\w.-]+/[^`\s]*)`", without_code(text, inline=False)):
            if code[1].split("/")[0] in self.folders and not re.search(r"[<>{}$…]|[A-Z]{3}", code[1]):
                if not glob.glob(str(self.root / code[1])):
                    self.complain(name, text, code.start(), f"no such path: {code[1]}")

    def check_mentions(self, name, text):
        for mention in PAGE.finditer(text):
            if not (self.root / mention[0]).exists():
                self.complain(name, text, mention.start(), f"no such page: {mention[0]}")
        # In one line, with the place of every character in the text.
        flat, places, end = [], [], 0
        for line_break in COMMENT_BREAK.finditer(text):
            flat.append(text[end:line_break.start()] + " ")
            places += range(end, line_break.start() + 1)
            end = line_break.end()
        flat, places = "".join(flat) + text[end:], places + list(range(end, len(text)))
        for mention in SECTION.finditer(flat):
            page = self.root / "docs" / mention[1]
            if page.is_file() and plain(mention[2]) not in self.page(page).headings:
                self.complain(name, text, places[mention.start()], f'no such section: {mention[1]}, "{mention[2]}"')
        for mention in METHOD.finditer(flat):
            self.complain(name, text, places[mention.start()],
                          f"the text of the method is not in the repository; name a page of docs/: {mention[0]}")

    def run(self):
        for name in self.files:
            if pathlib.Path(name).suffix not in TEXTS and name != ".ci/run":
                continue
            text = (self.root / name).read_text(encoding="utf-8")
            if name.endswith(".md"):
                self.check_markdown(name, text)
            if name != "scripts/check_links.py":
                self.check_mentions(name, text)
        for name, line, what in sorted(set(self.findings)):
            print(f"{name}:{line}: {what}")
        if not self.findings:
            print(f"links: {len(self.files)} files clean")
        return 1 if self.findings else 0


if __name__ == "__main__":
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    sys.exit(Checker(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/../..").resolve()).run())
