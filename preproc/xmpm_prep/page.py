"""A scene as one HTML file that needs no network: turned, moved and zoomed by the mouse."""

import base64
import html
import json
from importlib.resources import files

import numpy as np


def write_page(scene, path, title):
    """Write the page: the viewer of viewer.html with the scene put in."""
    low, high = scene.bounds()
    middle = (low + high) / 2
    size = float(np.linalg.norm(high - low)) / 2 or 1.0
    items = [
        {
            "name": item.name,
            "kind": item.kind,
            "colour": [int(item.colour[i : i + 2], 16) / 255 for i in (1, 3, 5)],
            "width": int(item.cells.shape[1]),
            "points": _encode(((item.points - middle) / size).astype("<f4")),
            "cells": _encode(item.cells.astype("<u4")),
        }
        for item in scene.items
    ]
    data = {
        "items": items,
        "title": title,
        "unit": scene.unit,
        "low": low.tolist(),
        "high": high.tolist(),
        "cracks": bool(scene.of_kind("crack")),
    }
    text = (files("xmpm_prep") / "viewer.html").read_text(encoding="utf-8")
    text = text.replace("$TITLE", html.escape(title))
    text = text.replace("$SCENE", json.dumps(data).replace("</", "<\\/"))
    path.write_text(text, encoding="utf-8")


def _encode(values):
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")
