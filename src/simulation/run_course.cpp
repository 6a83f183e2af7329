#include "kluft/simulation/run_course.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/simulation/weakening.hpp"

namespace kluft {

namespace {

void notify_step(RunCourse& course, const LoadSteps& steps, const StepRecord& record, bool last_of_stage) {
    course.last_record = record;
    const Stopwatch watch(course.report.costs.seconds.observers);
    course.observer.step(record, course.work, steps.fields, last_of_stage);
}

void next_stage(RunCourse& course, const LoadSteps& steps) {
    steps.end_stage();
    if (course.work.stage < static_cast<int>(course.model.loads.stages.size())) accept(course, steps);
}

void report_initial_state(RunCourse& course, const LoadSteps& steps) {
    StepRecord record = steps.initial_record();
    record.step = 0;
    notify_step(course, steps, record, false);
}

/// Of a stage whose load steps the integrator ends where it likes.
void run_chosen_steps(RunCourse& course, const LoadSteps& steps) {
    State& work = course.work;
    while (work.load_factor < 1.0) {
        course.passes = 0;
        const StepRecord record = steps.load_step(1.0, false);
        commit_load_step(course, steps, record, work.load_factor, work.load_factor >= 1.0);
        steps.look_back(record);
    }
}

void run_to_the_end(RunCourse& course, const LoadSteps& steps) {
    State& work = course.work;
    for (; work.stage < static_cast<int>(course.model.loads.stages.size()); next_stage(course, steps)) {
        const int n_steps = course.stage().steps;
        course.loads.emplace(enter_stage(course.model, work));
        steps.begin_stage();
        if (work.step == 0 && work.stage == 0) report_initial_state(course, steps);
        if (course.stage().strength_reduction) steps.reduce_strengths();
        if (steps.chooses_steps && steps.chooses_steps()) {
            run_chosen_steps(course, steps);
            continue;
        }
        while (work.step_in_stage < n_steps) {
            const double load_factor = static_cast<double>(work.step_in_stage + 1) / n_steps;
            const bool last_of_stage = work.step_in_stage + 1 == n_steps;
            course.passes = 0;
            const StepRecord record = steps.load_step(load_factor, last_of_stage);
            commit_load_step(course, steps, record, load_factor, last_of_stage);
            steps.look_back(record);
        }
    }
}

void end_out_of_resources(RunReport& report, const std::string& what) {
    report.status = RunStatus::out_of_resources;
    report.diagnosis = what;
}

} // namespace

RunCourse::RunCourse(const Model& body, State& state, StepObserver& told, const std::atomic<bool>& asked_to_stop)
    : model(body), accepted(state), observer(told), stop(asked_to_stop), work(state), gauges(make_gauges(body)) {
    for (const Stage& each : model.loads.stages) n_steps += each.steps;
    report.costs = state.costs;
}

double RunCourse::elapsed() const {
    const auto since = std::chrono::steady_clock::now() - started;
    return report.costs.elapsed_s + std::chrono::duration<double>(since).count();
}

bool RunCourse::is_platen_loaded_by_stress() const {
    const auto& motion = stage().motion;
    return motion && motion->control == PlatenControl::stress;
}

bool RunCourse::is_loaded_by_stress() const { return !stage().motion || is_platen_loaded_by_stress(); }

void accept(RunCourse& course, const LoadSteps& steps) {
    course.work.costs = steps.costs();
    State next = course.work;
    course.accepted = std::move(next);
}

RunReport run_stages(RunCourse& course, const LoadSteps& steps) {
    RunReport& report = course.report;
    try {
        run_to_the_end(course, steps);
    } catch (const Interrupted&) {
        report.status = RunStatus::interrupted;
    } catch (const LostEquilibrium& failure) {
        const bool is_limit = report.factor_of_safety ||
                              (failure.may_be_collapse && course.is_loaded_by_stress() && course.accepted.step > 0);
        report.status = is_limit ? RunStatus::collapsed : RunStatus::no_equilibrium;
        report.diagnosis = fmt::format("no equilibrium in stage {} at load step {}: {}", course.work.stage,
                                       course.work.step + 1, failure.what);
        if (report.factor_of_safety)
            report.diagnosis =
                fmt::format("factor of safety {:.6g}; beyond it {}", *report.factor_of_safety, report.diagnosis);
    } catch (const ResourceError& error) {
        end_out_of_resources(report, error.what());
    } catch (const std::bad_alloc&) {
        end_out_of_resources(report, "out of memory");
    }
    report.costs = steps.costs();
    return report;
}

void commit_load_step(RunCourse& course, const LoadSteps& steps, StepRecord record, double load_factor,
                      bool last_of_stage, bool regular) {
    State& work = course.work;
    work.load_factor = load_factor;
    if (regular) ++work.step_in_stage;
    ++work.step;
    work.unbalanced_in_succession = record.balanced ? 0 : work.unbalanced_in_succession + 1;
    if (!record.balanced) ++course.report.unbalanced_steps;
    record.step = work.step;
    record.load_factor = load_factor;
    record.crack_passes = course.passes;
    accept(course, steps);
    tell_waiting(course);
    notify_step(course, steps, record, last_of_stage);
}

void tell_waiting(RunCourse& course) {
    for (const StepRecord& record : std::exchange(course.waiting_equilibria, {})) course.observer.equilibrium(record);
    for (const CrackRecord& crack : std::exchange(course.waiting_cracks, {})) course.observer.crack(crack);
}

void notify_equilibrium(RunCourse& course, const StepRecord& record) {
    if (course.holds_back) {
        course.waiting_equilibria.push_back(record);
        return;
    }
    const Stopwatch watch(course.report.costs.seconds.observers);
    course.observer.equilibrium(record);
}

void notify_progress(RunCourse& course, double load_factor, int n_solves) {
    const StepRecord& last = course.last_record;
    Progress progress;
    progress.stage = course.work.stage;
    progress.n_stages = static_cast<int>(course.model.loads.stages.size());
    progress.step = course.work.step;
    progress.n_steps = course.chooses_steps ? 0 : course.n_steps;
    progress.load_factor = load_factor;
    progress.axial_strain = last.axial_strain;
    progress.axial_stress = last.axial_stress;
    progress.cracks = last.cracks_tension + last.cracks_shear;
    progress.open_close_iterations = n_solves;
    course.observer.progress(progress);
}

std::vector<CrackCandidate> check_cracks(RunCourse& course, CrackCriterion criterion, const std::vector<char>& bonded,
                                         const std::vector<Strength>& strengths, const LoadedBody& body,
                                         const Eigen::VectorXd& q) {
    const Stopwatch watch(course.report.costs.seconds.crack_check);
    ++course.report.crack_checks;
    const Model& model = course.model;
    const auto stresses = block_stresses(body, q);
    if (criterion == CrackCriterion::principal_stress) return crack_check(model.system, bonded, strengths, stresses);
    return crack_check(model.system, bonded, strengths, stresses, bond_tractions(model, body, q));
}

void weaken_together(RunCourse& course, const std::vector<CrackCandidate>& broken, double axial_strain) {
    ++course.passes;
    ++course.report.costs.events;
    for (const CrackCandidate& candidate : broken) {
        CrackRecord record = weaken(course.model, candidate, course.work);
        record.pass = course.passes;
        record.axial_strain = axial_strain;
        if (course.holds_back) {
            course.waiting_cracks.push_back(record);
        } else {
            course.observer.crack(record);
        }
    }
    std::ranges::sort(course.work.contacts, {}, &ContactMemory::key);
}

} // namespace kluft
