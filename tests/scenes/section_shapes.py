"""Sections of the tests: a T-slot, and the other shapes, as tables with SI values."""

from typing import Any

T_SLOT: dict[str, Any] = {
    "shape": "t_slot",
    "width": 0.040,
    "slot": 0.008,
    "lip": 0.0045,
    "cavity": 0.020,
    "depth": 0.0125,
    "web": 0.003,
}
SHAPES: dict[str, dict[str, Any]] = {
    "t_slot": T_SLOT,
    "bored t_slot": T_SLOT | {"bore": 0.0068},
    "rod": {"shape": "rod", "diameter": 0.012},
    "tee": {"shape": "tee", "width": 0.03, "height": 0.024, "flange": 0.004, "web": 0.003},
    "channel": {"shape": "channel", "width": 0.03, "height": 0.02, "flange": 0.003, "web": 0.004},
    "box": {"shape": "box", "width": 0.03, "height": 0.024, "wall": 0.004},
}
