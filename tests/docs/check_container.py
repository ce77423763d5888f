"""check_container.py SOURCES PROGRAMS: deploy/container agrees with itself and with the programs. Its commands: check_commands.py.

1. thimble check takes session.toml, and each service of compose.yaml has the address that the session gives to its node.
2. Each service has the session file and the key at the places that its command and the session name.
3. The workflow has its steps, and its gate judges a board that `thimble board` wrote."""
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

try:
    import yaml
except ImportError:
    print('needs package python3-yaml')
    sys.exit(77)


def check_services(compose, session):
    wanted = {key.removeprefix('host_'): address for key, address in session['network'].items()}
    services = {name: service for name, service in compose['services'].items() if name != 'key'}
    found = {name: service['networks']['lab']['ipv4_address'] for name, service in services.items()}
    if found != wanted:
        yield f'compose.yaml has {found}, session.toml has {wanted}'
    for name, service in services.items():
        inside = {volume.split(':')[0]: volume.split(':')[1] for volume in service['volumes']}
        if inside['./session.toml'] not in service['command'].split():
            yield f'{name} reads another session file than the one it has: {service["command"]}'
        if session['security']['key_file'] != f'{inside["key"]}/lab.key':
            yield f'{name} has the key at another place than session.toml says'
    if compose['services']['key']['command'][-1].count(session['security']['key_file']) != 2:
        yield 'the service key makes another file than session.toml names'


def check_gate(workflow, thimble):
    """The step with awk: exit code 1 for a controller that oscillates, as HF does at 50 ms, 0 for one that does not."""
    gate = next(step['run'] for step in workflow['jobs']['controller']['steps'] if 'awk' in step.get('run', ''))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([thimble, 'board', '--quick', '--only', 'HF,CF,every-sample,50ms', '--out', 'out/mine'], cwd=folder, check=True,
                       capture_output=True)
        for name, code in [('HF', 1), ('CF', 0)]:
            said = subprocess.run(['sh', '-ec', gate.replace('"mine"', f'"{name}"')], cwd=folder, capture_output=True, text=True)
            if said.returncode != code or bool(re.search('oscillates: 50ms', said.stdout)) != bool(code):
                yield f'the gate of github-actions.yml ends with {said.returncode} for {name}: {said.stdout}{said.stderr}'


def main():
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    here, thimble = sources / 'deploy/container', programs / 'thimble'
    session = tomllib.loads((here / 'session.toml').read_text())
    wrong = list(check_services(yaml.safe_load((here / 'compose.yaml').read_text()), session))
    checked = subprocess.run([thimble, 'check', here / 'session.toml'], capture_output=True, text=True)
    if checked.returncode:
        wrong.append(checked.stderr)
    wrong += check_gate(yaml.safe_load((here / 'github-actions.yml').read_text()), thimble)
    print('\n'.join(wrong) or 'the container, its session and the workflow agree')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
