"""FIT files made by hand, message by message, after Garmin's "FIT Protocol"."""

from __future__ import annotations

import struct

EPOCH_S = 631_065_600
"""Unix time of FIT's zero, 1989-12-31T00:00:00Z."""

BASE = {"B": 0x02, "b": 0x01, "H": 0x84, "h": 0x83, "I": 0x86, "i": 0x85}


def checksum(content: bytes) -> int:
    """CRC-16 bit by bit (polynomial 0xA001), so that the reader's table is checked against another way."""
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0xA001 if crc & 1 else 0)
    return crc


def definition(
    local: int, message: int, fields: dict[int, str], order: str = "<", developer: int = 0
) -> bytes:
    """Layout of the data messages that follow: field number to ``struct`` letter."""
    head = struct.pack(order + "BBHB", 0, int(order == ">"), message, len(fields))
    body = b"".join(bytes([number, struct.calcsize(form), BASE[form]]) for number, form in fields.items())
    own = bytes([1, 0, developer, 0]) if developer else b""
    return bytes([0x40 | (0x20 if developer else 0) | local]) + head + body + own


def data(local: int, form: str, *values: int) -> bytes:
    return bytes([local]) + struct.pack(form, *values)


def fit_file(*messages: bytes) -> bytes:
    content = b"".join(messages)
    head = struct.pack("<BBHI4s", 14, 0x20, 2132, len(content), b".FIT")
    body = head + struct.pack("<H", checksum(head)) + content
    return body + struct.pack("<H", checksum(body))


def semicircles(degrees: float) -> int:
    return round(degrees * 2**31 / 180.0)


def activity(n: int = 5) -> bytes:
    """A short ride in Berlin: time, position, altitude, speed, accuracy."""
    fields = {253: "I", 0: "i", 1: "i", 78: "I", 73: "I", 31: "B"}
    return fit_file(
        definition(0, 20, fields),
        *(
            data(
                0,
                "<IiiIIB",
                1_000_000_000 + second,
                semicircles(52.5 + 1e-5 * second),
                semicircles(13.4),
                round((34.0 + 500.0) * 5),
                4_200,
                6,
            )
            for second in range(n)
        ),
    )
