"""HTML of notebooks: texts are shown literally, and the theme sets the colours."""

from rattlebox._util.html import bullets, code_block, escape, paragraph, table

EVIL = "<script>alert('x' & \"y\")</script>\x1b[31m"


def test_texts_are_escaped() -> None:
    """No tag and no control character of a text gets into the HTML, wherever the text stands."""
    for html in (escape(EVIL), paragraph(EVIL, EVIL), code_block(EVIL), bullets([EVIL]), table([EVIL], [[EVIL]])):
        assert "<script" not in html
        assert "\x1b" not in html
        assert "&lt;script&gt;alert('x' &amp; \"y\")&lt;/script&gt;?[31m" in html


def test_numbers_are_aligned_to_the_right() -> None:
    """A table of numbers has its labels on the left and its numbers on the right; an empty header is left out."""
    html = table(("", ""), [("mass", "20 kg")], numbers=True)
    assert html.index("text-align:left") < html.index("mass") < html.index("text-align:right") < html.index("20 kg")
    assert "<th" not in html and "<th" in table(("what", ""), [("mass", "20 kg")])
