"""run_commands.py SOURCES PROGRAMS PAGE...: does what the pages tell a reader to do.

Each page in a scratch folder of its own, in which deploy/ and docs/ are the project's and build/release/bin has the programs:
  ```toml   a first line "# NAME.toml: ..." makes it a file of that name
  ```sh     run by bash; it must end with exit code 0
  ```console  lines after "$ " are run; the output must hold the lines below in their order ("..." stands for anything), and
            "[exit N]" is the exit code (0 if absent)
A line <!-- not run: WHY --> before a block keeps it from being run, and is printed; <!-- not run if `COMMAND`: WHY --> does where
COMMAND ends with 0."""
import fcntl
import os
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time

BLOCK = re.compile(r'^(?P<indent> *)```(?P<kind>toml|sh|console)\n(?P<text>.*?)^(?P=indent)```$', re.M | re.S)
NOT_RUN = re.compile(r'<!-- not run: ((?:(?!-->).)*) -->\s*$', re.S)
REAL_TIME = re.compile(r'thimble (run|up|play)\b')
NOT_RUN_IF = re.compile(r'<!-- not run if `([^`]+)`: ((?:(?!-->).)*) -->\s*$', re.S)
LIMIT_S = 60


def raise_loopback():
    """In a new network namespace the loopback interface is down."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack('16sh14x', b'lo', 0x1)  # IFF_UP
        fcntl.ioctl(any_socket, 0x8914, request)  # SIOCSIFFLAGS


def in_a_network_of_its_own():
    """Starts this script again where no other test's ports are in the way, if this kernel lets it."""
    if os.environ.get('THIMBLE_DOCS_NETWORK'):
        if os.environ['THIMBLE_DOCS_NETWORK'] == 'own':
            raise_loopback()
        return
    own = subprocess.run(['unshare', '-rn', 'true'], capture_output=True).returncode == 0
    os.environ['THIMBLE_DOCS_NETWORK'] = 'own' if own else 'shared'
    words = [sys.executable, '-B', *sys.argv]
    if not own:
        print('no network of its own here (unshare -rn): ports may be in use')
    words = ['unshare', '-rn', *words] if own else words
    os.execvp(words[0], words)


def run(text, folder, environment):
    return subprocess.run(['bash', '-euo', 'pipefail', '-c', text], cwd=folder, env=environment, text=True, timeout=LIMIT_S,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def lacking(expected, output):
    """The first expected line that the output does not have after the one before it."""
    lines, at = output.splitlines(), 0
    for line in expected:
        parts = [re.escape(part) for part in line.strip().split('...')]
        pattern = re.compile('.*'.join(parts))
        while at < len(lines) and not pattern.search(lines[at]):
            at += 1
        if at == len(lines):
            return line
        at += 1
    return None


def do_console(text, folder, environment):
    for command in re.split(r'^\$ ', text, flags=re.M)[1:]:
        typed, _, rest = command.partition('\n')
        code = re.search(r'^\[exit (\d+)\]$', rest, re.M)
        expected = [line for line in rest.splitlines() if line.strip() not in ('', '...') and not line.startswith('[exit ')]
        done = run(typed, folder, environment)
        missing = lacking(expected, done.stdout)
        wanted = int(code[1]) if code else 0
        if done.returncode != wanted or missing is not None:
            return f'$ {typed}\nexit code {done.returncode}, the page says {wanted}; not found: {missing}\nit said:\n{done.stdout}'
    return None


def do_block(block, folder, environment):
    text = re.sub(f'^{block["indent"]}', '', block['text'], flags=re.M)
    if block['kind'] == 'toml':
        name = re.match(r'# ([\w.-]+\.toml):', text)
        if name:
            (folder / name[1]).write_text(text)
        return None
    if block['kind'] == 'console':
        return do_console(text, folder, environment)
    done = run(text, folder, environment)
    return None if done.returncode == 0 else f'{text}\nended with {done.returncode}:\n{done.stdout}'


def reason_against(before, folder, environment):
    always, sometimes = NOT_RUN.search(before), NOT_RUN_IF.search(before)
    if always:
        return always[1]
    return sometimes[2] if sometimes and run(sometimes[1], folder, environment).returncode == 0 else None


def do_page(page, sources, programs):
    text, count = page.read_text(), 0
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for name in ['deploy', 'docs']:
            (folder / name).symlink_to(sources / name)
        (folder / 'build/release').mkdir(parents=True)
        (folder / 'build/release/bin').symlink_to(programs)
        environment = {**os.environ, 'PATH': f'{programs}:{os.environ["PATH"]}', 'NO_COLOR': '1', 'HOME': scratch}
        environment.pop('DISPLAY', None)
        environment.pop('WAYLAND_DISPLAY', None)
        for block in BLOCK.finditer(text):
            reason = reason_against(text[:block.start()], folder, environment)
            if reason:
                print(f'{page.name}: not run: {" ".join(reason.split())}')
                continue
            wrong = do_block(block, folder, environment)
            if wrong:
                print(f'{page.name}: line {text[:block.start()].count(chr(10)) + 1}:\n{wrong}')
                return False
            count += block['kind'] != 'toml'
    print(f'{page.name}: {count} blocks run in {time.monotonic() - began:.1f} s')
    return True


def main():
    in_a_network_of_its_own()
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    pages = [sources / name for name in sys.argv[3:]]
    good = True
    for page in pages:
        done = do_page(page, sources, programs)
        if not done and REAL_TIME.search(page.read_text()):
            # A machine that stands still for half a second ends a real-time trial: that is no mistake of the page.
            print('once more:')
            done = do_page(page, sources, programs)
        good &= done
    sys.exit(0 if good else 1)


if __name__ == '__main__':
    main()
