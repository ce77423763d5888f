"""Mermaid blocks of the pages as pictures, without a browser: flowcharts by Graphviz, sequences as plain SVG."""
import html
import re
import subprocess

from docutils import nodes
from sphinx.transforms import SphinxTransform

TOKEN = re.compile(r'\s*(?P<id>\w+)(?P<shape>\(\[|\[|\(\()?(?:\s*"(?P<label>[^"]*)"\s*(?:\]\)|\]|\)\)))?\s*')
EDGE = re.compile(r'\s*(?:(?P<both><-\.->)|--\s*"(?P<solid>[^"]*)"\s*-->|-\.\s*"?(?P<dotted>[^".]*)"?\s*\.->|'
                  r'<-\.\s*"(?P<wide>[^"]*)"\s*\.->|(?P<plain>-->)|(?P<dots>-\.->))')


def quoted(text):
    return '"' + text.replace('<br/>', '\\n').replace('"', '\\"') + '"'


def flowchart(source):
    """Our subset: chains of nodes with labels, solid and dotted edges with labels."""
    lines = source.strip().splitlines()
    # Labels beside long arrows make a row too wide for a page; a column has room for them.
    labelled = any(len(label) > 20 for label in re.findall(r'--? "([^"]*)" --?>|-\. "([^"]*)" \.->', source) for label in label)
    direction = 'TB' if labelled else lines[0].split()[1]
    out = ['digraph { rankdir=%s; bgcolor=transparent; node [shape=box, style="rounded,filled", fillcolor="#eef3f8",'
           ' color="#4a6f96", fontname="sans-serif", fontsize=11]; edge [color="#555555", fontname="sans-serif", fontsize=10];'
           % direction]
    for line in lines[1:]:
        at, before, edge = 0, None, ''
        while at < len(line):
            node = TOKEN.match(line, at)
            if not node:
                raise ValueError(f'not understood as a node: {line[at:]!r}')
            at = node.end()
            if node['label'] is not None:
                out.append(f'{quoted(node["id"])} [label={quoted(node["label"].strip() or "lost")}];')
            if before:
                out.append(f'{quoted(before)} -> {quoted(node["id"])} [{edge}];')
            before = node['id']
            link = EDGE.match(line, at) if at < len(line) else None
            if at < len(line) and not link:
                raise ValueError(f'not understood as an edge: {line[at:]!r}')
            if link:
                at = link.end()
                text = link['solid'] or link['dotted'] or link['wide'] or ''
                dotted = not (link['plain'] or link['solid'])
                edge = f'label={quoted(text.strip())}' + (', style=dashed' if dotted else '')
                edge += ', dir=both' if link['both'] or link['wide'] else ''
    return subprocess.run(['dot', '-Tsvg'], input='\n'.join(out) + '}', text=True, check=True,
                          capture_output=True).stdout.split('?>', 1)[1].split('-->', 1)[-1]


def sequence(source):
    """participants, arrows (solid and dashed) and notes, from top to bottom."""
    names, rows = {}, []
    for line in source.strip().splitlines()[1:]:
        line = line.strip()
        if found := re.match(r'participant (\w+) as (.*)', line):
            names[found[1]] = found[2]
        elif found := re.match(r'(\w+)(--?>>)(\w+): (.*)', line):
            rows.append((found[1], found[3], found[4], found[2] == '-->>'))
        elif found := re.match(r'Note over (\w+),(\w+): (.*)', line):
            rows.append((found[1], found[2], found[3], None))
        else:
            raise ValueError(f'not understood: {line!r}')
    x = {name: 130 + 300 * i for i, name in enumerate(names)}
    wide, high = 300 * len(names), 50 + 34 * len(rows)
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" width="{wide}" font-family="sans-serif" font-size="12">'
           '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto-start-reverse">'
           '<path d="M0,0 L8,4 L0,8" fill="#555"/></marker></defs>']
    for name, title in names.items():
        svg.append(f'<line x1="{x[name]}" y1="30" x2="{x[name]}" y2="{high}" stroke="#9ab"/>'
                   f'<rect x="{x[name] - 125}" y="4" width="250" height="26" rx="6" fill="#eef3f8" stroke="#4a6f96"/>'
                   f'<text x="{x[name]}" y="21" text-anchor="middle">{html.escape(title)}</text>')
    for i, (one, other, text, dashed) in enumerate(rows):
        y = 60 + 34 * i
        middle = (x[one] + x[other]) / 2
        if dashed is None:
            svg.append(f'<rect x="{x[one] - 20}" y="{y - 18}" width="{x[other] - x[one] + 40}" height="24" fill="#fff6dd" stroke="#cb9"/>'
                       f'<text x="{middle}" y="{y - 2}" text-anchor="middle">{html.escape(text)}</text>')
            continue
        if one == other:
            svg.append(f'<text x="{x[one] + 8}" y="{y}">{html.escape(text)} &#8635;</text>')
            continue
        svg.append(f'<line x1="{x[one]}" y1="{y}" x2="{x[other]}" y2="{y}" stroke="#555" marker-end="url(#tip)"'
                   + (' stroke-dasharray="5 3"' if dashed else '') + '/>'
                   f'<text x="{middle}" y="{y - 5}" text-anchor="middle">{html.escape(text)}</text>')
    return ''.join(svg) + '</svg>'


class DrawMermaid(SphinxTransform):
    default_priority = 200

    def apply(self, **_):
        for block in list(self.document.findall(nodes.literal_block)):
            if block.get('language') != 'mermaid':
                continue
            kind = block.astext().split(None, 1)[0]
            drawn = {'flowchart': flowchart, 'sequenceDiagram': sequence}[kind](block.astext())
            block.replace_self(nodes.raw('', f'<div class="diagram">{drawn}</div>', format='html'))


def setup(app):
    app.add_transform(DrawMermaid)
    return {'parallel_read_safe': True}
