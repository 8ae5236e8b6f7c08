"""Tables and numbers in Markdown."""

from page import summary


def table(head, rows, left=1):
    """Markdown; the first `left` columns to the left, the others to the right."""
    line = lambda cells: f"| {' | '.join(map(str, cells))} |"
    return "\n".join([line(head), "|" + "---|" * left + "---:|" * (len(head) - left), *map(line, rows)])


def number(value):
    """28311 as 28 311."""
    return f"{value:,}".replace(",", " ")


def seconds(value):
    return f"{value:.2f}" if value < 100 else f"{value:.0f}"


def spread(values):
    middle, width = summary.of(values)
    return f"{seconds(middle)} ± {seconds(width)}" if len(values) > 1 else seconds(middle)


def ratio(values):
    """Median and range."""
    middle, least, largest = values
    return f"**{middle:.2f}** ({least:.2f} to {largest:.2f})" if least < largest else f"**{middle:.2f}**"
