#!/usr/bin/env python3
"""bundle.py BUILD OUT: puts page, styles, scripts and the compiled C++ into one HTML file, which needs nothing else."""
import base64
import gzip
import pathlib
import re
import sys

MOST_BYTES = 2_000_000


def keys(words: str, language: str) -> list[str]:
    """The keys of a language in words.js."""
    part = words.split(f"\n  {language}: {{", 1)[1].split("\n  },", 1)[0]
    plain = re.sub(r"'(?:[^'\\]|\\.)*'|\"[^\"]*\"", "''", part)
    return sorted(re.findall(r"(\w+):", plain))


def main(build: pathlib.Path, out: pathlib.Path) -> int:
    page = pathlib.Path(__file__).parent / "page"
    words = (page / "words.js").read_text()
    if keys(words, "en") != keys(words, "it"):
        print("bundle.py: words.js has other keys in it than in en", file=sys.stderr)
        return 1
    packed = base64.b64encode(gzip.compress((build / "thimble.wasm").read_bytes(), 9, mtime=0)).decode()
    scripts = [words, (build / "thimble.js").read_text(), f"const PACKED = '{packed}';"]
    scripts += [(page / name).read_text() for name in ("engine.js", "paint.js", "replay.js", "page.js", "start.js")]
    html = (page / "index.html").read_text()
    html = html.replace("/*STYLE*/", (page / "style.css").read_text())
    html = html.replace("/*SCRIPT*/", "\n".join(scripts).replace("</script", "<\\/script"))
    out.write_text(html)
    size = out.stat().st_size
    print(f"{out}: {size / 1e6:.2f} MB")
    if size > MOST_BYTES:
        print(f"bundle.py: {out} is larger than {MOST_BYTES} bytes", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
