"""Raw results as JSON: what was measured of this very program is not measured again."""

import datetime
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

from measure import FLEXFRAME, machine, versions

FOLDER = Path("out/performance")


class Store:
    """The results of one part, in `out/performance/PART.json`; written after each measurement."""

    def __init__(self, part, effort):
        FOLDER.mkdir(parents=True, exist_ok=True)
        self.file = FOLDER / f"{part}.json"
        with open(FLEXFRAME, "rb") as binary:
            program = hashlib.file_digest(binary, "sha256").hexdigest()[:12]
        version = subprocess.run([FLEXFRAME, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        old = json.loads(self.file.read_text()) if self.file.exists() else {}
        self.results = old["results"] if old.get("program") == program else {}
        self.about = {
            "program": program,
            "version": version,
            "effort": effort,
            "machine": machine(),
            "versions": versions(),
        }

    def once(self, key, measure):
        """The result of that key: what is there, or measured now."""
        if key not in self.results:
            print(f"performance: {key}", file=sys.stderr)
            self.results[key] = measure() | {"load": os.getloadavg()[0]}
            self.about["date"] = datetime.date.today().isoformat()
            text = json.dumps(self.about | {"results": self.results}, indent=1)
            self.file.with_suffix(".part").write_text(text)
            self.file.with_suffix(".part").replace(self.file)
        return self.results[key]
