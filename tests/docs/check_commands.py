"""check_commands.py SOURCES PROGRAMS: every command that a page or deploy/container shows, also those that run_commands.py cannot run (hours, a device, a
second machine): the program is there, knows the subcommand and each option; a filter of tests chooses some; a script is there."""
import functools
import os
import pathlib
import re
import shlex
import subprocess
import sys

FENCED = re.compile(r'^( *)```(?:sh|console)\n(.*?)^\1```$', re.M | re.S)
CODE = re.compile(r'^```(?:cpp|diff)\n.*?^```$', re.M | re.S)
PROGRAM = re.compile(r'^(?:\S*bin/)?((?:thimble|unit_|\w+_tests$)[\w-]*)$')
SCRIPT = re.compile(r'^(?:\./)?((?:deploy|tests|bench|docs|examples|\.ci)/[\w./-]+)$')
# Not built everywhere; what is absent is said, not passed over.
ABSENT = {'thimble-igtl', 'thimble-ros2', 'thimble-ros2-master', 'thimble-ros2-slave', 'thimble-bench', 'thimble-bench-window'}


@functools.cache
def said(*words):
    environment = {**os.environ, 'NO_COLOR': '1'}
    done = subprocess.run(words, capture_output=True, text=True, stdin=subprocess.DEVNULL, env=environment)
    return done.stdout if done.returncode == 0 else ''


def subcommands(program, *words):
    """Those that a shell would be offered: with a description, which the choices of an argument have not."""
    return re.findall(r'^([a-z][\w-]*)\t.', said(program, '--complete', *words, ''), re.M)


def check_ours(program, words):
    path, text = [program], said(program, '--help')
    if program.endswith('thimble-netem'):
        text += said(program, 'node', '--help')  # as a node it is not told so
    for word in words:
        if word in subcommands(*path) or (program.endswith('bench') and len(path) == 1 and re.fullmatch('[a-z][a-z-]+', word)):
            path.append(word)
            text = said(*path, '--help')
        elif word == '--' or '{' in word:
            return
        elif len(path) == 1 and program.endswith('/thimble') and word == words[0] and not word.startswith('-'):
            yield f'thimble knows no command {word}'
            return
        elif re.match(r'--?[A-Za-z]', word):
            option = word.split('=')[0]
            if not re.search(rf'(?<![\w-]){re.escape(option)}(?![\w-])', text):
                yield f'{" ".join([path[0].rsplit("/", 1)[1], *path[1:]])} knows no {option}'


def check_tests(program, words):
    for word in words:
        if word.startswith('--gtest_filter=') and not re.search(r'^  \S', said(program, '--gtest_list_tests', word), re.M):
            yield f'{word} chooses no test of {program.rsplit("/", 1)[1]}'


def check_one(words, sources, programs):
    while words and (words[0] in ('sudo', 'exec', 'mpirun', 'nice', 'python3', 'timeout', 'time') or re.match(r'[A-Z_]+=', words[0])):
        words = words[1:]
    if not words:
        return
    ours, script = PROGRAM.match(words[0]), SCRIPT.match(words[0])
    if ours:
        program = programs / ours[1]
        if not program.exists():
            if ours[1] not in ABSENT:
                yield f'there is no program {ours[1]}'
            return
        yield from (check_ours if ours[1].startswith('thimble') else check_tests)(str(program), words[1:])
    elif script and not (sources / script[1]).exists():
        yield f'there is no {script[1]}'


def commands(page):
    """(line number, command): lines of shell blocks and indented lines that begin with a program or script of ours."""
    text = re.sub(r'\\\n\s*', ' ', page)
    inside = [(found.start(2), found[2]) for found in FENCED.finditer(text)]
    plain = CODE.sub(lambda code: '\n' * code[0].count('\n'), text)
    for start, block in [*inside, (0, '\n'.join('' if not line.startswith('    ') else line for line in plain.split('\n')))]:
        for number, line in enumerate(block.split('\n')):
            line = re.sub(r'^(\$|- run:|command:) |\s#\s.*$', '', line.strip())
            for part in re.split(r'\s*(?:&&|\|\||\||;|&$|\s[12]?>>?\s?\S+)\s*', line):
                try:
                    words = shlex.split(part)
                except ValueError:
                    continue
                if words:
                    yield page[:start].count('\n') + number + 1, words


def main():
    sources, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    wrong, count = [], 0
    for page in [*sources.glob('*.md'), *(sources / 'docs').rglob('*.md'), *(sources / 'deploy/container').glob('*.y*ml')]:
        for number, words in commands(page.read_text()):
            count += bool(PROGRAM.match(words[0]) or SCRIPT.match(words[0]))
            wrong += [f'{page.relative_to(sources)}:{number}: {fault}' for fault in check_one(words, sources, programs)]
    print('\n'.join(dict.fromkeys(wrong)) or f'{count} commands, all known')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
