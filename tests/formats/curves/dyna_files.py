"""Files of LS-DYNA as LSTC describes them: the formats of the texts are those of the translator l2a, the
records of the binary file those of the document of lsda-1.1."""

import struct
from pathlib import Path

HEAD = (
    " a payload on a rail\n"
    "                         ls-dyna (version mpp s R11.1.)     date 08/12/2019\n"
    "\n {BEGIN LEGEND}\n Entity #        Title\n    1001     centre\n {END LEGEND}\n"
)
_TIME = (
    "\n\n\n n o d a l   p r i n t   o u t   f o r   t i m e  s t e p%8d"
    "                              ( at time%12.5E )\n"
)
_MOVED = (
    "\n nodal point  x-disp     y-disp      z-disp      x-vel       y-vel       z-vel      "
    "x-accl      y-accl      z-accl      x-coor      y-coor      z-coor\n"
)
_TURNED = (
    "\n nodal point  x-rot      y-rot       z-rot       x-rot vel   y-rot vel   z-rot vel   "
    "x-rot acc   y-rot acc   z-rot acc\n"
)
# One node and one body, at 0 and 0.5 ms, in mm and ms: v_x 0 and 2 mm/ms, rates 0 and 1e-5 rad/ms times
# 1, 2, 3. Fortran leaves the E out of a long exponent.
NODOUT = (
    f"{HEAD}{_TIME % (1, 0.0)}{_MOVED}"
    "     1001   0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00"
    "  4.0000E+00  0.0000E+00  0.0000E+00  1.0000E+02  0.0000E+00  0.0000E+00\n"
    f"{_TIME % (1, 0.0)}{_TURNED}"
    "     1001   0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00  0.0000E+00"
    "  2.0000E-05  4.0000E-05  6.0000E-05\n"
    f"{_TIME % (501, 0.5)}{_MOVED}"
    "     1001   5.0000E-01  0.0000E+00  0.0000E+00  2.0000E+00 -1.0000E-03  0.0000E+00"
    "  4.0000E+00  0.0000E+00  0.0000E+00  1.0050E+02  0.0000E+00  0.0000E+00\n"
    f"{_TIME % (501, 0.5)}{_TURNED}"
    "     1001   2.5000E-06  5.0000E-06  7.5000E-06  1.0000E-05  2.0000E-05  3.0000E-05"
    "  2.0000E-05  4.0000E-05  6.0000-105\n"
)
_BODY = """1

  r i g i d   b o d y   m o t i o n   a t  cycle=       1    time=   {time}

 rigid body       7
   global             x           y           z          x-rot       y-rot       z-rot
   coordinates:    1.0000E+02  0.0000E+00  0.0000E+00
 displacements:    5.0000E-01  0.0000E+00  0.0000E+00  2.5000E-06  5.0000E-06  7.5000E-06
    velocities:  {velocities}
 accelerations:    4.0000E+00  0.0000E+00  0.0000E+00  2.0000E-05  4.0000E-05  6.0000E-05

principal or user defined local coordinate direction vectors
                     a           b           c
     row 1     0.0000E+00     1.0000E+00     0.0000E+00
     row 2     0.0000E+00     0.0000E+00     1.0000E+00
     row 3     1.0000E+00     0.0000E+00     0.0000E+00

 output in principal or user defined local coordinate directions
                      a           b           c          a-rot       b-rot       c-rot
 displacements:    9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09
    velocities:    9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09
 accelerations:    9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09  9.0000E+09
"""


def rbdout(states) -> str:
    """Text with the motion of body 7: times, velocities (3,) and rates (3,) of each state."""
    return HEAD + "".join(
        _BODY.format(
            time=f"{time:12.6E}", velocities="".join(f"{one:12.4E}" for one in (*speed, *rate))
        )
        for time, speed, rate in states
    )


RBDOUT = HEAD + "".join(
    _BODY.format(time=time, velocities=velocities)
    for time, velocities in (
        ("0.000000E+00", "  0.0000E+00" * 6),
        (
            "5.000000E-01",
            "  2.0000E+00 -1.0000E-03  0.0000E+00  1.0000E-05  2.0000E-05  3.0000E-05",
        ),
    )
)


def two_bodies() -> str:
    """``RBDOUT`` with a second body, a nodal one, whose velocities are larger by 1."""
    first, *blocks = RBDOUT.split("1\n\n  r i g i d")
    text = first
    for block, speed in zip(blocks, ("1.0000E+00", "3.0000E+00")):
        second = block[block.index("   global") :]
        line = next(line for line in second.splitlines() if "velocities" in line)
        own = second.replace(line, line[:17] + "  " + speed + line[29:], 1)
        text += f"1\n\n  r i g i d{block} nodal rigid body       9\n{own}"
    return text


def longer(text: str, steps: int) -> str:
    """``NODOUT`` or ``RBDOUT`` with more states like the last one, 0.5 ms apart."""
    mark = "\n\n\n n o d a l" if text is NODOUT else "1\n\n  r i g i d"
    parts = text.split(mark)
    last = [f"{mark}{part}" for part in (parts[-2:] if text is NODOUT else parts[-1:])]
    for step in range(2, steps):
        late = f"{0.5 * step:.5E}"
        text += "".join(last).replace("5.000000E-01", late).replace("5.00000E-01", late)
    return text


HEADER = bytes([8, 8, 8, 1, 1])  # its length; bytes of a length, an offset, a command, a type
_CD, _DATA, _VARIABLE, _BEGIN, _END, _TABLE = 2, 3, 4, 5, 6, 7
TYPES = {"i1": 1, "i4": 3, "i8": 4, "f4": 9, "f8": 10}
_LETTERS = {"i1": "b", "i4": "i", "i8": "q", "f4": "f", "f8": "d"}


class Lsda:
    """The bytes of a binary file, record by record."""

    def __init__(self, order: str = "<"):
        self.order = order
        self.content = HEADER + bytes([order == "<", 0, 0])
        self.record(_TABLE, struct.pack(f"{order}Q", 0))

    def record(self, command: int, content: bytes) -> None:
        """Length of the whole record, command, content."""
        self.content += struct.pack(f"{self.order}QB", 9 + len(content), command) + content

    def folder(self, path: str) -> None:
        """Change the folder, as in a shell."""
        self.record(_CD, path.encode())

    def data(self, name: str, kind: str, *values: float) -> None:
        """Numbers with a name."""
        numbers = struct.pack(f"{self.order}{len(values)}{_LETTERS[kind]}", *values)
        head = bytes([TYPES[kind], len(name)]) + name.encode()
        self.record(_DATA, head + numbers)

    def symbols(self) -> None:
        """A table of symbols, whose paths must not move the data."""
        self.record(_BEGIN, b"")
        self.record(_CD, b"/nodout/d000001")
        self.record(_VARIABLE, b"time" + struct.pack(f"{self.order}BQQ", 9, 100, 1))
        self.record(_END, b"")


def binout(order: str = "<", real: str = "f4", whole: str = "i8", steps: int = 2) -> Lsda:
    """Bodies 7 and (nodal) 9: the motion of 7 at 0, 0.5, 1 ... ms is that of ``RBDOUT``."""
    file = Lsda(order)
    file.folder("/rbdout/metadata")
    file.data("title", "i1", *b"a payload")
    file.data("ids", whole, 7, 9)
    file.data("num_nodal", "i4", 1)
    for step in range(steps):
        file.folder(f"../d{step + 1:06d}" if step else "/rbdout/d000001")
        file.data("time", real, 0.5 * step)
        file.data("cycle", "i4", step)
        for axis, factor in zip("xyz", (1, 2, 3)):
            file.data(f"global_v{axis}", real, 2.0 * step if axis == "x" else 0.0, -1.0)
            file.data(f"global_rv{axis}", real, 1e-5 * step * factor, -1.0)
    file.folder("/glstat/d000001")
    file.data("time", real, 99.0)
    file.symbols()
    return file


def rigid_body(states) -> Lsda:
    """The motion of ``rbdout`` in the binary file."""
    file = Lsda()
    file.folder("/rbdout/metadata")
    file.data("ids", "i4", 7)
    file.data("num_nodal", "i4", 0)
    for place, (time, speed, rate) in enumerate(states, 1):
        file.folder(f"/rbdout/d{place:06d}")
        file.data("time", "f8", time)
        for axis, along, about in zip("xyz", speed, rate):
            file.data(f"global_v{axis}", "f8", along)
            file.data(f"global_rv{axis}", "f8", about)
    return file


def written(folder: Path, name: str, content: str | bytes) -> Path:
    """A file with this content."""
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path
