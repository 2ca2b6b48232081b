"""Results of Adams in XML, as Adams C++ Solver writes them."""

_COMPONENTS = (
    ("X", "mm"),
    ("VX", "mm/sec"),
    ("WX", "deg/sec"),
    ("WY", "deg/sec"),
    ("WZ", "deg/sec"),
)


def part(name: str, first: int) -> str:
    """The entity of a part; ``first``: place of its first value in a step."""
    lines = [
        f'<Component name="{component}" unitsValue="{unit}" id="{first + place}" />'
        for place, (component, unit) in enumerate(_COMPONENTS)
    ]
    head = f'<Entity name="{name}_XFORM" entity="{name}" entType="Part" objectId="2">'
    return "\n".join([head, *lines, "</Entity>"])


def step(kind: str, time: str, *rows: str) -> str:
    """The values of all components at one time: a line for the time and for each part."""
    return "\n".join([f'<Step type="{kind}">', time, *rows, "</Step>"])


def document(*steps: str) -> str:
    """Results with a payload and a platform; the first two steps are no motion."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<Results xmlns="http://www.mscsoftware.com/:xrf10">
<Analysis name="Dynamic Analysis" Solver="Adams C++  Adams C++ Solver"  script="-unknown-">
<Units angle="deg" length="mm" mass="kg" time="sec" />
<StepMap name="map_001">
<Entity name="time">
<Component name="TIME" unitsValue="sec" id="1" />
</Entity>
{part("payload", 2)}
{part("platform", 7)}
</StepMap>
<Data name="modelInput_001" id="1">
{step("input", "0", "77 77 77 77 77", "77 77 77 77 77")}
</Data>
<Data name="initialConditions_001" id="2">
{step("initialConditions", "0", "0 0 1 2 3", "0 0 0 0 0")}
</Data>
<Data name="dynamic_001" id="3">
{"".join(one + chr(10) for one in steps)}</Data>
</Analysis>
</Results>
"""


def of_payload(motion: list[tuple[float, str]]) -> str:
    """Results with these steps: the time (s), and the values of the payload."""
    return document(*(step("dynamic", repr(time), row, "0 0 0 0 0") for time, row in motion))


def results(steps: int) -> str:
    """A motion with a step every 0.5 ms."""
    return of_payload([(5e-4 * place, f"0 {place} 1 2 3") for place in range(1, steps + 1)])
