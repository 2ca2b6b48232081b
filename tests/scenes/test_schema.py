"""The schema takes every scene file of the catalogue and refuses what the reader refuses. ``fits``
is a plain rewrite of the rules of JSON schema, draft 7, that the schema uses."""

import copy
import json
import re
import tomllib

import pytest

from tipoff.scenes import catalog
from tipoff.scenes.reading import CATALOG
from tipoff.scenes.schema import schema
from tipoff.units import to_si

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool}
TYPES |= {"number": (int, float), "integer": int}
ROOT = schema()


def fits(rule: dict, value) -> bool:
    known = {"$ref", "anyOf", "const", "enum", "type", "pattern", "properties", "items"}
    known |= {"additionalProperties", "required", "exclusiveMinimum", "minimum", "maximum"}
    known |= {"exclusiveMaximum", "minItems", "maxItems", "maxProperties"}
    known |= {"$schema", "$defs", "title", "description", "default", "examples"}
    assert set(rule) <= known
    checks = [
        "$ref" not in rule or fits(ROOT["$defs"][rule["$ref"].rpartition("/")[2]], value),
        "anyOf" not in rule or any(fits(inner, value) for inner in rule["anyOf"]),
        "const" not in rule or value == rule["const"],
        "enum" not in rule or value in rule["enum"],
        "type" not in rule or isinstance(value, TYPES[rule["type"]]),
    ]
    if isinstance(value, str):
        checks.append(re.search(rule.get("pattern", ""), value) is not None)
    elif isinstance(value, (int, float)):
        checks += [
            value > rule.get("exclusiveMinimum", -1e300),
            value >= rule.get("minimum", -1e300),
        ]
        checks += [value < rule.get("exclusiveMaximum", 1e300), value <= rule.get("maximum", 1e300)]
    elif isinstance(value, list):
        checks += [rule.get("minItems", 0) <= len(value) <= rule.get("maxItems", 10**9)]
        checks += [fits(rule.get("items", {}), item) for item in value]
    elif isinstance(value, dict):
        inner, others = rule.get("properties", {}), rule.get("additionalProperties", True)
        checks.append(set(rule.get("required", ())) <= set(value))
        for key, item in value.items():
            if key in inner or isinstance(others, dict):
                checks.append(fits(inner.get(key, others), item))
            else:
                checks.append(others)
    return all(checks)


def raw(name):
    return tomllib.loads((CATALOG / f"{name}.toml").read_text())


@pytest.mark.parametrize("name", catalog())
def test_every_scene_of_the_catalogue_fits(name):
    assert fits(ROOT, raw(name))


@pytest.mark.parametrize(
    "change",
    [
        {"payload": {"mass": 9.9}},
        {"payload": {"mass": "9.9"}},
        {"payload": {"mass": "heavy"}},
        {"payload": {"weight": "9.9 kg"}},
        {"contact": {"law": "glue"}},
        {"rail": {"material": {"poisson_ratio": 0.7}}},
        {"gravitation": {}},
        {"pads": {"stations": ["1 m"], "normals": ["+y"]}},
        {"pads": [{"position": ["1 m", "1 m"], "normals": ["+y"]}]},
    ],
)
def test_what_the_reader_refuses_does_not_fit(change):
    found = copy.deepcopy(raw("reference"))
    for table, value in change.items():
        found[table] = {**found.get(table, {}), **value} if isinstance(value, dict) else value
    if change.get("rail"):
        found["rail"]["material"] = {**raw("reference")["rail"]["material"], "poisson_ratio": 0.7}
    assert not fits(ROOT, found)


def test_a_file_states_all_required_tables_or_extends_another():
    assert not fits(ROOT, {"payload": {"mass": "9 kg"}})
    assert fits(ROOT, {"extends": "reference", "payload": {"mass": "9 kg"}, "friction": "absent"})


def test_quantities_are_text_with_examples_in_their_unit():
    clearance = ROOT["$defs"]["ImpactTable"]["properties"]["clearance"]
    assert clearance["type"] == "string" and "quantity in m" in clearance["description"]
    assert "0.25 mm" in clearance["examples"]
    assert all(to_si(text, "m") > 0.0 for text in clearance["examples"])
    for table in ROOT["$defs"].values():
        for item in table.get("properties", {}).values():
            assert all(re.match(item["pattern"], text) for text in item.get("examples", ()))
            # examples were chosen by the name of the key alone: "-0.10 m" for a rate about x
            unit = item.get("description", "").removeprefix("quantity in ")
            for text in item.get("examples", ()) if unit != "its unit" else ():
                to_si(text, unit)
    rate = ROOT["$defs"]["AngularRate"]["properties"]["x"]
    assert rate["examples"] == ["5 deg/s"]
    condition = ROOT["properties"]["conditions"]["additionalProperties"]["anyOf"][1]
    assert "thrust_offset.misalignment.radial" in condition["properties"]
    json.dumps(ROOT, allow_nan=False)
