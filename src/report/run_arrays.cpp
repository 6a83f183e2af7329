#include "run_arrays.hpp"

#include "kluft/output/block_outline.hpp"

namespace kluft {

namespace {

void add_blocks(const BlockSystem& system, PackedArrays& arrays) {
    std::vector<double> x, y;
    std::vector<int> first{0}, loops{0}, loop_block, material, outline;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        for (const auto& [begin, end] : loop_ranges(block)) {
            for (int edge = begin; edge < end; ++edge)
                if (block.edges[edge].interface < 0)
                    outline.insert(outline.end(), {first.back() + edge, first.back() + next_edge(block, edge)});
            loop_block.push_back(b);
            loops.push_back(first.back() + end);
        }
        for (const Edge& edge : block.edges) {
            x.push_back(edge_start(system, edge).x());
            y.push_back(edge_start(system, edge).y());
        }
        first.push_back(first.back() + static_cast<int>(block.edges.size()));
        material.push_back(block.material);
    }
    arrays.add_floats("x", x);
    arrays.add_floats("y", y);
    arrays.add_integers("first", first);
    arrays.add_integers("loops", loops);
    arrays.add_integers("loop_block", loop_block);
    arrays.add_integers("material", material);
    arrays.add_integers("outline", outline);
}

void add_interfaces(const BlockSystem& system, PackedArrays& arrays) {
    const auto first = first_vertices(system);
    std::vector<int> block_a, block_b, vertex_i, vertex_j, type, fracture;
    for (const Interface& interface : system.interfaces) {
        const Block& block = system.blocks[interface.block_a];
        const auto start = static_cast<int>(first[interface.block_a]);
        block_a.push_back(interface.block_a);
        block_b.push_back(interface.block_b);
        vertex_i.push_back(start + interface.edge_a);
        vertex_j.push_back(start + next_edge(block, interface.edge_a));
        type.push_back(interface.interface_type);
        fracture.push_back(interface.fracture);
    }
    arrays.add_integers("block_a", block_a);
    arrays.add_integers("block_b", block_b);
    arrays.add_integers("vertex_i", vertex_i);
    arrays.add_integers("vertex_j", vertex_j);
    arrays.add_integers("type", type);
    arrays.add_integers("fracture", fracture);
}

std::uint8_t flags_of(const FieldRecord::InterfaceFields& fields) {
    const unsigned motion = fields.state == ContactState::open ? 0U : fields.state == ContactState::sliding ? 1U : 2U;
    const unsigned failed = !fields.broken ? 0U : fields.mode == CrackMode::tension ? 8U : 16U;
    return static_cast<std::uint8_t>(motion + (fields.bonded ? 4U : 0U) + failed);
}

} // namespace

PackedArrays shape_arrays(const BlockSystem& system) {
    PackedArrays arrays;
    add_blocks(system, arrays);
    add_interfaces(system, arrays);
    return arrays;
}

PackedArrays state_arrays(const BlockSystem& system, const FieldRecord& fields) {
    std::vector<double> ux, uy, xx, yy, xy, normal, shear, gap, slip;
    std::vector<std::uint8_t> flags;
    for (const Vec2& u : fields.displacement) {
        ux.push_back(u.x());
        uy.push_back(u.y());
    }
    for (const Mat2& stress : fields.stress) {
        xx.push_back(-stress(0, 0));
        yy.push_back(-stress(1, 1));
        xy.push_back(-0.5 * (stress(0, 1) + stress(1, 0)));
    }
    for (int i = 0; i < system.n_interfaces(); ++i) {
        const FieldRecord::InterfaceFields& each = fields.interfaces[i];
        flags.push_back(flags_of(each));
        normal.push_back(-each.normal_traction);
        shear.push_back(each.shear_traction);
        gap.push_back(each.gap);
        slip.push_back(each.slip);
    }
    PackedArrays arrays;
    arrays.add_even("ux", ux);
    arrays.add_even("uy", uy);
    arrays.add_halves("xx", xx);
    arrays.add_halves("yy", yy);
    arrays.add_halves("xy", xy);
    arrays.add_bytes("flags", flags);
    arrays.add_halves("normal_traction", normal);
    arrays.add_halves("shear_traction", shear);
    arrays.add_halves("gap", gap);
    arrays.add_halves("slip", slip);
    return arrays;
}

std::size_t bytes_of_state(const BlockSystem& system) {
    constexpr std::size_t per_vertex = 4, per_block = 6, per_interface = 9;
    return per_vertex * first_vertices(system).back() + per_block * system.blocks.size() +
           per_interface * system.interfaces.size();
}

} // namespace kluft
