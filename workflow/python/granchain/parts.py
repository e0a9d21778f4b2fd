"""Parts of the core for plug-ins: what a study, a tool, a measure or an engine is made of.

Each name is documented where it is defined. It is imported when it is first used, so that a command loads only what it
needs. A plug-in imports nothing else of the core; what users call is in `granchain`.

Examples in its documentation begin with the module or function itself, as imported from here, and use `granchain`,
NumPy as `np`, and `tmp`, the path of an empty directory.
"""

from typing import TYPE_CHECKING, Any

from workflow import lazy_names

if TYPE_CHECKING:
    from analysis import hermite as hermite
    from analysis import motion as motion
    from analysis import quantity as quantity
    from analysis.compare import difference as difference
    from analysis.compare.common_times import paired as paired
    from analysis.figures import drawing as drawing
    from analysis.figures import panels as panels
    from analysis.figures import spacetime as spacetime
    from analysis.figures import studies as studies
    from analysis.figures import style as style
    from analysis.figures.errors import residual_figure as residual_figure
    from analysis.files import recording as recording
    from analysis.files import traces as traces
    from analysis.files.binary_dump import BinaryDump as BinaryDump
    from analysis.gauges import channels as channels
    from analysis.meters import Meter as Meter
    from analysis.meters import Part as Part
    from analysis.meters import parts_of as parts_of
    from analysis.shape import exact_wave as exact_wave
    from analysis.shape import long_waves as long_waves
    from analysis.shape import unit_cell as unit_cell
    from analysis.sharing import energies as energies
    from analysis.sharing import impulses as impulses
    from analysis.sharing.survey import Survey as Survey
    from analysis.tracking import leading_passages as leading_passages
    from analysis.tracking import leading_waves as leading_waves
    from analysis.tracking import peaks as peaks
    from analysis.trajectory import Flags as Flags
    from analysis.trajectory import Floats as Floats
    from analysis.trajectory import Integers as Integers
    from analysis.trajectory import Trajectory as Trajectory
    from analysis.trajectory import frames_per_block as frames_per_block
    from lammps_inputs import Problem as Problem
    from lammps_inputs import System as System
    from lammps_inputs import complaints as complaints
    from lammps_inputs import file_names as file_names
    from lammps_inputs import html as html
    from lammps_inputs import installed_scenes as installed_scenes
    from lammps_inputs import laws as laws
    from lammps_inputs import library as library
    from lammps_inputs import numbers as numbers
    from lammps_inputs import output as output
    from lammps_inputs import physics as physics
    from lammps_inputs import plugins as plugins
    from lammps_inputs import references as references
    from lammps_inputs import schema as schema
    from lammps_inputs import strict_yaml as strict_yaml
    from lammps_inputs import units as units
    from lammps_inputs import window as window
    from lammps_inputs.deck_lines import DeckLines as DeckLines
    from lammps_inputs.decks import continuation as continuation
    from lammps_inputs.decks import deck as deck
    from lammps_inputs.decks import scene_files as scene_files
    from lammps_inputs.facts import Fact as Fact
    from lammps_inputs.ingredients import contact as contact
    from lammps_inputs.ingredients import registry as registry
    from lammps_inputs.ingredients import walls as walls
    from lammps_inputs.ingredients.base import FurtherAtoms as FurtherAtoms
    from lammps_inputs.ingredients.base import Ingredient as Ingredient
    from lammps_inputs.ingredients.base import Setting as Setting
    from lammps_inputs.ingredients.unequal import radii as radii
    from lammps_inputs.laws import dashpot as dashpot
    from lammps_inputs.laws import formula as formula
    from lammps_inputs.limits import rates as rates
    from lammps_inputs.limits.closing import THETA_OF_EQ_5 as THETA_OF_EQ_5
    from lammps_inputs.links import Links as Links
    from lammps_inputs.materials import Solid as Solid
    from lammps_inputs.scene import DEFAULT_ACCURACY as DEFAULT_ACCURACY
    from workflow import cli as cli
    from workflow import compiled as compiled
    from workflow import cost_model as cost_model
    from workflow import errors as errors
    from workflow import formats as formats
    from workflow import inputs as inputs
    from workflow import provenance as provenance
    from workflow import screen as screen
    from workflow.checked import Between as Between
    from workflow.checked import checked as checked
    from workflow.commands import analyze as analyze
    from workflow.commands.deck import write as write
    from workflow.commands.sweep import case_decks as case_decks
    from workflow.engines.lammps import mpi as mpi
    from workflow.engines.lammps.engine import run_deck as run_deck
    from workflow.engines.reference import engine as engine
    from workflow.engines.reference import kernel as kernel
    from workflow.engines.reference import kernel_inputs as kernel_inputs
    from workflow.engines.reference import schemes as schemes
    from workflow.engines.reference.step_halving import StepHalving as StepHalving
    from workflow.measures import forces as forces
    from workflow.measures import measurement as measurement
    from workflow.prepare.settings import settle as settle
    from workflow.quantities import columns as columns
    from workflow.quantities import evaluate as evaluate
    from workflow.runs import engines as engines
    from workflow.runs import job as job
    from workflow.runs import labelled as labelled
    from workflow.runs import output_directory as output_directory
    from workflow.runs import status as status
    from workflow.runs.files import complete as complete
    from workflow.runs.files import write_text as write_text
    from workflow.runs.frames import write_frames as write_frames
    from workflow.runs.run import run as run
    from workflow.runs.run_directory import RunDirectory as RunDirectory
    from workflow.study_kit import options as options
    from workflow.study_kit import page as page
    from workflow.study_kit.directory import Study as Study
    from workflow.study_kit.kept_run import kept_run as kept_run
    from workflow.sweep import axes as axes
    from workflow.sweep import collect as collect
    from workflow.sweep import fields as fields
    from workflow.sweep import file_parts as file_parts
    from workflow.sweep.run_table import table_of as table_of
    from workflow.verdicts import analyse as analyse
    from workflow.verdicts import analysis_lines as analysis_lines
    from workflow.verdicts import places as places
    from workflow.verdicts import terms as terms
    from workflow.verdicts import validate as validate
    from workflow.verdicts import validate_run as validate_run
    from workflow.verdicts import validation_tables as validation_tables
    from workflow.workers import computations as computations
else:
    _SOURCES = lazy_names.sources(__file__)

    def __getattr__(name: str) -> Any:
        """Part of the core, imported when it is first used."""
        if name not in _SOURCES:
            raise AttributeError(f"module 'granchain.parts' has no attribute {name!r}")
        return globals().setdefault(name, lazy_names.imported(*_SOURCES[name]))
