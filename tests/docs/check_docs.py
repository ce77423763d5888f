"""check_docs.py SOURCES PROGRAMS [--write]: the hand-written pages against the programs and the folders.

1. Every table of keys in docs/ is word for word that of thimble config reference, and every key stands in one. --write makes it so.
2. Every figure of docs/figures and docs/pictures stands in docs/figures.md, and each that it names is there.
3. No link inside the repository is dead, nor the heading that it goes to.
4. deploy/schema holds what thimble config schema says, which the shipped files name for editors. --write makes it so.
5. docs/first-ten-minutes.md shows every step that deploy/quickstart says.
6. docs/programs.md has a row for every program, and every command of thimble.
7. What thimble --help says of a command fits into a line of 90 characters."""
import pathlib
import re
import subprocess
import sys

KINDS = ('session', 'scene', 'pages', 'profile')
# <!-- keys KIND TABLE --> and maybe names of keys, which then are all that the table has. "-" is the table of keys in no table.
BLOCK = re.compile(r'^(<!-- keys (\S+) (\S+)((?: \w+)*) -->\n)(.*?)(<!-- end of keys -->)$', re.M | re.S)


def key_tables(programs):
    """{(kind, table): lines} of the tables that thimble config reference prints, head and all."""
    tables = {}
    for kind in KINDS:
        text = subprocess.run([programs / 'thimble', 'config', 'reference', kind], check=True, capture_output=True, text=True).stdout
        # A page links to the pages that a meaning names.
        text = re.sub(r'docs/([\w-]+\.md)', r'[\1](\1)', text)
        for part in re.split(r'^## ', text, flags=re.M)[1:]:
            title, _, table = part.partition('\n\n')
            for name in title.split(', ') if title.startswith('[') else ['[-]']:
                tables[kind, name[1:-1]] = table.strip().splitlines()
    return tables


def key_lines(tables, kind, table, names):
    head, dashes, *lines = tables[kind, table]
    wanted = [f'| `{name}` |' for name in names.split()] or ['|']
    return [head, dashes, *(line for line in lines if line.startswith(tuple(wanted)))]


def check_keys(sources, tables, write):
    shown = set()
    for page in (sources / 'docs').glob('*.md'):
        text = page.read_text()
        for begin, kind, table, names, body, end in BLOCK.findall(text):
            lines = key_lines(tables, kind, table, names)
            shown.update(lines)
            right = '\n' + '\n'.join(lines) + '\n\n'
            if body != right and not write:
                yield f'docs/{page.name}: [{table}] is not what thimble config reference says; check_docs.py ... --write mends it'
            text = text.replace(begin + body + end, begin + right + end)
        if write:
            page.write_text(text)
    for (kind, table), lines in tables.items():
        for line in lines:
            if line not in shown:
                yield f'no page of docs/ has a table of keys with this of a {kind} file, [{table}]: {line}'


def check_schemas(sources, programs, write):
    for kind in KINDS:
        file = sources / f'deploy/schema/{kind}.json'
        right = subprocess.run([programs / 'thimble', 'config', 'schema', kind], check=True, capture_output=True, text=True).stdout
        if write:
            file.write_text(right)
        elif not file.exists() or file.read_text() != right:
            yield f'deploy/schema/{file.name} is not what thimble config schema {kind} says; check_docs.py ... --write mends it'


def check_figures(sources):
    page = (sources / 'docs/figures.md').read_text()
    files = {file.name: folder for folder in ['figures', 'pictures'] for file in (sources / 'docs' / folder).iterdir()
             if file.suffix in ('.svg', '.png', '.webp')}
    rows = re.findall(r'^\| (`.*?) \|', page, re.M)
    named = {pathlib.Path(name).name for row in rows for name in re.findall(r'`([\w./-]+)`', row)}
    for name in sorted(files.keys() - named):
        yield f'docs/figures.md does not say which command makes {files[name]}/{name}'
    for name in sorted(named - files.keys()):
        yield f'docs/figures.md names {name}, which is in neither folder'


def anchors(page):
    """The headings' names in a link, as the site's builder and forges make them."""
    text = re.sub(r'^( *)```.*?^\1```', '', page.read_text(), flags=re.M | re.S)
    plain = (re.sub(r'\[([^]]*)\]\([^)]*\)', r'\1', title) for title in re.findall(r'^#+ (.*)$', text, re.M))
    return {re.sub(r'[^\w\- ]', '', title.strip().lower()).replace(' ', '-') for title in plain}


def check_links(sources):
    for page in [*sources.glob('*.md'), *(sources / 'docs').rglob('*.md')]:
        text = re.sub(r'^( *)```.*?^\1```', '', page.read_text(), flags=re.M | re.S)
        for target in re.findall(r'\]\(([^)\s]+)\)', text):
            name, _, heading = target.partition('#')
            # docs/reference/ is written when the site is built.
            if '://' in target or 'reference/' in name or target.startswith('mailto:'):
                continue
            there = page.parent / name if name else page
            if not there.exists():
                yield f'{page.relative_to(sources)}: dead link {target}'
            elif heading and there.suffix == '.md' and heading not in anchors(there):
                yield f'{page.relative_to(sources)}: no heading for {target}'


def check_walk(sources):
    page = (sources / 'docs/first-ten-minutes.md').read_text()
    for step in re.findall(r'^say "(.*)"$', (sources / 'deploy/quickstart').read_text(), re.M):
        if step.replace('$PWD/', '') not in page:
            yield f'docs/first-ten-minutes.md lacks the step "{step}" of deploy/quickstart'


def check_programs(sources, programs):
    rows = ''.join(re.findall(r'^\| (`.*?) \|', (sources / 'docs/programs.md').read_text(), re.M))
    text = subprocess.run([programs / 'thimble', '--complete', ''], check=True, capture_output=True, text=True).stdout
    commands = re.findall(r'^([a-z][\w-]*)\t', text, re.M)
    for command, what in re.findall(r'^([a-z][\w-]*)\t(.*)$', text, re.M):
        if len(what) > 90:
            yield f'thimble {command}: {len(what)} characters in thimble --help, expected at most 90: {what}'
    for name in [*(f'thimble {command}' for command in commands), *(file.name for file in programs.glob('thimble-*'))]:
        if not re.search(rf'`{name}[ `]', rows):
            yield f'docs/programs.md has no row for {name}'


def main():
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    tables = key_tables(programs)
    write = '--write' in sys.argv
    wrong = [*check_keys(sources, tables, write), *check_schemas(sources, programs, write), *check_figures(sources), *check_links(sources),
             *check_walk(sources), *check_programs(sources, programs)]
    print('\n'.join(wrong) or f'{len(tables)} tables of keys, all shown')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
