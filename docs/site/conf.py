"""Sphinx: the pages of docs/ as a static site. deploy/docs builds it."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

project = 'Thimble'
author = 'the authors of Thimble'
copyright = author
release = version = os.environ.get('THIMBLE_VERSION', '')
extensions = ['myst_parser', 'diagrams']
myst_heading_anchors = 4
html_theme = 'furo'
html_title = 'Thimble'
html_static_path = ['style.css']
# The experiment in one page, if it was built.
html_extra_path = [name for name in ['thimble.html'] if os.path.exists(os.path.join(os.path.dirname(os.path.abspath(__file__)), name))]
html_css_files = ['style.css']
html_show_sphinx = False
html_copy_source = False
pygments_style = 'friendly'
highlight_language = 'none'
templates_path = []
