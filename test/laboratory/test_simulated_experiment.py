"""The simulated experiment and the graph of processes are one experiment."""

from dataclasses import replace

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.recording.reader import RunBag


def test_the_graph_gives_the_readings_of_the_simulated_experiment(recorded):
    experiment = SimulatedExperiment(
        plant=load_preset('ideal'), instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=1
    )
    there = [RunBag(path).run for path in sorted(recorded[0].iterdir())]
    here = experiment.runs()
    assert len(here) == len(there) == 3
    for mine, theirs in zip(here, there, strict=True):
        assert mine.plant == theirs.plant
        assert (mine.speed_asked, mine.release) == (theirs.speed_asked, theirs.release)
        # the shown times travel as whole nanoseconds
        assert [(r.kind, r.swings, round(r.displayed, 6)) for r in mine.readings['stopwatch']] == [
            (r.kind, r.swings, round(r.displayed, 6)) for r in theirs.readings['stopwatch']
        ]
        assert [r.speed for r in mine.readings['strobe']] == [r.speed for r in theirs.readings['strobe']]
        for name in ('strobe', 'stopwatch'):
            assert mine.settings[name]['instrument'] == theirs.settings[name]['instrument']
    other = replace(experiment, seed=2).runs()
    assert [run.period for run in other] != [run.period for run in there]
