"""A document as a page of HTML, as Markdown with its figures in it, and as PDF."""

from __future__ import annotations

import base64
import html
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from jinja2 import Environment, StrictUndefined
from markdown_it import MarkdownIt

from kapitsa_ros.reporting.figures.canvas import house_style
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from fpdf import FPDF
    from fpdf.fonts import FontFace

    from kapitsa_ros.reporting.report.document import Document, Drawing

_WIDTH, _HEIGHT = 4.8, 3.5  # in, of a panel: its letters are as large as the text beside it, on a phone too
_FIGURE = re.compile(r'<p><img src="([^"]*)" alt="([^"]*)" ?/?></p>')
_FIGURES = re.compile(r'(?:<figure.*?</figure>\s*)+', re.DOTALL)
_CAPTIONED = re.compile(r'<p><strong>([^<]*)</strong></p>\s*<table>')
_COLUMNS = 2  # of figures on A4
_GAP = 4.0  # mm between them
_CAPTION = 14.0  # mm
_BEFORE_TEXT, _BEFORE_FIGURES = 45.0, 110.0  # mm that a heading needs for itself and what follows it
_DOTS = 160  # an inch


def as_html(document: Document) -> str:
    """Return one page that asks nothing of any other file or host; the figures' text can be selected."""
    drawings = document.drawings
    drawn = {drawing.name: _svg(drawing) for drawing in drawings}

    def figure(found: re.Match[str]) -> str:
        tall = ' class="tall"' if found[1] in stacked else ''
        return f'<figure{tall}>{drawn[found[1]]}<figcaption>{found[2]}</figcaption></figure>'

    stacked = {drawing.name for drawing in drawings if len(drawing.figure.axes) > 1}
    body = _FIGURE.sub(figure, _with_captions(_to_html(document.text)))
    body = _FIGURES.sub(r'<div class="figures">\n\g<0></div>\n', body)
    environment = Environment(autoescape=False, undefined=StrictUndefined)  # noqa: S701 - the body is HTML already
    page = environment.from_string(resource_path('config', 'report', 'report.html').read_text(encoding='utf-8'))
    return page.render(body=body, title=document.title)


def write_html(document: Document, path: Path) -> None:
    """Write the page."""
    path.write_text(as_html(document), encoding='utf-8')


def write_markdown(document: Document, path: Path) -> None:
    """Write the text; its figures are in it, as links to data, so that it is one file."""
    text = document.text
    for drawing in document.drawings:
        data = base64.b64encode(_svg(drawing).encode()).decode()
        text = text.replace(f']({drawing.name})', f'](data:image/svg+xml;base64,{data})')
    path.write_text(text, encoding='utf-8')


def write_pdf(document: Document, path: Path) -> None:
    """Write pages of A4, their figures as pictures."""
    from fpdf import FPDF  # noqa: PLC0415  # takes a third of a second
    from fpdf.fonts import FontFace, TextStyle  # noqa: PLC0415

    drawings = {drawing.name: drawing for drawing in document.drawings}
    pdf = FPDF(format='A4')
    pdf.set_title(document.title)
    fonts = Path(mpl.get_data_path()) / 'fonts' / 'ttf'
    for style, file in (('', ''), ('B', '-Bold'), ('I', '-Oblique'), ('BI', '-BoldOblique')):
        pdf.add_font('DejaVu', style, fonts / f'DejaVuSans{file}.ttf')
    pdf.set_font('DejaVu', size=9)
    pdf.add_page()
    heading = FontFace(emphasis='BOLD')
    styles = {
        'h1': TextStyle(font_size_pt=16, font_style='B', b_margin=2),
        'h2': TextStyle(font_size_pt=12, font_style='B', t_margin=4, b_margin=1),
        'blockquote': TextStyle(color='#004b75', l_margin=5),
        'li': TextStyle(l_margin=5),
    }
    waiting: list[_Picture] = []
    for block in _blocks(_to_html(document.text)):
        if shown := _FIGURE.fullmatch(block):
            waiting.append(_picture(drawings[shown[1]], html.unescape(shown[2])))
            continue
        for row in _rows(waiting):
            _add_figures(pdf, row)
        waiting = []
        if block.startswith('<table>'):
            _add_table(pdf, block, heading)
        else:
            needed = _BEFORE_FIGURES if block.endswith('</h2>') else _BEFORE_TEXT
            if block.startswith(('<h2>', '<p><strong>')) and pdf.will_page_break(needed):
                pdf.add_page()  # a heading stays with what it is of
            pdf.write_html(block, font_family='DejaVu', tag_styles=styles, li_prefix_color='#000000')
    pdf.output(str(path))


WRITERS: dict[str, Callable[[Document, Path], None]] = {
    'html': write_html,
    'md': write_markdown,
    'pdf': write_pdf,
}
"""By the format's name, which is its suffix too."""


def _to_html(text: str) -> str:
    return str(MarkdownIt('commonmark', {'html': False}).enable('table').render(text))


def _with_captions(body: str) -> str:
    body = _CAPTIONED.sub(r'<div class="wide"><table><caption>\1</caption>', body)
    return body.replace('</table>', '</table></div>')


def _blocks(body: str) -> list[str]:
    """Return headings with what follows, captions, figures and tables of a page, in order."""
    figures_and_tables = r'(<p><img [^>]*></p>|<table>.*?</table>)'
    parts = re.split(figures_and_tables + '|(?=<h2>)|(?=<p><strong>)', body, flags=re.DOTALL)
    return [part.strip() for part in parts if part and part.strip()]


def _rows(pictures: list[_Picture]) -> Iterator[list[list[_Picture]]]:
    """Give rows of columns: a figure and the next one, or a tall one beside that before it and that after it."""
    rest = iter(pictures)
    for left in rest:
        right = next(rest, None)
        below = next(rest, None) if right is not None and right.is_tall and not left.is_tall else None
        yield [[each for each in column if each is not None] for column in ((left, below), (right,))]


def _add_figures(pdf: FPDF, columns: list[list[_Picture]]) -> None:
    """Add columns of figures side by side, each figure with its caption below."""
    width = (pdf.epw - _GAP * (_COLUMNS - 1)) / _COLUMNS
    if pdf.will_page_break(max(sum(width * each.ratio + _CAPTION for each in column) for column in columns)):
        pdf.add_page()
    top = lowest = pdf.get_y()
    pdf.set_font('DejaVu', 'I', 7)
    for number, column in enumerate(columns):
        left = pdf.l_margin + number * (width + _GAP)
        pdf.set_y(top)
        for each in column:
            above = pdf.get_y()
            pdf.image(each.file, x=left, y=above, w=width)
            pdf.set_xy(left, above + width * each.ratio)
            pdf.multi_cell(width, h=3.5, text=each.caption, align='L', new_x='LMARGIN', new_y='NEXT')
            pdf.set_y(pdf.get_y() + 3.0)
        lowest = max(lowest, pdf.get_y())
    pdf.set_font('DejaVu', '', 9)
    pdf.set_xy(pdf.l_margin, lowest)


def _add_table(pdf: FPDF, block: str, heading: FontFace) -> None:
    rows = [
        [
            html.unescape(re.sub(r'<[^>]*>', '', cell))
            for cell in re.findall(r'<t[hd][^>]*>(.*?)</t[hd]>', row, re.DOTALL)
        ]
        for row in re.findall(r'<tr>(.*?)</tr>', block, re.DOTALL)
    ]
    pdf.set_font('DejaVu', '', 7)
    longest = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    words = [max(len(word) for row in rows for word in row[column].split() or ['']) for column in range(len(rows[0]))]
    widths = tuple(max(min(length, 40), word + 2, 6) for length, word in zip(longest, words, strict=True))
    aligned = re.findall(r'<th( style="text-align:right")?>', block)
    with pdf.table(
        col_widths=widths,
        text_align=tuple('RIGHT' if right else 'LEFT' for right in aligned),
        headings_style=heading,
        borders_layout='HORIZONTAL_LINES',
        line_height=4,
    ) as table:
        for cells in rows:
            row = table.row()
            for cell in cells:
                row.cell(cell)
    pdf.set_font('DejaVu', '', 9)
    pdf.ln(2)


def _svg(drawing: Drawing) -> str:
    """Return the figure's drawing alone, with ids of its own, and no date."""
    figure = drawing.figure
    figure.set_size_inches(_WIDTH, _HEIGHT * len(figure.axes))
    with house_style(), mpl.rc_context({'svg.hashsalt': drawing.title}):
        file = io.StringIO()
        figure.savefig(file, format='svg', metadata={'Date': None, 'Creator': None, 'Format': None, 'Type': None})
    drawn = file.getvalue()
    label = html.escape(drawing.title, quote=True)
    return drawn[drawn.index('<svg') :].replace('<svg ', f'<svg role="img" aria-label="{label}" ', 1)


@dataclass(frozen=True)
class _Picture:
    file: io.BytesIO
    ratio: float
    """Height over width."""
    caption: str
    is_tall: bool


def _picture(drawing: Drawing, caption: str) -> _Picture:
    figure = drawing.figure
    is_tall = len(figure.axes) > 1
    figure.set_size_inches(1.3 * _WIDTH, 1.3 * _HEIGHT * len(figure.axes) * (0.8 if is_tall else 1.0))
    file = io.BytesIO()
    with house_style():
        figure.savefig(file, format='png', dpi=_DOTS)
    file.seek(0)
    width, height = figure.get_size_inches()
    return _Picture(file, float(height / width), caption, is_tall)
