#include "kluft/simulation/fingerprint.hpp"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

namespace kluft {

namespace {

/// FNV-1a (Fowler, Noll and Vo) over the bytes of plain values.
class Digest {
public:
    template <typename... Values> void add(Values... values) { (add_one(values), ...); }
    [[nodiscard]] std::string text() const { return fmt::format("{:016x}", value_); }

private:
    template <typename Value> void add_one(Value value) {
        static_assert(std::is_arithmetic_v<Value>);
        unsigned char bytes[sizeof(Value)];
        std::memcpy(bytes, &value, sizeof(Value));
        for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 1099511628211ULL;
    }
    std::uint64_t value_ = 14695981039346656037ULL;
};

void add_body(const Model& model, Digest& digest) {
    digest.add(model.gravity.x(), model.gravity.y(), model.system.spacing);
    for (const Support support : model.loads.supports) digest.add(static_cast<int>(support));
    if (model.kinematics == Kinematics::rigid) digest.add(static_cast<int>(model.kinematics));
    for (const Vec2& vertex : model.system.vertices) digest.add(vertex.x(), vertex.y());
    for (int b = 0; b < model.system.n_blocks(); ++b)
        if (model.system.blocks[b].fixed) digest.add(b);
    if (model.system.outline_type >= 0) digest.add(model.system.outline_type);
    for (const Interface& i : model.system.interfaces)
        digest.add(i.block_a, i.edge_a, i.block_b, i.edge_b, i.interface_type, law_of(i));
}

void add_mechanics(const Model& model, Digest& digest) {
    for (const ElasticModuli& moduli : model.moduli) digest.add(moduli.lambda, moduli.mu);
    for (const double density : model.densities) digest.add(density);
    for (const InterfaceLaw& law : model.laws) {
        digest.add(law.normal_stiffness, law.shear_stiffness, law.tan_friction, law.cohesion, law.tan_dilation,
                   law.cohesion_onset, law.contact_rounding, law.friction_rounding, law.overlap_points);
    }
    for (const Strength& strength : model.strengths) {
        digest.add(strength.cohesion, strength.friction_angle, strength.tensile_strength);
    }
    for (const auto& [block, xi] : model.force_points) digest.add(block, xi.x(), xi.y());
}

void add_stage(const Stage& stage, Digest& digest) {
    digest.add(stage.steps, stage.platen_friction);
    for (const auto& [boundary, pressure] : stage.pressure) digest.add(boundary, pressure);
    if (stage.gravity) digest.add(stage.gravity->x(), stage.gravity->y());
    for (const auto& [i, force] : stage.forces) digest.add(i, force.x(), force.y());
    if (stage.motion)
        digest.add(static_cast<int>(stage.motion->control), stage.motion->boundary, stage.motion->value,
                   static_cast<int>(stage.motion->glued));
    if (stage.motion && stage.motion->against) digest.add(*stage.motion->against);
    if (!stage.strength_reduction) return;
    const StrengthReduction& reduction = *stage.strength_reduction;
    digest.add(reduction.from, reduction.to, reduction.tolerance);
    for (const int type : reduction.interface_types) digest.add(type);
}

} // namespace

std::string fingerprint(const Model& model) {
    Digest digest;
    add_body(model, digest);
    add_mechanics(model, digest);
    for (const Stage& stage : model.loads.stages) add_stage(stage, digest);
    return digest.text();
}

} // namespace kluft
