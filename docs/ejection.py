"""Draws ``ejection.png``, the first picture of README: three moments of one run of the reference.

make pictures && tipoff view --condition phi35
python docs/ejection.py out/reference/view/phi35
"""

import json
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from tipoff.studies.view.pictures import Drawing

matplotlib.use("Agg")
_SIZE = (760, 600)  # pixels of one moment
_SCALE = 5e6  # Pa, end of the colours: a third of the peak, which a small picture hides


def main(folder: Path) -> None:
    """Write docs/ejection.png from the frames that ``tipoff view`` left in ``folder``."""
    found = json.loads(folder.with_suffix(".json").read_text(encoding="utf-8"))
    order = {
        "folder": str(folder),
        "frames": found["frames"],
        "factor": found["factor"],
        "scale_pa": _SCALE,
    }
    last = len(found["frames"]) - 1
    moments = {0: "at ignition", found["peak"]["frame"]: "a rear pad strikes", last: "free"}
    figure, panels = plt.subplots(1, 3, figsize=(12.6, 3.1), layout="constrained")
    for panel, (index, words) in zip(panels, moments.items(), strict=True):
        time = 1e3 * found["frames"][index]["time_s"]
        panel.imshow(_drawn(order, index, np.array(found["bounds_m"])))
        panel.set_title(f"{words}, {time:.0f} ms", fontsize=13)
        panel.axis("off")
    figure.savefig(Path(__file__).with_name("ejection.png"), dpi=100)


def _drawn(order: dict, index: int, bounds: np.ndarray) -> np.ndarray:
    """Pixels of one moment, without the white border above and below it."""
    drawing = Drawing(order, _SIZE)
    drawing.show(index)
    drawing.fill(close=False, bar=False)
    drawing.frame_all(bounds, 1.3)
    drawing.plotter.hide_axes()
    pixels = drawing.plotter.screenshot(return_img=True)
    drawing.plotter.close()
    return pixels[45:-80]


if __name__ == "__main__":
    main(Path(sys.argv[1]))
