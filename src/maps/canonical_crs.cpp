#include <algorithm>
#include <cctype>

#include "kluft/maps/coordinate_system.hpp"

namespace kluft {

namespace {

std::string in_capitals(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

} // namespace

std::string canonical_crs(const std::string& text) {
    const std::string capitals = in_capitals(text);
    constexpr std::string_view urn = "URN:OGC:DEF:CRS:";
    std::string authority_and_code = capitals;
    if (capitals.starts_with(urn)) { // urn:ogc:def:crs:AUTHORITY:VERSION:CODE
        const std::string rest = capitals.substr(urn.size());
        const auto first = rest.find(':');
        const auto last = rest.rfind(':');
        if (first == std::string::npos || last == first) return text;
        authority_and_code = rest.substr(0, first) + rest.substr(last);
    }
    const bool is_code = std::ranges::count(authority_and_code, ':') == 1 &&
                         std::ranges::all_of(authority_and_code, [](unsigned char c) {
                             return std::isalnum(c) != 0 || c == ':' || c == '_' || c == '.';
                         });
    return is_code ? authority_and_code : text;
}

} // namespace kluft
