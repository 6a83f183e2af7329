#include "kluft/studies/scene_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <regex>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/reference/explicit_simulation.hpp"
#include "kluft/scene/key_places.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/simulation/cohesion_share.hpp"
#include "kluft/simulation/contact_following.hpp"
#include "kluft/simulation/contact_pressure.hpp"
#include "kluft/simulation/corner_contact.hpp"
#include "kluft/simulation/fingerprint.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/pulling_support.hpp"
#include "kluft/simulation/rock_constants.hpp"
#include "kluft/simulation/rocking_joint.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/stability.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "kluft/studies/earlier_results.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

std::string peak_in_words(const CurveNumbers& numbers, RunStatus status) {
    if (numbers.net_locked)
        return " before the net locked (its loose cells carry more without a bond: no strength of the rock)";
    if (numbers.sides_unloaded) return ", from which it fell after the sides were unloaded";
    if (numbers.peak_reached) return "";
    return status == RunStatus::collapsed ? ", above which nothing stands" : fmt::format(" ({})", peak_remark(numbers));
}

/// "" where none is known.
std::string difference_from_state(const fs::path& state, const Scene& scene) {
    try {
        return body_difference(read_state_scene(state), scene);
    } catch (const InputError&) {
        return {};
    }
}

/// Whether a warning begins with a place in a scene ("slope.yaml:8:11: ...", "--set key=1: ..."): whoever reads the scene makes it anew.
bool has_place_in_scene(const std::string& warning) {
    static const std::regex place(R"(^(--set .*|.*:[0-9]+:[0-9]+): )");
    return std::regex_search(warning.substr(0, warning.find('\n')), place);
}

} // namespace

RunWriterOptions run_writer_options(const Scene& scene, const Model& model) {
    RunWriterOptions options;
    options.fields = scene.output.fields;
    options.fields_every = scene.output.fields_every;
    options.fields_at_cracks = scene.output.fields_at_cracks;
    options.pictures = scene.output.pictures;
    options.checkpoint_every = scene.output.checkpoint_every;
    options.checkpoint_seconds = scene.output.checkpoint_seconds;
    options.title = heading_of(scene);
    options.fingerprint = fingerprint(model);
    options.scene_text = scene.text;
    const int platen_stage = make_gauges(model).first_platen_stage;
    if (platen_stage >= 0) options.platen_stage = platen_stage;
    options.plane = scene.plane;
    options.compliance_across = model.compliance_across;
    options.modulus = largest_modulus(scene.materials);
    options.has_elastic_constants = has_elastic_constants(model);
    options.elastic_constants_warning = elastic_constants_warning(model);
    options.strength_factor = reduction_of(model.loads, 0) != nullptr;
    options.motion = scene.integrator == Integrator::explicit_motion;
    options.history_columns = history_columns(model);
    for (const Material& material : scene.materials) options.material_names.push_back(material.name);
    for (const InterfaceType& type : scene.interface_types) options.interface_type_names.push_back(type.name);
    for (const FractureTrace& fracture : scene.geometry.fractures) options.fracture_names.push_back(fracture.name);
    for (const int type : model.law_types) options.law_names.push_back(scene.interface_types[type].name);
    return options;
}

std::string scene_file_for(const fs::path& directory, const Scene& scene, bool may_replace) {
    if (!may_replace) require_no_other_results(directory, scene);
    return has_own_scene_file(directory, scene) ? "" : write_scene_as_run(scene);
}

State state_to_resume(const fs::path& directory, const Scene& scene, const std::string& fingerprint) {
    const fs::path file = directory / "state.h5";
    if (fs::is_directory(directory) && !fs::exists(file))
        throw InputError(fmt::format(
            "{}: expected a state to go on from, found none: no run in {} has saved one yet (they do at the "
            "end of a stage, each output.checkpoint_seconds and where they are stopped); run without "
            "--resume",
            file.string(), directory.string()));
    try {
        return read_state(file, fingerprint);
    } catch (const InputError&) {
        const std::string difference = difference_from_state(file, scene);
        if (difference.empty()) throw;
        throw InputError(fmt::format("{}: belongs to another scene: {}; a run goes on with other keys of solver, "
                                     "cracks (not strength_noise and strength_seed) and output, and with another "
                                     "stages.<i>.stop_after_drop, but with the same body, laws and loads",
                                     file.string(), difference));
    }
}

EarlierRuns earlier_runs(const fs::path& directory) {
    try {
        RunSummary summary = read_summary(directory / "summary.json");
        std::erase_if(summary.warnings, has_place_in_scene);
        return {summary.cpu_s, std::move(summary.warnings)};
    } catch (const InputError&) {
        return {
            0.0,
            {"the run before this one has left no summary that can be read: of bonds and corners that carry more "
             "than they bear, and of platens that leave the body, only the load steps from its saved state on tell"}};
    }
}

SceneModel build_for_run(const Scene& scene) {
    SceneModel built = build_scene_model(scene);
    if (scene.integrator != Integrator::explicit_motion) return built;
    std::string warning = warning_of_long_steps(built.model, scene.explicit_options);
    if (!warning.empty()) built.model.warnings.push_back(located(warning, scene.places));
    return built;
}

RunReport run_stages(const Model& model, const Scene& scene, State& state, StepObserver& observer,
                     const std::atomic<bool>& stop) {
    if (scene.integrator == Integrator::explicit_motion) {
        return run_explicit(model, scene.cracks, scene.solver, scene.explicit_options, state, observer, stop);
    }
    return run_simulation(model, scene.cracks, scene.solver, state, observer, stop);
}

void ContactWatch::step(const StepRecord& record, const State& state) {
    for (const double stress : {record.axial_stress, record.lateral_stress})
        largest_stress_ = std::max(largest_stress_, std::abs(stress));
    corners_.step(record, state);
    bonds_.step(record, state);
    bending_.step(record, state);
    platens_.step(record, state);
    tips_.step(record, state);
}

void warn_of_contacts(const Model& model, const State& state, const ContactWatch& watch, RunReport& report) {
    if (report.status == RunStatus::out_of_resources) return;
    const auto add = [&](const std::string& warning) {
        if (!warning.empty()) report.warnings.push_back(warning);
    };
    try {
        if (report.status == RunStatus::interrupted) {
            add(watch.corners().warning());
            add(watch.bonds().warning());
            add(watch.bending().warning());
            add(watch.platens().warning());
            add(watch.tips().warning());
            return;
        }
        for (const std::string& warning :
             {contact_pressure_warning(model, state, watch.largest_stress()), corner_contact_warning(model, state),
              watch.corners().warning(), watch.bonds().warning(), watch.bending().warning(), watch.platens().warning(),
              watch.tips().warning(), rocking_joint_warning(model, state), pulling_support_warning(model, state),
              cohesion_share_warning(model, state),
              report.status == RunStatus::done ? contacts_anew_warning(model, state) : "",
              report.status == RunStatus::done ? unstable_equilibrium_warning(model, state) : ""})
            add(warning);
    } catch (const std::bad_alloc&) {
        return;
    } catch (const ResourceError&) {
        return;
    }
}

void add_earlier_warnings(const Scene& scene, const Model& model, const EarlierRuns& earlier, RunReport& report) {
    std::vector<std::string> warnings;
    const std::array<const std::vector<std::string>*, 4> all{&scene.warnings, &model.warnings, &earlier.warnings,
                                                             &report.warnings};
    for (const auto* const each : all)
        for (const std::string& warning : *each)
            if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
    report.warnings = std::move(warnings);
}

std::string closing_line(const RunReport& report, const RunSummary& summary, const fs::path& directory) {
    std::string text = status_name(report.status);
    if (summary.platen_stage && summary.numbers.peak_stress) {
        text += fmt::format(": peak axial stress {:.4g} MPa at {:.4g} %{}", 1e-6 * *summary.numbers.peak_stress,
                            100.0 * summary.numbers.peak_strain.value_or(0.0),
                            peak_in_words(summary.numbers, report.status));
        if (const int n = summary.numbers.jumps_to_peak; n > 0)
            text += fmt::format(" after {} {}", n, n == 1 ? "jump" : "jumps");
    }
    if (!report.remark.empty()) text += ", " + report.remark;
    if (report.results.factor_of_safety)
        text += ", " + factor_in_words(report.reduced_alone, *report.results.factor_of_safety,
                                       report.results.undoubted_factor, 6);
    if (summary.results.estimated_error)
        text += fmt::format(", estimated error {:.2g} %", 100.0 * *summary.results.estimated_error);
    const std::string work = report.motion ? fmt::format("{} time steps", report.motion->time_steps)
                                           : fmt::format("{} solves", summary.costs.open_close_iterations);
    text += fmt::format(", {} tension and {} shear cracks, {}, {:.1f} s; results in {}", summary.numbers.cracks_tension,
                        summary.numbers.cracks_shear, work, summary.costs.elapsed_s, directory.string());
    if (summary.numbers.unbalanced_steps > 0)
        text += fmt::format("; {} steps unbalanced", summary.numbers.unbalanced_steps);
    return text;
}

} // namespace kluft
