#include "kluft/output/force_tables.hpp"

#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "kluft/output/csv_text.hpp"

namespace kluft {

namespace {

std::string_view word_of(MeetingState state) {
    switch (state) {
    case MeetingState::bonded:
        return "bonded";
    case MeetingState::locked:
        return "locked";
    case MeetingState::sliding:
        return "sliding";
    case MeetingState::open:
        return "open";
    }
    return "";
}

std::string_view word_of(SupportKind kind) {
    switch (kind) {
    case SupportKind::weight:
        return "weight";
    case SupportKind::pressure:
        return "pressure";
    case SupportKind::force:
        return "force";
    case SupportKind::platen:
        return "platen";
    case SupportKind::support:
        return "support";
    case SupportKind::fixed:
        return "fixed";
    }
    return "";
}

std::vector<std::string> as_cells(const std::vector<std::string>& names) {
    std::vector<std::string> cells;
    for (const std::string& name : names) cells.push_back(csv_text(name));
    return cells;
}

/// Of a cell: empty beyond the list.
std::string_view name_at(const std::vector<std::string>& names, int i) {
    return i >= 0 && i < static_cast<int>(names.size()) ? std::string_view(names[i]) : std::string_view();
}

} // namespace

void put_contacts_csv(const BlockSystem& system, const std::vector<ContactForce>& contacts,
                      const std::vector<std::string>& law_names, const Put& put) {
    constexpr std::size_t part = 1'000'000; // bytes
    const std::vector<std::string> names = as_cells(law_names);
    std::string text =
        "block_a,block_b,x,y,length,normal_x,normal_y,normal_traction,shear_traction,state,law,x_b,y_b\n";
    for (const ContactForce& each : contacts) {
        const Vec2 a = system.origin + each.place_a;
        const Vec2 b = system.origin + each.place_b;
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{},{}\n", each.block_a, each.block_b,
                       a.x(), a.y(), each.length, each.normal.x(), each.normal.y(), 0.0 - each.normal_traction,
                       each.shear_traction, word_of(each.state), name_at(names, each.law), b.x(), b.y());
        if (text.size() < part) continue;
        put(text);
        text.clear();
    }
    put(text);
}

std::string supports_csv(const BlockSystem& system, const std::vector<SupportForce>& supports) {
    std::vector<std::string> names;
    for (const Boundary& boundary : system.boundaries) names.push_back(csv_text(boundary.name));
    std::string text = "block,boundary,fx,fy,x,y,kind\n";
    for (const SupportForce& each : supports) {
        const Vec2 at = system.origin + each.place;
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", each.block, name_at(names, each.boundary),
                       each.force.x(), each.force.y(), at.x(), at.y(), word_of(each.kind));
    }
    return text;
}

} // namespace kluft
