"""Commands of a user's deck."""

import pytest

from workflow.plugins.adopt.deck_text import refusal, words_of


@pytest.mark.parametrize(
    ("wrong", "commands"),
    [
        (True, ["units real", "atom_style full", "pair_style hybrid/overlay granular lj/cut 2.5", "read_restart x"]),
        (True, ["pair_coeff * * jkr 1 1 1 1", "bond_style fene", "fix 1 all nvt temp 1 1 1", "fix 1 all ${style}"]),
        (True, ["run_style respa 2 2 bond 1", "python f input 1 source x", "variable f python g", "${command} all"]),
        (True, ["run 10 every 5 'print 1'", "plugin load x.so", "include ${file}", "if 1 then 'shell rm x'"]),
        (True, ["if 1 then 'run 10'", "if 1 then \"print 'x' file y\"", "if 0 then 'print 1' else 'write_data x'"]),
        (False, ["units si", "atom_style hybrid sphere bond", "pair_style granular", "fix 1 all nve/sphere"]),
        (False, ["pair_style gran/hertz/history/omp 1 NULL 50 NULL 0.5 1", "dump 1 all custom 10 f x", "run 10 upto"]),
        (False, ["shell mkdir post", "if '$i > 3' then 'jump SELF out' else 'next i'", "jump SELF here"]),
    ],
)
def test_what_no_scene_has_is_refused_and_what_a_chain_needs_is_not(wrong: bool, commands: list[str]) -> None:
    assert [bool(refusal(words_of(command))) for command in commands] == [wrong] * len(commands)
