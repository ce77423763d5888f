"""What deploy/quickstart says before it does anything: its help, its refusals, and without root the line that an administrator runs."""

import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1])
TOOLS = ("bash", "awk", "cat", "comm", "dirname", "paste", "sed", "sort", "apt-get")


def run(path, *words):
    return subprocess.run([ROOT / "deploy/quickstart", *words], env={**os.environ, "PATH": str(path)}, text=True,
                          stdin=subprocess.DEVNULL, capture_output=True, timeout=60)


def machine_of_a_user(folder):
    """A machine with no package installed, neither root nor sudo."""
    for tool in TOOLS:
        found = next(p for p in ("/usr/bin", "/bin", "/usr/sbin") if os.path.exists(f"{p}/{tool}"))
        os.symlink(f"{found}/{tool}", folder / tool)
    for name, says in (("id", "1000"), ("dpkg-query", "installed bash"), ("env", "")):
        script = '#!/bin/bash\nshift\nexec bash "$@"\n' if name == "env" else f"#!/bin/bash\necho {says}\n"
        (folder / name).write_text(script)
        (folder / name).chmod(0o755)
    return folder


def findings():
    with tempfile.TemporaryDirectory() as name:
        path = machine_of_a_user(pathlib.Path(name))
        for word in ("--help", "-h"):
            done = run(path, word)
            if done.returncode != 0 or "usage: deploy/quickstart" not in done.stdout or "==" in done.stdout:
                yield f"{word} does not explain, or does something: {done}"
        for words in (("--fast",), ("--help", "x"), ("out",)):
            done = run(path, *words)
            if done.returncode != 2 or "unknown argument" not in done.stderr or "==" in done.stdout:
                yield f"{words} is not refused: {done}"
        done = run(path)
        lines = [line for line in done.stderr.splitlines() if line.strip().startswith("apt install ")]
        if done.returncode != 1 or len(lines) != 1 or "==" in done.stdout:
            yield f"without root it does not stop with one line for apt: {done}"
        for package in ("g++", "gnuplot-nox", "libglfw3-dev", "libfmt9"):
            if not any(package in line.split() for line in lines):
                yield f"the line for apt lacks {package}: {lines}"


if __name__ == "__main__":
    found = list(findings())
    print("\n".join(found) or "the quickstart says what it should")
    sys.exit(1 if found else 0)
