"""The Python of docs/http.md, run as it stands there against a service that is up."""

import os
import re
import subprocess
import sys



def page():
    """The page, found from the folder of the tables: this script may be a copy elsewhere."""
    root = os.path.dirname(os.path.abspath(os.environ["LTC_TABLES"]))
    with open(os.path.join(root, "docs", "http.md"), encoding="utf-8") as file:
        return file.read()


def run(code):
    """What the code printed."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != 0:
        sys.exit(f"http_client.py: the code of docs/http.md fails: {done.stderr.strip().splitlines()[-1]}")
    return done.stdout.strip()


blocks = re.findall(r"```python\n(.*?)```", page(), re.DOTALL)
if len(blocks) != 1:
    sys.exit(f"http_client.py: docs/http.md has {len(blocks)} blocks of Python, not 1")
code = blocks[0]
lines = [line for line in code.splitlines() if line and not line.startswith(("import", "#"))]
if len(lines) > 5:
    sys.exit(f"http_client.py: docs/http.md promises five lines and has {len(lines)}")
served = code.replace("http://127.0.0.1:8787", os.environ["LTC_URL"])
if served == code:
    sys.exit("http_client.py: docs/http.md does not name the service's usual address")
printed = run(served)
if printed != "(64, 64, 3, 3)":
    sys.exit(f"http_client.py: the code of docs/http.md printed {printed!r}")

# The control: with other bytes than the digest names, the code must fail.
broken = served.replace(".content", ".content[:-1] + b'x'", 1)
failed = subprocess.run([sys.executable, "-c", broken], capture_output=True, timeout=120, check=False)
if broken == served or failed.returncode == 0:
    sys.exit("http_client.py: damage is not noticed")
print("the five lines of docs/http.md fetch a table and hold it to its digest")
