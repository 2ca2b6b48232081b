"""What is done with a mutant of each kind, up to where a run would begin: the input is read, checked
and turned into what the solvers take. The result is the exit code that a command would give."""

import random
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from unittest import mock

import meshio
import numpy as np
import typer

from tests.formats.curves import adams_files, dyna_files
from tests.formats.meshes import forms
from tests.fuzz import mutants, results, sections
from tipoff import scenes
from tipoff.comparison.curves import Curves
from tipoff.comparison.layout import of_options
from tipoff.faults import InputError
from tipoff.highfi.compliance import walls
from tipoff.highfi.mesh import touching
from tipoff.highfi.mesh.asked import AS_DRAWN, Asked
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.rail import fit, solid_process, step_cost
from tipoff.lowfi.ensemble.table import TableFile
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.meshes import generator
from tipoff.scenes import implausible, reading, scene_model, uncertainty
from tipoff.scenes.rail import SectionTable
from tipoff.studies.calibration.files import constants
from tipoff.studies.commands.running import Output, guarded, study_of
from tipoff.studies.measured import analysis, sheet

SCENES = ("reference", "tiny", "channel", "paper_like", "sensitive", "thin", "titanium", "clamped")
COARSE = 8.0  # mm
_CPU_SECONDS = 10  # for gmsh, which some damaged solids keep busy without end
TABLE = (
    "payload.mass,thrust.peak,thrust_offset.misalignment.axial\n"
    "kg,kN,deg\n9.9,6,0.1\n10,6.1,\n9.8,5.9,0.3\n"
)
# keys of [thrust] and content of its file, by the suffix of its name
THRUSTS = {
    "eng": (
        {"motor": "B"},
        "; two\nA 18 70 0 1 2 X\n 0.1 9\n 0.3 0\n;\nB 18 70 P 1 2 Y\n 0.2 8\n 0.9 0\n",
    ),
    "rse": (
        {},
        '<engine-database>\n<engine-list>\n<engine code="C6" mfg="X" Itot="2">\n<data>\n'
        '<eng-data t="0." f="0."/>\n<eng-data t="0.2" f="8."/>\n<eng-data t="0.9" f="0."/>\n'
        "</data>\n</engine>\n</engine-list>\n</engine-database>\n",
    ),
    "txt": (
        {"remove_offset": True, "ignition": "2 ms"},
        "# stand 2\nTest;4\nTime [ms];P/bar;Thrust (lbf)\n"
        + "".join(f"{t},5;9;{4 + 90 * (9 < t < 20)},1\n" for t in range(-2, 30)),
    ),
    "csv": ({"time_unit": "ms", "thrust_unit": "N"}, "0,0\n1,2000\n4,6000\n10,5000\n20,0\n"),
}
CURVE = "time_s,force_N\n0,0\n0.001,2000\n0.004,6000\n0.010,5000\n0.02,0\n"
CALIBRATION = """
parameters = ["force"]
values = [1.0]
units = ["N"]
lower = [0.5]
upper = [2.0]
justification = ["x"]
information = [[1.0]]
weak_directions = []
conditions = ["phi15"]
objective = 0.1

[constants]
"contact.stiffness" = 2.2e9
"contact.exponent" = 1.5

[residuals.phi15]
rate = 0.01
"""


def outcome(kind: str, seed: int, folder: Path) -> int:
    """Exit code of mutant ``seed`` of a ``kind``, whose files are written into ``folder``. Whatever
    else a command would end with is raised."""
    rng = random.Random(f"{kind} {seed}")
    try:
        guarded(lambda: Output(KINDS[kind](rng, folder) or {}), as_json=False)
    except typer.Exit as ended:
        return ended.exit_code
    return 0


def _scene(rng: random.Random, folder: Path) -> None:
    name = rng.choice(SCENES)
    file = folder / "scene.toml"
    if rng.random() < 0.5:
        text = mutants.of_text(rng, (reading.CATALOG / f"{name}.toml").read_text(encoding="utf-8"))
    else:
        raw, _ = reading.read(name)
        text = mutants.of_scene(rng, raw)
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    _prepared(file, folder)


def _prepared(file: Path, folder: Path) -> None:
    """A scene as far as its mesh and the records of the solvers."""
    from tipoff import highfi

    study = study_of(str(file), folder / "out", [f"studies.element_size={COARSE} mm"])
    whole = study.scene
    assert scenes.parse(whole.resolved(), bare_numbers_are_si=True).hash == whole.hash
    for scene in list(study.conditions.values())[:2]:
        assert scene.hash and scene.absent_effects() is not None
        scene_model.build(scene)
        request = study.highfi(next(iter(study.conditions)))
        if isinstance(scene.rail, SectionTable) or not _is_large(scene):
            highfi.prepare(scene, request.numerics)


def _is_large(scene: scenes.Scene) -> bool:
    return scene.rail.path().suffix in (".step", ".brep")


def _step(rng: random.Random, folder: Path) -> None:
    """A scene with other numbers and the same effects, hence the same kernels."""
    scene = scenes.load("tiny").condition("phi15")
    numbers = [(key, old) for key, old in _dotted(scene.resolved()) if isinstance(old, float)]
    change = {
        key: old * 10.0 ** rng.choice((-12, -6, -3, -1, 1, 3, 6, 12)) * rng.choice((1, 1, 1, -1))
        for key, old in rng.sample(numbers, rng.choice(mutants.EDITS))
    }
    take_steps(scene.replace(change))


def take_steps(scene: scenes.Scene) -> None:
    """Some steps of the surrogate, and the first one of the reference. Compiles their kernels."""
    from tipoff import highfi, lowfi
    from tipoff.highfi.dynamics.setup import set_up
    from tipoff.highfi.dynamics.step_size import choose
    from tipoff.highfi.dynamics.system import build
    from tipoff.highfi.simulation import Loop

    numerics = highfi.Numerics(element_size=1e-3 * COARSE)
    drawn, few = walls(scene, numerics.element_size), lowfi.Numerics(maximum_steps=200)
    lowfi.run(scene, "springs", compliance=drawn, numerics=few)
    system = build(scene, numerics, highfi.prepare(scene, numerics))
    loop = Loop(set_up(scene, system, choose(system, scene, numerics)))
    loop.begin()
    loop.advance_steps(1)


def _override(rng: random.Random, folder: Path) -> None:
    scene = scenes.load(rng.choice(SCENES))
    keys = [key for key, _ in _dotted(scene.resolved())] + list(mutants.NAMES)
    text = {
        rng.choice(keys): f"{rng.choice(mutants.NUMBERS)} {rng.choice(mutants.UNITS)}"
        for _ in range(rng.randint(1, 3))
    }
    found = scene.replace(text)
    implausible.of_all_conditions(found)
    scene_model.build(found)


def _dotted(table: dict) -> list:
    return list(scenes.overrides.dotted(table))


def _mesh(rng: random.Random, folder: Path) -> None:
    file = folder / "mesh.msh"
    if rng.random() < 0.4:
        meshio.gmsh.write(file, mutants.of_mesh(rng, _original()), "2.2", binary=True)
    else:
        meshio.gmsh.write(file, _original(), "2.2", binary=rng.random() < 0.5)
        file.write_bytes(mutants.of_bytes(rng, file.read_bytes()))
    scene = scenes.load("channel").replace({"rail.mesh": str(file)})
    mesh = read(file)
    fit.check_frame(scene, scene.rail, mesh)
    fit.check_held(scene.rail, mesh)
    step_cost.with_sliver_steps(mesh, scene.rail.material)
    fit.check_fit(scene, mesh)


def _original() -> meshio.Mesh:
    return meshio.read(reading.CATALOG / "channel.msh")


def _mesh_file(rng: random.Random, folder: Path) -> None:
    """A small rail in each format of mesh files, and what a scene says of it. Text is edited by lines
    too, so that keywords and sets meet each other in other orders."""
    form = rng.choice(list(forms.ALL))
    file = forms.write(form, folder / "rail")
    content = file.read_bytes()
    if form not in forms.BINARY and rng.random() < 0.7:
        text = mutants.of_text(rng, content.decode())
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
    else:
        file.write_bytes(mutants.of_bytes(rng, content))
    box = np.array([[[rng.choice((0.0, -1.0, 0.015, 1e300)), 0.0, 0.0], [0.04, 0.02, 0.0]]])
    asked = rng.choice(
        (
            AS_DRAWN,
            AS_DRAWN,
            Asked(unit="mm", axes=("z", "x", "y"), origin=(1e9, 0.0, -1.0)),
            Asked(body=rng.choice(("rail", "all", "property 1", "the rail", "part = 3"))),
            Asked(groups={"mount": ("contact", rng.choice(("mount", "bolts")))}),
            Asked(boxes={"mount": box}),
        )
    )
    touching.warning(read(file, asked))


def _solid(rng: random.Random, folder: Path) -> None:
    """A plate in a file of CAD, held at one face."""
    from tipoff import highfi

    suffix = rng.choice(("step", "step", "igs", "brep"))
    file = folder / f"plate.{suffix}"
    file.write_bytes(mutants.of_text(rng, _plate(suffix)).encode("utf-8", "surrogatepass"))
    raw, _ = reading.read("tiny")
    rail = raw["rail"]
    box = [{"low": ["-88 mm", "-1 m", "-1 m"], "high": ["-88 mm", "1 m", "1 m"]}]
    wall = [{"low": ["-1 m", "100.25 mm", "-1 m"], "high": ["1 m", "100.25 mm", "1 m"]}]
    raw["rail"] = {key: rail[key] for key in ("start", "end", "material")} | {
        "geometry": str(file),
        "surfaces": {"mount": box, "contact_wall": wall},
    }
    with mock.patch.object(solid_process, "CPU_SECONDS", _CPU_SECONDS):
        highfi.prepare(scenes.parse(raw | {"provenance": {}}), highfi.Numerics(element_size=8e-3))


@cache
def _plate(suffix: str) -> str:
    """Text of a file of CAD; STEP and IGES are in millimetres, BREP has no unit."""
    with tempfile.TemporaryDirectory() as folder, generator.session("plate") as gmsh:
        if suffix == "step":
            gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.model.occ.addBox(-88.0, 100.25, 80.0, 224.0, 4.0, 24.0)
        gmsh.model.occ.synchronize()
        if suffix == "brep":
            gmsh.model.occ.dilate(gmsh.model.occ.getEntities(3), 0, 0, 0, 1e-3, 1e-3, 1e-3)
            gmsh.model.occ.synchronize()
        gmsh.write(f"{folder}/plate.{suffix}")
        return Path(folder, f"plate.{suffix}").read_text(encoding="utf-8")


def _table(rng: random.Random, folder: Path) -> None:
    file = folder / "table.csv"
    text = mutants.of_text(rng, TABLE)
    file.write_bytes(mutants.of_bytes(rng, text.encode()) if rng.random() < 0.3 else text.encode())
    table, scene = TableFile(file), scenes.load("reference")
    for row in table.rows(0, min(table.asked, 20)):
        try:
            scene.replace(row)
        except InputError:
            continue


def _curve(rng: random.Random, folder: Path) -> None:
    file = folder / "curve.csv"
    file.write_bytes(mutants.of_text(rng, CURVE).encode())
    law = rng.choice(("curve", "fit"))
    thrust = {"kind": "measured", "file": str(file), "use": law}
    raw, _ = reading.read("reference")
    raw.pop("provenance")
    found = scenes.parse(raw | {"thrust": thrust})
    found.thrust.describe(found.duration)


def _thrust_file(rng: random.Random, folder: Path) -> None:
    suffix = rng.choice(list(THRUSTS))
    keys, text = THRUSTS[suffix]
    file = folder / f"motor.{suffix}"
    if rng.random() < 0.5:
        file.write_bytes(mutants.of_bytes(rng, text.encode()))
    else:
        file.write_bytes(mutants.of_text(rng, text).encode("utf-8", "surrogatepass"))
    raw, _ = reading.read("reference")
    raw.pop("provenance")
    thrust = {"kind": "measured", "file": str(file)} | keys
    if rng.random() < 0.3:
        thrust = mutants.of_plain(rng, thrust)
    found = scenes.parse(raw | {"thrust": thrust})
    found.thrust.describe(found.duration)
    implausible.of_all_conditions(found)


def _reference_curve(rng: random.Random, folder: Path) -> None:
    file = folder / "reference.csv"
    file.write_bytes(mutants.of_text(rng, _reference()).encode("utf-8", "surrogatepass"))
    Curves.read(file, rng.choice((None, 0.05)))


def _foreign_curve(rng: random.Random, folder: Path) -> None:
    """A file of another code, with its options."""
    name, content, options = rng.choice(_foreign())
    if isinstance(content, str):
        content = mutants.of_text(rng, content).encode("utf-8", "surrogatepass")
    else:
        content = mutants.of_bytes(rng, content)
    file = folder / name
    file.write_bytes(content)
    texts = {key: [text] for key, text in options.items()}
    if rng.random() < 0.3:
        key = rng.choice(list(texts))
        texts[key] = [mutants.of_text(rng, texts[key][0])]
    Curves.read(file, None, of_options(["a"], **texts)["a"], ("velocity_x",))


@cache
def _foreign() -> list[tuple[str, str | bytes, dict[str, str]]]:
    """Name, content and options of files with 3 ms of a motion."""
    dyna = {"units": "time=ms, length=mm", "body": "7"}
    names = "time=Time, velocity_x=VX, rate_x=WX, rate_y=-WY, rate_z=5"
    stated = {"columns": names, "units": "time=ms, velocity_x=mm/s, rate=deg/s", "axes": "scene"}
    rows = [f"{step / 4:g} {step} 1,5 {step % 3} -2e-1" for step in range(13)]
    table = "run\n# made\nTime VX WX WY WZ\n" + "\n".join(rows).replace(".", ",") + "\n"
    nodes, bodies = (dyna_files.longer(text, 7) for text in (dyna_files.NODOUT, dyna_files.RBDOUT))
    adams = {"body": "payload", "axes": "body"}
    return [
        ("table.txt", table, stated),
        ("table.tab", table.replace(" ", "\t"), stated),
        ("nodout", nodes, dyna | {"body": "1001"}),
        ("rbdout", bodies, dyna),
        ("binout", dyna_files.binout(steps=6).content, dyna),
        ("binout", dyna_files.binout(">", "f8", "i4", steps=6).content, dyna),
        ("run.res", adams_files.results(steps=6), adams),
    ]


@cache
def _reference() -> str:
    """A table of curves of another code."""
    rows = ["time,velocity_x,rate_x,rate_y,rate_z", "ms,m/s,deg/s,deg/s,deg/s"]
    rows += [f"{step / 2},{step / 50:.3f},{step / 25:.3f},-1.5,{step % 3}" for step in range(200)]
    return "\n".join(rows) + "\n"


def _log(rng: random.Random, folder: Path) -> None:
    sample = rng.choice(sheet.SAMPLES)
    log = sample.with_suffix(".csv")
    text, table = sample.read_text(encoding="utf-8"), log.read_text(encoding="utf-8")
    if rng.random() < 0.5:  # as another program writes it
        units = "#time [s];gx;gy;gz;ax [m s^-2];ay/(m/s^2);az (m/s^2);temperature"
        rows = table.partition("temperature\n")[2].replace(",", ";").replace(".", ",")
        table = f"% log\n{units}\n{rows}"
        text = text.replace('acceleration = "m/s**2"\n', "").replace("channel_class = 60\n", "")
    if rng.random() < 0.5:
        text = mutants.of_text(rng, text)
    else:
        table = mutants.of_text(rng, table)
    (folder / log.name).write_bytes(table.encode("utf-8", "surrogatepass"))
    file = folder / sample.name
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    analysis.analyse(file)


def _distributions(rng: random.Random, folder: Path) -> None:
    file = folder / "vary.toml"
    text = (uncertainty.CATALOG / "paper.toml").read_text(encoding="utf-8")
    file.write_bytes(mutants.of_text(rng, text).encode("utf-8", "surrogatepass"))
    found = uncertainty.load(file, scenes.load("reference"))
    for item in found.vary.values():
        item.ppf(np.array([0.1, 0.9]))


def _calibration(rng: random.Random, folder: Path) -> None:
    file = folder / "calibration.toml"
    file.write_bytes(mutants.of_text(rng, CALIBRATION).encode("utf-8", "surrogatepass"))
    found = constants(file, rng.choice((COMPLIANT, SPRINGS)), "reference")
    assert found is not None
    found.apply(scenes.load("reference"))


KINDS: dict[str, Callable[[random.Random, Path], None]] = {
    "scene": _scene,
    "override": _override,
    "step": _step,
    "mesh": _mesh,
    "mesh file": _mesh_file,
    "solid": _solid,
    "table": _table,
    "curve": _curve,
    "thrust file": _thrust_file,
    "reference curve": _reference_curve,
    "foreign curve": _foreign_curve,
    "log": _log,
    "distributions": _distributions,
    "calibration": _calibration,
    **results.KINDS,
    **sections.KINDS,
}
