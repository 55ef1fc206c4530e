"""The pictures of the gallery, drawn by the commands of its page.

    python -m website.gallery

Runs each block of docs/gallery.md in a folder of its own, beside the files that the page and the
pages to which it links show, and puts the pictures that it draws into docs/gallery/. Exit status:
0 all pictures are drawn, 1 a command failed.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from website.links import ROOT

PAGE = ROOT / "docs/gallery.md"
PICTURES = ROOT / "docs/gallery"
BLOCK = re.compile(r"^```console\n(.*?)^```", re.M | re.S)
FILE = re.compile(r"^```\w+ (\S+)\n(.*?)^```", re.M | re.S)


def main() -> int:
    """Draw them all."""
    text = PAGE.read_text(encoding="utf-8")
    linked = [PAGE.parent / name for name in re.findall(r"\]\((\w[\w-]*\.md)\)", text)]
    shown: dict[str, str] = {}
    for page in [*linked, PAGE]:
        shown |= dict(FILE.findall(page.read_text(encoding="utf-8")))
    PICTURES.mkdir(exist_ok=True)
    failed = 0
    for block in BLOCK.findall(text):
        commands = re.findall(r"^\$ (.*)", block, re.M)
        with tempfile.TemporaryDirectory() as name:
            failed += not _drawn(commands, shown, Path(name))
    return 1 if failed else 0


def _drawn(commands: list[str], shown: dict[str, str], folder: Path) -> bool:
    """Run the commands of a block in a folder, and keep the pictures. Returns whether all ran."""
    for part in ("encodings", "instances"):
        (folder / part).symlink_to(ROOT / part)
    for file, content in shown.items():
        (folder / file).write_text(content, encoding="utf-8")
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    for command in commands:
        print(command, file=sys.stderr)
        done = subprocess.run(command, shell=True, cwd=folder, env={**os.environ, "PATH": path})
        if done.returncode:
            print(f"status {done.returncode}: {command}", file=sys.stderr)
            return False
    for picture in folder.glob("*.svg"):
        shutil.copyfile(picture, PICTURES / picture.name)
    return True


if __name__ == "__main__":
    sys.exit(main())
