"""generate.py SOURCES PROGRAMS OUT: the pages of the site, with the reference written from the programs themselves.

Copies README's neighbours and docs/ to OUT and adds docs/reference/: keys (thimble config reference), commands (--help),
messages (common/messages.fbs), columns (headers of files that the programs write now)."""
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

NOT_INSTALLED = {'thimble-bench', 'thimble-bench-window'}


def said_by(words, cwd=None):
    run = subprocess.run([str(word) for word in words], text=True, capture_output=True, cwd=cwd)
    if run.returncode != 0:
        sys.exit(f'{words} ended with {run.returncode}:\n{run.stdout}{run.stderr}')
    return run.stdout


def subcommands(program, words):
    """Those that a shell would be offered: with a description, which the choices of an argument have not."""
    if 'node' in words:
        return []  # thimble-netem's own commands are not a node's
    done = subprocess.run([program, '--complete', *words, ''], text=True, capture_output=True)
    return re.findall(r'^([a-z][a-z-]*)\t.', done.stdout, re.M)


def write_commands(programs, out):
    out.mkdir(parents=True)
    names = {}

    def page(words):
        text = said_by([programs / words[0], *words[1:], '--help'])
        name = '-'.join(words)
        names[name] = ' '.join(words)
        (out / f'{name}.md').write_text(f'# {" ".join(words)}\n\n```text\n{text.rstrip()}\n```\n')
        for sub in subcommands(programs / words[0], words[1:]):
            page([*words, sub])

    for program in sorted(path.name for path in programs.glob('thimble*')):
        if program not in NOT_INSTALLED:
            page([program])
    # thimble-netem lists only what it does alone.
    page(['thimble-netem', 'node'])
    listed = '\n'.join(f'- [{title}](commands/{name}.md)' for name, title in names.items())
    entries = '\n'.join(f'commands/{name}' for name in names)
    (out.parent / 'commands.md').write_text(
        '# Commands\n\nWhat each program says with `--help`. Exit codes: 0 ok, 1 failed or interrupted, 2 usage or configuration, '
        f'3 network, 4 real time, 5 data.\n\n{listed}\n\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n')


# Page, kind of thimble config reference, title, where there is more about the keys.
KEY_PAGES = [('keys', 'session', 'Every key of a session file', '[session files](../session-files.md), [the network](../network.md)'),
             ('scene-keys', 'scene', 'Every key of a scene file', '[scenes](../scenes.md)'),
             ('profile-keys', 'profile', 'Every key of a network profile',
              '[network profiles](../network-profiles.md), [the network](../network.md)')]


def write_keys(programs, out):
    for page, kind, title, meanings in KEY_PAGES:
        (out / f'{page}.md').write_text(
            f'# {title}\n\nAs the programs read them (`thimble config reference {kind}`). More about them: {meanings}.\n'
            '`[table[]]` may stand several times, as `[[table]]`. Others: '
            + ', '.join(f'[{kind_of} files]({other}.md)' for other, kind_of, *_ in KEY_PAGES if other != page) + '.\n\n'
            + said_by([programs / 'thimble', 'config', 'reference', kind]))


def write_messages(schema, out):
    text = ('# Every field of every message\n\nFrom `common/messages.fbs`. What they are for: [the protocol](../protocol.md).\n')
    for kind, name, base, body in re.findall(r'^(enum|struct) (\w+)(?: : (\w+))? \{(.*?)\}', schema, re.M | re.S):
        text += f'\n## {name}\n\n'
        if kind == 'enum':
            text += '| value | number |\n| --- | --- |\n'
            text += ''.join(f'| `{a}` | {b} |\n' for a, b in re.findall(r'(\w+) = (\d+)', body))
            continue
        text += '| field | type | |\n| --- | --- | --- |\n'
        for field, sort, remark in re.findall(r'^\s*(\w+):([^;]+);(?:\s*//\s*(.*))?$', body, re.M):
            text += f'| `{field}` | `{sort}` | {remark.replace("|", ",")} |\n'
    (out / 'messages.md').write_text(text)


def header(path):
    with open(path, newline='') as file:
        return next(csv.reader(line for line in file if not line.startswith('#')))


def written_tables(programs, scratch):
    """(name, who writes it, columns) of each kind of table, by letting the programs write a small one."""
    thimble = programs / 'thimble'
    study = [thimble, 'study', '-e', '3', '-n', '1', '--no-control']
    said_by([*study, '--trajectories', '--out', 's'], scratch)
    said_by([*study[:-1], '--seeds', '2', '--out', 'seeds'], scratch)
    said_by([*study[:-1], '--vary', 'handle.friction_N=0.5:0.6:2', '--out', 'vary'], scratch)
    (scratch / 'needle.csv').write_text('time_s,position_needle_m\n0,0\n1,0.03\n')
    said_by([thimble, 'replay', '--needle', 'needle.csv', '--out', 'forces.csv'], scratch)
    said_by([thimble, 'sweep', '--mass-kg', '1', '--damping-Ns-per-m', '20', '--stiffness-N-per-m', '500', '--delay-s',
             '0:0.1:2', '--contact-stiffness-N-per-m', '1000:2000:2', '--out', 'map'], scratch)
    said_by([thimble, 'compensators', '--only', 'CF', '--subjects', '1', '--delays-s', '0', '--out', 'compensators'], scratch)
    said_by([thimble, 'board', '--quick', '--only', 'CF,every-sample,0ms', '--out', 'board'], scratch)
    trajectory = next((scratch / 's/trajectories').iterdir())
    return [('trials.csv', 'run, study, participant sessions: a line per trial; also control.csv, no_lag.csv, virtual.csv', 's/trials.csv'),
            ('*_curves.csv', 'study: a line per trial', 's/trials_curves.csv'),
            ('subjects.csv', 'study: a line per virtual subject', 's/subjects.csv'),
            ('trajectories/*.csv', 'run, study --trajectories: a line per millisecond', trajectory),
            ('claims_seeds.csv, claims_draws.csv', 'study --seeds, --draws', 'seeds/claims_seeds.csv'),
            ('claims_vary.csv', 'study --vary', 'vary/claims_vary.csv'),
            ('OUT.csv', 'replay: a line per sample', 'forces.csv'),
            ('OUT.events.csv', 'replay: a line per transition', 'forces.events.csv'),
            ('map.csv', 'sweep: a line per point', 'map/map.csv'),
            ('compensators.csv', 'compensators: a line per condition and delay', 'compensators/compensators.csv'),
            ('board.csv', 'board: a line per controller, codec and condition; _low and _high: 90 % intervals', 'board/board.csv')]


def short(column):
    """The columns of curves are one per grid point of their axis, those of intervals are their measure's."""
    column = re.sub(r'_(low|high)$', '', column)
    return re.sub(r'^(needle|surface)_-?[\d.]+(s|%)$', r'\1_N\2', column)


def write_columns(sources, programs, out, scratch):
    meanings = tomllib.loads((sources / 'docs/site/columns.toml').read_text())
    tables = [(name, who, list(dict.fromkeys(map(short, header(scratch / file)))))
              for name, who, file in written_tables(programs, scratch)]
    clocks = re.search(r'kClockColumns\{(.*?)\};', (sources / 'session/clocks/clock_summary.cpp').read_text(), re.DOTALL)
    tables.append(('nodes/clocks_*ms.csv', 'run: a line per clock probe', re.findall(r'"(\w+)"', clocks[1])))
    text = ('# Every column of every table\n\nComma-separated, a header line, SI units named in the columns; lines that begin with # are '
            'remarks. From the headers that the programs write.\n`thimble log export` writes a table per message, whose columns are '
            '[its fields](messages.md). `draws.csv` (`study --draws`) has a column per drawn [key](keys.md).\n')
    unknown = {column for _, _, columns in tables for column in columns} - meanings.keys()
    unused = meanings.keys() - {column for _, _, columns in tables for column in columns}
    if unknown or unused:
        sys.exit(f'docs/site/columns.toml: say what these columns mean: {sorted(unknown)}; remove: {sorted(unused)}')
    for name, who, columns in tables:
        text += f'\n## {name}\n\n`thimble` {who}.\n\n| column | |\n| --- | --- |\n'
        text += ''.join(f'| `{column}` | {meanings[column]} |\n' for column in columns)
    (out / 'columns.md').write_text(text)


def point_to_sources(page, sources, out):
    """Links to files that are no pages of the site become their names."""
    folder = page.parent

    def replace(match):
        text, target = match[1], match[2].split('#')[0]
        if '://' in target or not target or (folder / target).is_file():
            return match[0]
        place = (sources / folder.relative_to(out) / target).resolve()
        if not place.exists():
            sys.exit(f'{page.relative_to(out)}: dead link {match[2]}')
        return text if text.startswith('`') else f'`{place.relative_to(sources)}`'

    page.write_text(re.sub(r'(?<!!)\[([^\]]*)\]\(([^)\s]+)\)', replace, page.read_text()))


def with_unlisted(contents, out):
    """Pages that contents.md does not place stand at the end of the reference."""
    pages = sorted(str(page.relative_to(out).with_suffix('')) for page in out.rglob('*.md'))
    unlisted = [page for page in pages if page not in contents.splitlines()]
    return contents.replace('\nCHANGELOG\n', '\n'.join(['', *unlisted, 'CHANGELOG', '']), 1)


def embed_page(sources, out):
    """The experiment in one page, where deploy/browser has built it: in its own page, and named at the top of the first."""
    page = sources / 'build/browser/thimble.html'
    if not page.exists():
        return
    shutil.copy(page, out)
    manual = out / 'docs/browser.md'
    title, rest = manual.read_text().split('\n', 1)
    manual.write_text(f'{title}\n\n<p><a href="../thimble.html">In a window of its own</a></p>\n'
                      f'<iframe class="experiment" src="../thimble.html" title="The experiment"></iframe>\n{rest}')
    first = out / 'index.md'
    title, rest = first.read_text().split('\n', 1)
    first.write_text(f'{title}\n\n<p class="try"><a href="thimble.html"><strong>Try it here, in this browser</strong></a></p>\n{rest}')


def main():
    sources, programs, out = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(sources / 'docs', out / 'docs', ignore=shutil.ignore_patterns('site', '__pycache__'))
    for name in ['ARCHITECTURE.md', 'CHANGELOG.md', 'CONTRIBUTING.md', 'LICENSE', 'CITATION.cff']:
        shutil.copy(sources / name, out)
    # The first page is the README, with the site's own contents below it.
    contents = (sources / 'docs/site/contents.md').read_text()
    contents = with_unlisted(contents, out)
    (out / 'index.md').write_text((sources / 'README.md').read_text() + '\n' + contents)
    embed_page(sources, out)
    for name in ['conf.py', 'diagrams.py', 'style.css']:
        shutil.copy(sources / 'docs/site' / name, out)
    reference = out / 'docs/reference'
    reference.mkdir(exist_ok=True)
    write_commands(programs, reference / 'commands')
    write_keys(programs, reference)
    write_messages((sources / 'common/messages.fbs').read_text(), reference)
    scratch = out.parent / 'site-scratch'
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    write_columns(sources, programs, reference, scratch)
    for page in out.rglob('*.md'):
        point_to_sources(page, sources, out)


if __name__ == '__main__':
    main()
