"""A terminal's text with its colours, as tmux captures it, drawn as a PNG.

Letters come from DejaVu Sans Mono; dots, blocks and lines are drawn as what they are, so that they meet at the cells' edges as on a
terminal. Needs Pillow (Debian: python3-pil, fonts-dejavu-core).
"""
import re

from PIL import Image, ImageDraw, ImageFont

FONTS = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono{}.ttf"
CELL = (9, 18)  # pixels
SIZE = 15
FORE, BACK = (204, 204, 204), (16, 18, 22)
LEVELS = (0, 95, 135, 175, 215, 255)
SIXTEEN = [(0, 0, 0), (205, 49, 49), (13, 188, 121), (229, 229, 16), (36, 114, 200), (188, 63, 188), (17, 168, 205), (229, 229, 229),
           (102, 102, 102), (241, 76, 76), (35, 209, 139), (245, 245, 67), (59, 142, 234), (214, 112, 214), (41, 184, 219), (255, 255, 255)]


def colour(index):
    if index < 16:
        return SIXTEEN[index]
    if index < 232:
        index -= 16
        return LEVELS[index // 36], LEVELS[index // 6 % 6], LEVELS[index % 6]
    return (8 + 10 * (index - 232),) * 3


class Style:
    def __init__(self):
        self.fore, self.back, self.bold, self.reverse, self.underline = None, None, False, False, False

    def apply(self, codes):
        codes = [int(code or 0) for code in codes]
        while codes:
            code = codes.pop(0)
            if code == 0:
                self.__init__()
            elif code == 1:
                self.bold = True
            elif code == 22:
                self.bold = False
            elif code in (4, 24):
                self.underline = code == 4
            elif code in (7, 27):
                self.reverse = code == 7
            elif 30 <= code <= 37 or 90 <= code <= 97:
                self.fore = colour(code - 30 if code < 90 else code - 82)
            elif 40 <= code <= 47 or 100 <= code <= 107:
                self.back = colour(code - 40 if code < 100 else code - 92)
            elif code == 39:
                self.fore = None
            elif code == 49:
                self.back = None
            elif code in (38, 48):
                kind = codes.pop(0)
                value = colour(codes.pop(0)) if kind == 5 else tuple(codes.pop(0) for _ in range(3))
                if code == 38:
                    self.fore = value
                else:
                    self.back = value

    def inks(self):
        fore, back = self.fore or FORE, self.back or BACK
        return (back, fore) if self.reverse else (fore, back)


def cells(text):
    """Rows of (character, foreground, background, bold, underline)."""
    style, rows = Style(), []
    for line in text.split("\n"):
        row, at = [], 0
        for match in re.finditer(r"\x1b\[([0-9;:]*)m|\x1b.|[\x0e\x0f]", line):
            row += [(c, *style.inks(), style.bold, style.underline) for c in line[at:match.start()]]
            at = match.end()
            if match.group(1) is not None:
                style.apply(re.split("[;:]", match.group(1)))
        row += [(c, *style.inks(), style.bold, style.underline) for c in line[at:]]
        rows.append(row)
    return rows


def braille(draw, x, y, code, ink):
    places = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3))
    for bit, (column, row) in enumerate(places):
        if code >> bit & 1:
            cx, cy = x + CELL[0] * (0.25 + 0.5 * column), y + CELL[1] * (0.125 + 0.25 * row)
            draw.ellipse((cx - 1.6, cy - 1.6, cx + 1.3, cy + 1.3), fill=ink)


def block(draw, x, y, code, ink):
    """U+2580 to U+2590: halves and eighths."""
    w, h = CELL
    box = (0, 0, 8, 8)
    if code == 0x2580:
        box = (0, 0, 8, 4)
    elif code <= 0x2588:
        box = (0, 8 - (code - 0x2580), 8, 8)
    elif code <= 0x258F:
        box = (0, 0, 0x2590 - code, 8)
    elif code == 0x2590:
        box = (4, 0, 8, 8)
    left, top, right, bottom = x + w * box[0] / 8, y + h * box[1] / 8, x + w * box[2] / 8, y + h * box[3] / 8
    draw.rectangle((left, top, max(right - 1, left), bottom - 1), fill=ink)


def line(draw, x, y, code, ink):
    """─ │ ╌ ┼ and corners, to the cell's edges."""
    w, h = CELL
    mx, my = x + w // 2, y + h // 2
    arms = {0x2500: "lr", 0x2502: "ud", 0x253C: "lrud", 0x250C: "rd", 0x2510: "ld", 0x2514: "ru", 0x2518: "lu", 0x251C: "rud",
            0x2524: "lud", 0x252C: "lrd", 0x2534: "lru"}
    if code == 0x254C:
        draw.line((x + 1, my, x + w // 2 - 1, my), fill=ink)
        draw.line((x + w // 2 + 2, my, x + w - 1, my), fill=ink)
        return True
    if code not in arms:
        return False
    ends = {"l": (x, my), "r": (x + w, my), "u": (mx, y), "d": (mx, y + h)}
    for arm in arms[code]:
        draw.line((mx, my, *ends[arm]), fill=ink)
    return True


def draw_cell(draw, fonts, x, y, cell):
    character, fore, back, bold, underline = cell
    code = ord(character)
    if back != BACK:
        draw.rectangle((x, y, x + CELL[0] - 1, y + CELL[1] - 1), fill=back)
    if 0x2800 <= code <= 0x28FF:
        braille(draw, x, y, code - 0x2800, fore)
    elif 0x2580 <= code <= 0x2590:
        block(draw, x, y, code, fore)
    elif character != " " and not line(draw, x, y, code, fore):
        draw.text((x, y), character, font=fonts[bold], fill=fore)
    if underline:
        draw.line((x, y + CELL[1] - 2, x + CELL[0], y + CELL[1] - 2), fill=fore)


def save(text, width, height, path):
    """Draws a capture of width × height cells into a PNG."""
    fonts = [ImageFont.truetype(FONTS.format(kind), SIZE) for kind in ("", "-Bold")]
    margin = 8
    picture = Image.new("RGB", (width * CELL[0] + 2 * margin, height * CELL[1] + 2 * margin), BACK)
    draw = ImageDraw.Draw(picture)
    for row, content in enumerate(cells(text)[:height]):
        for column, cell in enumerate(content[:width]):
            draw_cell(draw, fonts, margin + column * CELL[0], margin + row * CELL[1], cell)
    picture.quantize(128).save(path, optimize=True)
