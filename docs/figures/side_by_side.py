#!/usr/bin/python3
"""side_by_side.py PROGRAMS OUT: the moving picture of the README. A virtual subject does experiment 3. The first trials with the force in
the hand (HF) and on the fingertip (CF) are drawn by thimble play --replay --frames, and stand side by side from the wall on.

PROGRAMS: the folder of thimble. OUT: a WebP file. It needs OpenGL, a screen or xvfb-run, and Debian's python3-pil and fonts-dejavu-core."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw, ImageFont

PER_S = 15
BEFORE_S, AFTER_S = 1.2, 4.8  # of the first contact with the wall
PART, SIZE, STRIP = (250, 60, 760, 600), (400, 424), 30  # of a frame, and what becomes of it
SIDES = [('HF', 'Force in the hand, 50 ms late'), ('CF', 'Force on the fingertip, 50 ms late')]
MOST_BYTES = 1_500_000


def run(*words):
    screen = [] if os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY') else ['xvfb-run', '-a']
    subprocess.run([*(screen if '--frames' in words else []), *map(str, words)], check=True)


def first_contact_s(trajectory):
    with open(trajectory, newline='') as file:
        rows = csv.DictReader(line for line in file if not line.startswith('#'))
        return next(float(row['time_s']) for row in rows if float(row['force_fixture_N']) != 0)


def frames_of(thimble, study, modality, scratch):
    with open(study / 'trials.csv', newline='') as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith('#')))
    number = 1 + next(i for i, row in enumerate(rows) if row['modality'] == modality)
    run(thimble, 'play', '--replay', study, '--trial', number, '--frames', scratch / modality, '--frames-per-s', PER_S)
    trajectory = next(path for path in sorted((study / 'trajectories').glob('*.csv'))
                      if f'trial{number:02d}_{modality}' in path.name and 'events' not in path.name)
    first = round((first_contact_s(trajectory) - BEFORE_S) * PER_S)
    return [scratch / modality / f'frame_{i:06d}.png' for i in range(first, first + round((BEFORE_S + AFTER_S) * PER_S))]


def beside(pair, font):
    whole = Image.new('RGB', (2 * SIZE[0], SIZE[1] + STRIP), (16, 17, 20))
    for i, (path, (_, title)) in enumerate(zip(pair, SIDES)):
        with Image.open(path) as frame:
            whole.paste(frame.convert('RGB').crop(PART).resize(SIZE, Image.Resampling.LANCZOS), (i * SIZE[0], STRIP))
        ImageDraw.Draw(whole).text(((i + 0.5) * SIZE[0], STRIP / 2), title, (255, 255, 255), font, anchor='mm')
    return whole


def main(programs, out):
    font = ImageFont.truetype('/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf', 17)
    with tempfile.TemporaryDirectory() as name:
        scratch = pathlib.Path(name)
        thimble, study = programs / 'thimble', scratch / 'study'
        run(thimble, 'study', '--experiment', 3, '--subjects', 1, '--seed', 1, '--no-control', '--trajectories', '--out', study)
        sides = [frames_of(thimble, study, modality, scratch) for modality, _ in SIDES]
        pictures = [beside(pair, font) for pair in zip(*sides)]
    pictures[0].save(out, 'WEBP', save_all=True, append_images=pictures[1:], duration=round(1000 / PER_S), loop=0, quality=55, method=4)
    size = out.stat().st_size
    print(f'{out}: {len(pictures)} frames, {size / 1e6:.2f} MB')
    return 0 if size <= MOST_BYTES else f'{out} is larger than {MOST_BYTES} bytes'


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
