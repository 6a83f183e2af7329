import gc
import os
import resource
import signal
import threading
import time

import numpy as np
import pytest
from conftest import small_scene

import kluft


def test_each_pass_is_a_load_step(scene):
    simulation = kluft.Simulation(scene)
    rows = [(row["step"], row["axial_stress"]) for row in simulation]
    assert simulation.status == "done"
    assert [step for step, _ in rows] == list(range(1, len(rows) + 1))
    assert len(simulation.history) == len(rows) + 1 and simulation.history["step"][0] == 0
    assert [stress for _, stress in rows] == list(simulation.history["axial_stress"][1:])
    with pytest.raises(StopIteration):
        next(simulation)


def test_a_simulation_step_by_step_is_the_run(scene, tmp_path):
    results = scene.run(tmp_path / "run")
    simulation = kluft.Simulation(scene)
    list(simulation)
    same = [name for name in results.history.dtype.names if name != "elapsed_s"]
    np.testing.assert_array_equal(simulation.history[same], results.history[same])
    np.testing.assert_array_equal(simulation.fields().stress, results.fields().stress)


def test_the_state_is_a_view_that_stays_what_it_is(scene):
    simulation = kluft.Simulation(scene)
    next(simulation)
    unknowns = simulation.unknowns
    assert unknowns.shape == (simulation.n_blocks, 6) and not unknowns.flags.owndata and not unknowns.flags.writeable
    assert np.shares_memory(unknowns, simulation.unknowns) and np.shares_memory(unknowns, simulation.displacement)
    before = unknowns.copy()
    next(simulation)
    np.testing.assert_array_equal(unknowns, before)
    assert not np.array_equal(simulation.unknowns, before)
    np.testing.assert_allclose(simulation.fields().displacement, simulation.displacement, atol=1e-15)
    del simulation
    gc.collect()
    np.testing.assert_array_equal(unknowns, before)


def test_interfaces_say_what_has_become_of_them(scene):
    simulation = kluft.Simulation(scene)
    assert set(simulation.interface_status) == {0, 1}
    simulation.run()
    status = simulation.interface_status
    last = simulation.history[-1]
    assert np.count_nonzero(status == 2) == last["cracks_tension"]
    assert np.count_nonzero(status == 3) == last["cracks_shear"]
    names = np.array(kluft.INTERFACE_STATUS)[status]
    assert set(names) <= {"potential_crack", "fracture", "tension_crack", "shear_crack"}


def test_callbacks_get_each_row_and_their_errors_come_through(scene):
    def stop(row):
        if row["step"] == 3:
            raise ZeroDivisionError

    simulation = kluft.Simulation(scene)
    with pytest.raises(ZeroDivisionError):
        simulation.run(on_step=stop)
    assert simulation.step == 3 and simulation.status == "running"
    simulation.run()
    assert simulation.status == "done"


def interrupt_soon(times=1):
    def kill():
        for _ in range(times):
            time.sleep(0.1)
            os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=kill, daemon=True).start()


def interrupted(simulation):
    """Steps until Ctrl-C."""
    with pytest.raises(KeyboardInterrupt):
        for _ in simulation:
            pass
        time.sleep(5)


def test_ctrl_c_stops_after_the_load_step_and_the_simulation_goes_on(scene, tmp_path):
    scene["stages.1.steps"] = 100000  # more than it can do before Ctrl-C
    simulation = kluft.Simulation(scene, tmp_path / "run")
    next(simulation)
    interrupt_soon()
    interrupted(simulation)
    reached = simulation.step
    assert (tmp_path / "run" / "state.h5").exists()
    assert simulation.status == "running"
    assert next(simulation)["step"] in (reached + 1, reached + 2)  # Ctrl-C may come between two calls
    simulation.close()
    assert kluft.open(tmp_path / "run").status == "interrupted"


def test_closing_or_forgetting_a_simulation_ends_it_with_its_files(scene, tmp_path):
    with kluft.Simulation(scene, tmp_path / "closed") as simulation:
        next(simulation)
    assert kluft.open(tmp_path / "closed").status == "interrupted"
    with pytest.raises(StopIteration):
        next(simulation)
    simulation = kluft.Simulation(scene, tmp_path / "forgotten")
    next(simulation)
    del simulation
    gc.collect()
    assert kluft.open(tmp_path / "forgotten").status == "interrupted"


def test_two_simulations_side_by_side_are_those_alone(scene):
    alone = kluft.Simulation(scene).run().history
    first, second = kluft.Simulation(scene), kluft.Simulation(scene)
    for _ in first:
        next(second)
    same = [name for name in alone.dtype.names if name != "elapsed_s"]
    np.testing.assert_array_equal(first.history[same], alone[same])
    np.testing.assert_array_equal(second.history[same], alone[same])


def test_a_simulation_takes_a_mapping_and_refuses_a_wrong_one(scene):
    assert kluft.Simulation(scene.to_dict()).n_blocks == scene.check().blocks
    scene["geometry.domain"] = {"polygon": [[0, 0], [1, 0], [0, 1]]}  # whose sides have other names
    with pytest.raises(kluft.InputError) as caught:
        kluft.Simulation(scene)
    assert caught.value.path == "stages.0.pressure.right" and caught.value.line > 0
    with pytest.raises(ValueError, match="output"):
        kluft.Simulation(scene, resume=True)


def test_a_full_disk_has_a_type_of_its_own(scene, tmp_path):
    """Files may grow to a few kilobytes."""
    simulation = kluft.Simulation(scene, tmp_path / "run")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    try:
        with pytest.raises(kluft.ResourceError):
            simulation.run()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert simulation.status == "out_of_resources"


def test_closing_while_another_thread_computes_ends_the_run():
    scene = small_scene(**{"stages.1.steps": 400})
    for pause in (0.0, 0.02, 0.05, 0.08):
        simulation = kluft.Simulation(scene)
        thread = threading.Thread(target=simulation.run)
        thread.start()
        time.sleep(pause)
        simulation.close()
        thread.join(timeout=60)
        assert not thread.is_alive()


def test_a_forked_process_does_not_go_on_with_a_started_simulation(scene):
    simulation = kluft.Simulation(scene)
    next(simulation)
    child = os.fork()
    if child == 0:
        try:
            next(simulation)
        except RuntimeError as error:
            os._exit(7 if "forked" in str(error) else 1)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    next(simulation)
