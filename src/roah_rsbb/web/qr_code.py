"""QR codes, with the library python3-qrcode. Without it, users type the address instead."""

from typing import List, Optional

INSTALL = "sudo apt install python3-qrcode"  # pip installs it with the box
# Light modules around the code, which readers need.
_BORDER = 2


def modules_of(text: str) -> Optional[List[List[bool]]]:
    """Return the rows of a text's QR code with its border. True: a dark module. None: the library is not installed."""
    try:
        import qrcode
    except ImportError:
        return None
    code = qrcode.QRCode(border=_BORDER, error_correction=qrcode.constants.ERROR_CORRECT_M)
    code.add_data(text)
    code.make(fit=True)
    return code.get_matrix()


def lines_of(text: str) -> List[str]:
    """Return a text's QR code for a terminal: light on dark, two rows of modules in a line. Empty: no library."""
    rows = modules_of(text)
    if rows is None:
        return []
    if len(rows) % 2:
        rows = [*rows, [False] * len(rows[0])]
    blocks = {(False, False): "█", (False, True): "▀", (True, False): "▄", (True, True): " "}
    return ["".join(blocks[pair] for pair in zip(upper, lower)) for upper, lower in zip(rows[::2], rows[1::2])]
