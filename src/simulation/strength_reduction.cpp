#include "kluft/simulation/strength_reduction.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

bool is_reduced(const StrengthReduction& reduction, int interface_type) {
    const auto& types = reduction.interface_types;
    return types.empty() || std::ranges::find(types, interface_type) != types.end();
}

/// Whether an interface of the body, or what it fails to, keeps its strength.
bool leaves_some(const StrengthReduction& reduction, const Model& model) {
    return std::ranges::any_of(model.system.interfaces, [&](const Interface& interface) {
        const auto broken = static_cast<std::size_t>(model.fracture_law[interface.interface_type]);
        return !is_reduced(reduction, interface.interface_type) || !is_reduced(reduction, model.law_types[broken]);
    });
}

} // namespace

const StrengthReduction* reduction_of(const LoadProgram& loads, int stage) {
    for (int i = stage; i < static_cast<int>(loads.stages.size()); ++i) {
        if (loads.stages[i].strength_reduction) return &*loads.stages[i].strength_reduction;
    }
    return nullptr;
}

double strength_factor(const LoadProgram& loads, int stage, double load_factor) {
    const StrengthReduction* const reduction = reduction_of(loads, stage);
    if (reduction == nullptr) return 1.0;
    return loads.stages[stage].strength_reduction ? reduction->factor_at(load_factor) : reduction->from;
}

std::vector<std::string> reduced_alone(const Model& model, int stage) {
    const StrengthReduction* const reduction = reduction_of(model.loads, stage);
    if (reduction == nullptr || !leaves_some(*reduction, model)) return {};
    return reduction->names;
}

std::vector<InterfaceLaw> reduced_laws(const Model& model, int stage, double factor) {
    std::vector<InterfaceLaw> laws = model.laws;
    if (factor == 1.0) return laws;
    const StrengthReduction& reduction = *reduction_of(model.loads, stage);
    for (int t = 0; t < static_cast<int>(laws.size()); ++t) {
        if (!is_reduced(reduction, model.law_types[t])) continue;
        InterfaceLaw& law = laws[t];
        law.tan_friction /= factor;
        law.cohesion /= factor;
        law.tan_dilation = std::min(law.tan_dilation, law.tan_friction);
    }
    return laws;
}

std::vector<Strength> reduced_strengths(const Model& model, int stage, double factor) {
    std::vector<Strength> strengths = model.strengths;
    if (factor == 1.0) return strengths;
    const StrengthReduction& reduction = *reduction_of(model.loads, stage);
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        if (!is_reduced(reduction, model.system.interfaces[i].interface_type)) continue;
        Strength& strength = strengths[i];
        strength.cohesion /= factor;
        strength.friction_angle = std::atan(std::tan(strength.friction_angle) / factor);
    }
    return strengths;
}

} // namespace kluft
