"""Memory while very many maps go to a file."""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any


def profile(maps: int) -> dict[str, Any]:
    """Enumerate so many maps of the 5x4 snake to a file: the most resident memory, in MB,
    until each tenth of the file was written."""
    with tempfile.TemporaryDirectory() as folder:
        snake, file = Path(folder) / "snake.lp", Path(folder) / "maps.txt"
        topomap = [sys.executable, "-m", "topomap"]
        made = ["generate", "grid", "5", "4", "--route", "snake", "-o", str(snake)]
        subprocess.run([*topomap, *made], check=True)
        journal = Path(f"{file}.part")
        call = ["solve", str(snake), "--bound", "20", "--limit", str(maps), "-o", str(file)]
        begun = time.perf_counter()
        process = subprocess.Popen([*topomap, *call], stderr=subprocess.DEVNULL)
        samples = []
        try:
            while process.poll() is None:
                time.sleep(0.1)
                status = Path(f"/proc/{process.pid}/status").read_text()
                if journal.exists() and (resident := re.search(r"VmRSS:\s+(\d+)", status)):
                    samples.append((journal.stat().st_size, int(resident[1]) / 1024))
        finally:
            process.kill()
        seconds = time.perf_counter() - begun
        with file.open() as lines:
            written = sum(line.startswith("map ") for line in lines)
        size = journal.stat().st_size
    tenths = [
        max((mb for at, mb in samples if at <= size * part / 10), default=0.0)
        for part in range(1, 11)
    ]
    flat = written == maps and tenths[-1] <= 1.25 * tenths[0]
    return {"maps": written, "seconds": seconds, "tenths": tenths, "flat": flat}
