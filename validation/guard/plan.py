"""What the guard runs. Names are those under which results are kept."""

from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MODELS = ROOT / "models"
SCENES = HERE / "scenes"

EXPLICIT = {"analysis.integrator": "explicit"}
TRIAXIAL = ("1", "2", "3", "4", "5", "6", "3-all", "4-all", "5-all", "6-all")

# Runs that would take minutes as they stand, made shorter: they still break and slide.
SHORTER = {
    "triaxial/case-5": {"stages.1.strain.value": "0.5 %", "stages.1.steps": 20},
}

# Cases of a ready-made study that cost more than they add.
LEFT_OUT_OF_STUDIES = ("=400", "=800", "reference")

# One at a time about cracks.yaml: what no model sets.
CRACKS = {
    "all": {"cracks.update": "all"},
    "critical_first": {"cracks.update": "critical_first"},
    "single": {"cracks.update": "single"},
    "event": {},
    "every-3": {"cracks.update": "all", "cracks.every": 3},
    "event-every-3": {"cracks.every": 3},
    "detection-every-5": {"solver.detection_every": 5},
    "no-reuse": {"solver.reuse": False},
    "symmetric": {"solver.tangent": "symmetric"},
    "interface-traction": {"cracks.criterion": "interface_traction"},
    "noise": {"cracks.strength_noise": 0.1},
    "no-rounding": {"interfaces.joint.contact_rounding": 0, "interfaces.joint.friction_rounding": 0},
    "few-iterations": {"solver.max_iterations": 3},
    "plane-stress": {"analysis.plane": "stress"},
    "rough": {"stages.1.platens": "rough"},
    "voronoi": {"geometry.tessellation.triangles": None, "geometry.tessellation.voronoi.spacing": 0.05},
    "all-accuracy": {"cracks.update": "all", "solver.accuracy": 0.02},
}


@dataclass
class Run:
    """One run of the program. `resume`: overrides of a second run that goes on from the first one's saved state."""

    name: str
    scene: Path
    overrides: dict = field(default_factory=dict)
    resume: dict | None = None
    killed: bool = False  # the first run is killed as soon as it has saved a state, that of the end of its first stage
    long: bool = False  # is started first
    quiet: bool = True  # no pictures, no fields
    words: tuple = ()  # of the command line


@dataclass
class Script:
    """A script that runs the program many times. A stand-in for the program keeps each run under the script's name."""

    name: str
    command: list  # "{program}" and "{output}" stand for what the guard gives it
    long: bool = False


@dataclass
class Study:
    """A study: the program says what its cases are, the guard runs them."""

    name: str
    words: list
    leave_out: tuple = ()


def models():
    runs = [Run("models/quickstart", MODELS / "quickstart.yaml", quiet=False), Run("models/outcrop-kb7", MODELS / "outcrop-kb7.yaml")]
    scenes = [f"case-{case}" for case in TRIAXIAL]
    known = {MODELS / "triaxial" / f"{name}.yaml" for name in scenes} | {run.scene for run in runs}
    for name in scenes:
        overrides = SHORTER.get(f"triaxial/{name}", {})
        runs.append(Run(f"models/triaxial/{name}", MODELS / "triaxial" / f"{name}.yaml", overrides,
                        long=name in ("case-5", "case-6", "case-6-all")))
    # A model that is added is run without being named here; base and model-* are what the cases extend.
    for scene in sorted([*MODELS.glob("*.yaml"), *(MODELS / "triaxial").glob("case-*.yaml")]):
        if scene not in known:
            runs.append(Run(f"models/{scene.relative_to(MODELS).with_suffix('')}", scene))
    return runs


def explicit_runs():
    """The fastest runs of implicit-vs-explicit; those of its suite's scenes at their own rate, too."""
    triaxial = MODELS / "triaxial"
    fast = {**EXPLICIT, "analysis.loading_rate": 0.04}
    bundle, shear = ROOT / "validation" / "bond-bundle" / "scene.yaml", ROOT / "validation" / "dilatant-shear" / "scene.yaml"
    return [
        Run("explicit/case-1", triaxial / "case-1.yaml", fast),
        Run("explicit/case-3", triaxial / "case-3.yaml", {**fast, "stages.1.strain.value": 0.013}, long=True),
        Run("explicit/case-3-all", triaxial / "case-3-all.yaml", {**fast, "stages.1.strain.value": 0.014}, long=True),
        Run("explicit/bond-bundle", bundle, {**EXPLICIT, "analysis.loading_rate": 1e-5, "stages.0.steps": 50, "solver.balance": 1e-4}),
        Run("explicit/dilatant-shear", shear,
            {**EXPLICIT, "analysis.loading_rate": 2e-5, "stages.1.steps": 50, "interfaces.joint.normal_stiffness": 1e12,
             "interfaces.joint.shear_stiffness": 5e11, "stages.1.displacement.value": 5e-6, "solver.balance": 1e-4}),
        Run("explicit/quickstart", MODELS / "quickstart.yaml", {**EXPLICIT, "stages.1.strain.value": "1 %", "stages.1.steps": 10}),
    ]


def accuracy_runs():
    """Steps by their error, on other scenes: first steps that are too large, loads that are prescribed, rigid blocks."""
    triaxial = MODELS / "triaxial"
    scenes = {
        "coarse": (SCENES / "accuracy.yaml", {}),
        "fine": (SCENES / "accuracy.yaml", {"solver.accuracy": 0.003}),
        "large-first-step": (SCENES / "accuracy.yaml", {"stages.1.steps": 2}),
        "case-1": (triaxial / "case-1.yaml", {"solver.accuracy": 0.01}),
        "case-1-large-first-step": (triaxial / "case-1.yaml", {"solver.accuracy": 0.002, "stages.1.steps": 1}),
        "case-3": (triaxial / "case-3.yaml", {"solver.accuracy": 0.02, "stages.1.strain.value": "1.4 %"}),
        "outcrop": (MODELS / "outcrop-kb7.yaml", {"solver.accuracy": 0.01, "stages.0.steps": 2}),
        "stages": (SCENES / "stages.yaml", {"solver.accuracy": 0.02}),
        "collapse": (SCENES / "collapse.yaml", {"solver.accuracy": 0.02}),
        "rigid": (SCENES / "rigid.yaml", {"solver.accuracy": 0.02}),
        "reduction": (SCENES / "reduction.yaml", {"solver.accuracy": 0.02}),
    }
    return [Run(f"own/accuracy/{name}", scene, overrides) for name, (scene, overrides) in scenes.items()]


def own_runs():
    runs = [Run(f"own/cracks/{name}", SCENES / "cracks.yaml", overrides) for name, overrides in CRACKS.items()]
    runs += [Run(f"own/{name}", SCENES / f"{name}.yaml") for name in
             ("rigid", "reduction", "collapse", "no-equilibrium", "stages")]
    runs += accuracy_runs()
    runs += [
        Run("own/reduction-rigid", SCENES / "reduction.yaml", {"analysis.kinematics": "rigid", "materials.rock.cohesion": "0.08 MPa"}),
        Run("own/stages-killed-resumed", SCENES / "stages.yaml", resume={}, killed=True),
        Run("own/no-equilibrium-resumed", SCENES / "no-equilibrium.yaml", resume={"solver.max_unbalanced_steps": 4}),
        Run("own/refused", SCENES / "cracks.yaml", {"solver.accuracy": 0.02, "cracks.every": 3}),
    ]
    return runs


def validation_cases():
    """Each with all runs that its check.py makes."""
    names = sorted(check.parent.name for check in (ROOT / "validation").glob("*/check.py"))
    return [Script(f"validation/{name}", [str(ROOT / "scripts" / "validate"), name, "--jobs", "1", "--kluft", "{program}", "-o", "{output}"],
                   long=name in ("frictional-crack", "yade", "voussoir-beam")) for name in names]


def extremes():
    script = ROOT / "validation" / "extremes" / "run"
    return [Script("extremes", [str(script), "--quick", "--jobs", "1", "--kluft", "{program}", "-o", "{output}"], long=True)]


def studies():
    found = [Study(f"studies/{file.stem}", [str(file)]) for file in sorted((MODELS / "studies").glob("*.yaml"))]
    return [*found, Study("studies/trade-quickstart", ["trade", str(MODELS / "quickstart.yaml")], LEFT_OUT_OF_STUDIES)]


def everything():
    return [*extremes(), *models(), *explicit_runs(), *validation_cases(), *studies(), *own_runs()]
