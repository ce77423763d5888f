"""check_docs.py SOURCES PROGRAMS: the hand-written pages against the programs and the folders.

1. docs/session-files.md (and the page it sends to for a table) names every key that the readers know, and no other.
2. Its defaults are the readers', where both are one number.
3. Every string that a reader asks for by name is a key of the reference, so that none is hidden behind a condition; the same
   for scenes and network profiles, whose pages name every key, and whose examples in deploy/ have no other.
4. Every figure of docs/figures and docs/pictures stands in docs/figures.md, and each that it names is there.
5. No link inside the repository is dead, nor the heading that it goes to.
6. docs/first-ten-minutes.md shows every step that deploy/quickstart says.
7. docs/programs.md has a row for every program, and every command of thimble."""
import json
import pathlib
import re
import subprocess
import sys
import tomllib

# Tables whose keys another page lists.
ELSEWHERE = {'netem.needle': 'network.md', 'netem.force': 'network.md', 'handle.hid': 'hid.md',
             'handle.falcon': 'handles.md', 'handle.force_dimension': 'handles.md', 'cutaneous.board': 'board-protocol.md',
             'fixture.event[]': 'scenes.md', 'netem': 'network.md'}
# Kind of file, where its readers are, the pages that name its keys, and its examples.
KINDS = [('scene', ['slave_sim/elements', 'slave_sim/scene_file.cpp'], ['scenes.md'], 'scenes'),
         ('profile', ['netem/profiles', 'netem/link_reader.cpp', 'netem/link_reader.cpp'], ['network-profiles.md', 'network.md'], 'profiles')]
# Read from files that are no session files: scenes, profiles, needles.
NO_SESSION = ['slave_sim/elements', 'slave_sim/scene', 'netem/profiles', 'netem/formats', 'netem/relay', 'netem/commands', 'thimble/log']
QUOTED = re.compile(r'`([A-Za-z]\w*)`')


ASKED = re.compile(r'\b(?:table|entry|own|link|trial|master|file|node|change|root\(\))\.'
                   r'(?:number|integer|boolean|text|choice|seconds|numbers|texts)\(\s*"(\w+)"')


def key_reference(programs, kind='session'):
    text = subprocess.run([programs / 'thimble', 'config', 'reference', '--kind', kind, '--json'], check=True, capture_output=True, text=True).stdout
    return {path: key for path, key in json.loads(text).items() if key['type'] not in ('table', 'tables')}


def page_tables(page):
    """{table: [(key, default or None)]} of the headings ### [table]."""
    found = {}
    for part in re.split(r'^### ', page, flags=re.M)[1:]:
        title, _, body = part.partition('\n')
        rows = []
        for line in re.findall(r'^\| (.*) \|$', body, re.M):
            cells = [cell.strip() for cell in re.split(r'(?<!\\)\|', line)]
            names = QUOTED.findall(cells[0])
            rows += [(name, cells[1] if len(names) == 1 else None) for name in names]
        for table in re.findall(r'\[([\w.]+)\](?!\()', title):
            found[table] = rows
    return found


def as_number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def check_keys(sources, keys):
    page = (sources / 'docs/session-files.md').read_text()
    tables = page_tables(page)
    for path, key in keys.items():
        table, name = path.rsplit('.', 1)
        top = next((known for known in ELSEWHERE if table.startswith(known)), None)
        text = (sources / 'docs' / ELSEWHERE[top]).read_text() if top else ''
        listed = dict(tables.get(table, []))
        # The pages of [instructions] stand in its text, and each has a title (`..._title`).
        if table == 'instructions':
            text, name = page, name.removesuffix('_title')
        if name not in listed and not re.search(rf'`{name}`' if table == 'instructions' else rf'\b{name}\b', text):
            yield f'docs/session-files.md: [{table}] lacks {name}'
        ours, theirs = as_number(listed.get(name)), as_number(key['default'])
        if ours is not None and theirs is not None and ours != theirs:
            yield f'docs/session-files.md: [{table}] {name} is said to be {ours} by default, and is {theirs}'
    for table, rows in tables.items():
        for name, _ in rows:
            if f'{table}.{name}' not in keys and table != 'instructions':
                yield f'docs/session-files.md: [{table}] {name}: no reader knows it'


def check_readers(sources, keys):
    names = {path.rsplit('.', 1)[1] for path in keys}
    for room in ['common', 'netem', 'master', 'slave_sim', 'cutaneous_node', 'visual_node', 'stability', 'session', 'analysis', 'study', 'thimble']:
        for file in (sources / room).rglob('*.cpp'):
            where = str(file.relative_to(sources))
            if any(where.startswith(prefix) for prefix in NO_SESSION):
                continue
            for name in ASKED.findall(file.read_text()):
                if name not in names:
                    yield f'{where}: reads {name}, which thimble config reference does not show'


def dotted(table, above=''):
    """Paths of the keys of a file, as the reference has them: entries of several tables, and what may be several, with []."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from dotted(value, f'{above}{key}.')
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for entry in value:
                yield from dotted(entry, f'{above}{key}[].')
        else:
            yield f'{above}{key}'


def check_kind(sources, keys, kind, readers, pages, examples):
    names = {path.rsplit('.', 1)[-1] for path in keys}
    text = ''.join((sources / 'docs' / page).read_text() for page in pages)
    for name in sorted(names):
        if not re.search(rf'\b{name}\b', text):
            yield f'docs/{pages[0]} does not name {name}'
    files = [file for reader in readers for file in ([sources / reader] if reader.endswith('.cpp') else (sources / reader).glob('*.cpp'))]
    for file in files:
        for name in ASKED.findall(file.read_text()):
            if name not in names:
                yield f'{file.relative_to(sources)}: reads {name}, which thimble config reference --kind {kind} does not show'
    listed = {path.replace('[]', '') for path in keys}
    for file in (sources / 'deploy' / examples).glob('*.toml'):
        for path in dotted(tomllib.loads(file.read_text())):
            if path.replace('[]', '') not in listed:
                yield f'{file.relative_to(sources)}: {path} is no key of thimble config reference --kind {kind}'


def check_figures(sources):
    page = (sources / 'docs/figures.md').read_text()
    files = {file.name: folder for folder in ['figures', 'pictures'] for file in (sources / 'docs' / folder).iterdir()
             if file.suffix in ('.svg', '.png')}
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
    text = subprocess.run([programs / 'thimble', '--help'], check=True, capture_output=True, text=True).stdout
    commands = re.findall(r'^  ([a-z][\w-]*) ', text.partition('\nSubcommands:')[2].partition('\n\n')[0], re.M)
    for name in [*(f'thimble {command}' for command in commands), *(file.name for file in programs.glob('thimble-*'))]:
        if not re.search(rf'`{name}[ `]', rows):
            yield f'docs/programs.md has no row for {name}'


def main():
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    keys = key_reference(programs)
    kinds = [(key_reference(programs, kind[0]), *kind) for kind in KINDS]
    wrong = [*check_keys(sources, keys), *check_readers(sources, keys), *check_figures(sources), *check_links(sources),
             *check_walk(sources), *check_programs(sources, programs)]
    for kind in kinds:
        wrong += check_kind(sources, *kind)
    print('\n'.join(wrong) or f'{", ".join(f"{len(of)} {kind}" for of, kind in [(keys, "session"), *[k[:2] for k in kinds]])} keys, all named')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
