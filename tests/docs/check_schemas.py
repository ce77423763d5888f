"""check_schemas.py SOURCES PROGRAMS: deploy/schema against its meta-schema and against what the programs read.

1. Each schema is valid JSON Schema. Each shipped file, and a profile of thimble-netem fit, names its own in the first line and is valid by it.
2. A session that `thimble check` accepts is valid: the pages' examples, and values at the limits.
3. Mistakes that it refuses are refused by the schema too, but for those of which a schema cannot know.
4. Taplo, the validator of editors, finds the schemas by the first lines and says the same (deploy/install-validators)."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

try:
    import jsonschema
except ImportError:
    print('needs package python3-jsonschema')
    sys.exit(77)

KINDS = {'sessions': 'session', 'scenes': 'scene', 'profiles': 'profile', 'pages': 'pages'}
# Of a session file, where no other kind is named. A scene, profile or page set is checked by a session that names it.
WRONG = [
    'sesion = {}',
    '[session]\nmodalitis = ["HF"]',
    '[session]\nmodalities = "HF"',
    '[session]\ndelays_s = ["50 parsec"]',
    '[session]\ndelays_s = ["1.2.3s"]',
    '[session]\ndelays_s = [50]',
    '[session]\nseed = "1"',
    '[session]\nseed = 1.5',
    '[session]\norder = "random"',
    '[netem.force]\ndelay_s = -0.1',
    '[netem.force]\ndelay_s = "ms"',
    '[netem.force]\nloss = 1.5',
    '[netem.force]\nloss = { share = "all" }',
    '[guard]\nforce_limit_N = 1000.1',
    '[guard]\nforce_limit_N = "50ms"',
    '[protocol]\nblinded = "yes"',
    'network = 27000',
    '[slave_sim]\nscene = 3',
    'scene: [tissue]\nstiffness_N_per_m = "soft"',
    'scene: [tisue]',
    'profile: [up]\ndelay_s = true',
    'profile: [up]\njitter = "some"',
    'pages: [instructions]\nwelcome = 3',
]
RIGHT = ['', '# nothing but a comment'] + [f'[netem.force]\ndelay_s = {text}' for text in (
    '0', '0.05', '2.9', '"50ms"', '"50 ms"', '"0.05s"', '"1.5e2us"', '"+5.ms"', '".5 \u00b5s"', '".5\u03bcs"', '"5s"', '"1min"', '"0h"')] + [
    '[session]\ndelays_s = [0, "50ms"]', '[session]\nsubject = 2', '[netem.force]\nloss = { share = 0.1 }',
    'scene: [tissue]\nstiffness_N_per_m = 100\n[fixture]', 'profile: [up]\ndelay_s = "20ms"\njitter = "uniform"\njitter_spread_s = "1 ms"']
# Text that is beyond a range, a whole number as a decimal, keys that contradict each other, files that are not there.
ONLY_READER = [
    '[netem.force]\ndelay_s = "2min"',
    '[session]\nseed = 1.0',
    '[session]\ndelays_s = [0.05]\n[netem.force]\ndelay_s = 0.02',
    '[netem.force]\nprofile = "no-such-network"',
]
NAMED_BY = {'scene': '[slave_sim]\nscene = "{}"', 'profile': '[netem.force]\nprofile = "{}"', 'pages': '[instructions]\npages = "{}"'}


def shipped(sources):
    for folder, kind in KINDS.items():
        for file in (sources / 'deploy' / folder).glob('*.toml'):
            yield file, kind
    for file in [*(sources / 'examples').rglob('*.toml'), sources / 'deploy/container/session.toml']:
        yield file, 'session'


def is_valid(schema, text):
    try:
        return jsonschema.Draft202012Validator(schema).is_valid(tomllib.loads(text))
    except tomllib.TOMLDecodeError:
        return False


class Cases:
    """Files in `folder`, with what `thimble check` and their schema say."""

    def __init__(self, folder, thimble, schema_folder):
        self.folder, self.thimble, self.count = folder, thimble, 0
        self.schemas = {kind: json.loads((schema_folder / f'{kind}.json').read_text()) for kind in KINDS.values()}
        self.schema_folder = schema_folder

    def write(self, case):
        named = re.match(r'(scene|profile|pages): ', case)
        kind, text = (named[1], case[named.end():]) if named else ('session', case)
        self.count += 1
        file = self.folder / f'{self.count}.toml'
        file.write_text(f'#:schema {self.schema_folder}/{kind}.json\n{text}\n')
        return file, kind, text

    def accepted(self, file, kind):
        """By the reader; anything but good and refused is an Error."""
        if kind != 'session':
            session = self.folder / f'session{self.count}.toml'
            session.write_text(NAMED_BY[kind].format(file.name))
            file = session
        code = subprocess.run([self.thimble, 'check', file], capture_output=True).returncode
        if code not in (0, 2):
            raise RuntimeError(f'thimble check {file}: exit code {code}')
        return code == 0

    def check(self, case, reader, schema):
        """What is not as it should be; and the file."""
        file, kind, text = self.write(case)
        said = [f'thimble check {"refuses" if reader else "accepts"}: {case!r}'] if self.accepted(file, kind) != reader else []
        if is_valid(self.schemas[kind], text) != schema:
            said.append(f'{kind}.json {"refuses" if schema else "accepts"}: {case!r}')
        return file, said


def check_file(file, name, schema_file, schema):
    text = file.read_text()
    named = re.match(r'#:schema (\S+)\n', text)
    if not named or (file.parent / named[1]).resolve() != schema_file:
        yield f'{name}: its first line does not name deploy/schema/{schema_file.name}'
    elif not is_valid(schema, text):
        yield f'{name} is not valid by deploy/schema/{schema_file.name}'


def check_shipped(sources, programs, folder, schemas):
    for kind, schema in schemas.items():
        try:
            jsonschema.Draft202012Validator.check_schema(schema)
        except jsonschema.SchemaError as error:
            yield f'{kind}.json is no JSON Schema: {error.message}'
    fitted, trace = folder / 'fitted.toml', folder / 'measured.csv'
    trace.write_text('time_s,delay_s,loss\n' + ''.join(f'{i / 100},{0.02 + i % 7 / 1000},{i % 50 // 49}\n' for i in range(300)))
    subprocess.run([programs / 'thimble-netem', 'fit', trace, '--out', fitted], check=True, capture_output=True)
    for file, kind in [*shipped(sources), (fitted, 'profile')]:
        yield from check_file(file, file.name, sources / f'deploy/schema/{kind}.json', schemas[kind])


def check_examples(sources, cases):
    """Of the pages: what is a session by itself."""
    for page in (sources / 'docs').rglob('*.md'):
        for text in re.findall(r'^```toml\n(.*?)^```', page.read_text(), re.M | re.S):
            if is_valid(cases.schemas['session'], text):
                continue
            file, kind, _ = cases.write(text)
            if cases.accepted(file, kind):
                yield f'{page.relative_to(sources)}: session.json refuses an example that thimble check accepts:\n{text}'


def check_taplo(sources, right, wrong):
    taplo = next(iter((sources / 'build/taplo').glob('cli-*.js')), None)
    if not taplo:
        print('without Taplo: deploy/install-validators')
        return
    done = subprocess.run(['node', taplo, 'lint', '--no-auto-config', *right, *wrong], capture_output=True, text=True)
    refused = {pathlib.Path(name) for name in re.findall(r'schema validation failed path="([^"]*)"', done.stdout + done.stderr)}
    if refused != set(wrong) or 'WARN' in done.stderr:
        yield f'Taplo refuses too much: {refused - set(wrong)}; too little: {set(wrong) - refused}\n{done.stderr[-2000:]}'


def main():
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as folder:
        cases = Cases(pathlib.Path(folder), programs / 'thimble', sources / 'deploy/schema')
        said = [*check_shipped(sources, programs, cases.folder, cases.schemas), *check_examples(sources, cases)]
        files = {}
        for name, texts, verdicts in [('right', RIGHT, (True, True)), ('wrong', WRONG, (False, False)), ('reader', ONLY_READER, (False, True))]:
            checked = [cases.check(text, *verdicts) for text in texts]
            files[name] = [file for file, _ in checked]
            said += [line for _, lines in checked for line in lines]
        good = [*(file for file, _ in shipped(sources)), *files['right'], *files['reader']]
        said += check_taplo(sources, good, files['wrong'])
    print('\n'.join(said) or f'{cases.count} files, of which {len(WRONG)} mistakes: thimble and the schemas say the same')
    sys.exit(1 if said else 0)


if __name__ == '__main__':
    main()
