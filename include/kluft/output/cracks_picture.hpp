// Cracks of several runs in one picture of the body before loading.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/output/canvas.hpp"

namespace kluft {

/// A crack as a line, or as a dot where both ends are at one place. Scene coordinates (m).
struct DrawnCrack {
    Vec2 start = Vec2::Zero();
    Vec2 end = Vec2::Zero();
    double side = 0.0; ///< -1, 0 or 1: beside the line or on it, so that cracks of two runs at one place are both seen
};

/// Cracks of one colour.
struct CrackGroup {
    std::string label; ///< in the legend
    std::string note;  ///< below it in small print; may be empty
    Colour colour;
    std::vector<DrawnCrack> cracks;
};

struct CracksPlot {
    std::string title;
    std::string heading;            ///< above the body
    std::vector<CrackGroup> groups; ///< drawn one after the other
    std::vector<std::string> notes; ///< below the legend
};

/// The body's blocks and mapped fractures lightly, the cracks on top. Throws InputError for an SVG of too many blocks.
[[nodiscard]] std::string draw_cracks(const BlockSystem& system, const CracksPlot& plot, PictureFormat format);

/// The same, written in the format that the extension names. Throws InputError, ResourceError.
void write_cracks(const std::filesystem::path& path, const BlockSystem& system, const CracksPlot& plot);

} // namespace kluft
