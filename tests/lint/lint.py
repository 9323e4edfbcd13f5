"""What the checks of this folder share: the repository's files, their text with comments in one piece, the report."""

import bisect
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# A line that is a comment from its first character on, and what its text comes after.
COMMENT = re.compile(r"\s*(?://[/!]?<?|#(?=\s|$))\s?")
# A line of Markdown that does not continue the one before.
BLOCK = re.compile(r"\s*(?:[-*+] |\d+[.)] |[>|#]|```|~~~|$)")


def die(message):
    """Ends the script as for wrong usage: what it needs is not there."""
    print(f"{sys.argv[0]}: {message}", file=sys.stderr)
    sys.exit(2)


def files():
    """Paths, relative to the root, of what git tracks or would add, sorted: those that exist, without links."""
    command = ["git", "-C", str(ROOT), "ls-files", "-coz", "--exclude-standard"]
    try:
        listed = subprocess.run(command, capture_output=True, check=True).stdout.decode()
    except FileNotFoundError:
        die("git is not installed: apt-get install -y --no-install-recommends git")
    except subprocess.CalledProcessError as error:
        die(f"git cannot list the files of {ROOT}: {error.stderr.decode().strip()}")
    paths = sorted(set(path for path in listed.split("\0") if path))
    return [path for path in paths if (ROOT / path).is_file() and not (ROOT / path).is_symlink()]


def text_of(path):
    """A file's text; None where it is none."""
    data = (ROOT / path).read_bytes()
    if b"\0" in data:
        return None
    try:
        return data.decode()
    except UnicodeDecodeError:
        return None


class Prose:
    """A file's text in which a sentence is one piece: comment marks are gone, a comment's lines and a paragraph's are
    joined by a space, and the halves of a string literal by nothing. Every other line ends with a line feed."""

    def __init__(self, path, text):
        self._starts = []
        pieces, at, before = [], 0, None
        markdown = path.endswith(".md")
        for line in text.split("\n"):
            comment = COMMENT.match(line)
            body = line.strip() if markdown else line[comment.end():] if comment else line
            if before is None:
                glue = ""
            elif before.rstrip().endswith('"') and body.lstrip().startswith('"') and not markdown:
                half = pieces[-1].rstrip()[:-1]
                at -= len(pieces[-1]) - len(half)
                pieces[-1], body, glue = half, body.lstrip()[1:], ""
            else:
                glue = " " if continues(before, line, markdown) else "\n"
            pieces += [glue, body]
            self._starts.append(at + len(glue))
            at += len(glue) + len(body)
            before = line
        self.text = "".join(pieces)

    def line(self, offset):
        """Number of the line that the character at this offset stands in, from 1."""
        return bisect.bisect_right(self._starts, offset)


def continues(before, line, markdown):
    """Whether `line` goes on with the sentence of the line before."""
    if markdown:
        return not BLOCK.match(line) and before.strip() != "" and not re.match(r"\s*(?:[|#]|```|~~~)", before)
    return bool(COMMENT.match(line)) and ("//" in before or bool(COMMENT.match(before)))


class Report:
    """Findings of one check. Each says where, what is wrong, and the way out."""

    def __init__(self, name):
        self.name = name
        self._findings = collections.OrderedDict()

    def add(self, path, line, wrong, way_out):
        self._findings[(str(path), line, f"{wrong}: {way_out}")] = True

    def __len__(self):
        return len(self._findings)

    def end(self, looked_at):
        """Prints what was found; returns the exit code. `looked_at` says what was checked."""
        for path, line, message in sorted(self._findings):
            print(f"{path}:{line}: {message}")
        print(f"{self.name}: {looked_at}; " + (f"{len(self)} wrong" if len(self) else "all right"))
        return 1 if len(self) else 0
