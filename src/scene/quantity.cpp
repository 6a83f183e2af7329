#include "kluft/scene/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/nearest_name.hpp"

namespace kluft {

namespace {

constexpr const char* too_large = ", which is beyond the range of a number";
constexpr const char* too_small = ", whose products are below the range of a number";
constexpr double smallest = 1e-100; // but for zero: its square, divided by a number of this kind, is one still

/// Powers of metre, kilogram, second and radian.
using Dimension = std::array<int, 4>;

/// value in SI = value * 10^exponent * factor.
struct UnitRow {
    std::string_view symbol;
    int exponent = 0;
    Dimension dimension{};
    double factor = 1.0;
};

constexpr Dimension none{};
constexpr Dimension metre{1, 0, 0, 0};
constexpr Dimension kilogram{0, 1, 0, 0};
constexpr Dimension second{0, 0, 1, 0};
constexpr Dimension newton{1, 1, -2, 0};
constexpr Dimension pascal{-1, 1, -2, 0};
constexpr Dimension radian{0, 0, 0, 1};

constexpr double degree = std::numbers::pi / 180.0;

constexpr std::array units{
    UnitRow{"m", 0, metre},
    UnitRow{"cm", -2, metre},
    UnitRow{"mm", -3, metre},
    UnitRow{"um", -6, metre},
    UnitRow{"km", 3, metre},
    UnitRow{"kg", 0, kilogram},
    UnitRow{"g", -3, kilogram},
    UnitRow{"t", 3, kilogram},
    UnitRow{"s", 0, second},
    UnitRow{"ms", -3, second},
    UnitRow{"N", 0, newton},
    UnitRow{"kN", 3, newton},
    UnitRow{"MN", 6, newton},
    UnitRow{"GN", 9, newton},
    UnitRow{"Pa", 0, pascal},
    UnitRow{"hPa", 2, pascal},
    UnitRow{"kPa", 3, pascal},
    UnitRow{"MPa", 6, pascal},
    UnitRow{"GPa", 9, pascal},
    UnitRow{"TPa", 12, pascal},
    UnitRow{"bar", 5, pascal},
    UnitRow{"rad", 0, radian},
    UnitRow{"deg", 0, radian, degree},
    UnitRow{"°", 0, radian, degree},
    UnitRow{"%", -2, none},
    UnitRow{"‰", -3, none},
};

Dimension dimension_of(Measure measure) {
    switch (measure) {
    case Measure::fraction:
        return none;
    case Measure::length:
        return metre;
    case Measure::stress:
        return pascal;
    case Measure::stiffness:
        return {-2, 1, -2, 0};
    case Measure::density:
        return {-3, 1, 0, 0};
    case Measure::velocity:
        return {1, 0, -1, 0};
    case Measure::acceleration:
        return {1, 0, -2, 0};
    case Measure::line_force:
        return {0, 1, -2, 0};
    case Measure::time:
        return second;
    case Measure::angle:
        return radian;
    }
    return none;
}

/// "Pa", or "m2 kg" for what no key measures.
std::string dimension_name(const Dimension& dimension) {
    if (dimension == none) return "no unit but a plain number";
    for (const Measure measure :
         {Measure::length, Measure::stress, Measure::stiffness, Measure::density, Measure::velocity,
          Measure::acceleration, Measure::line_force, Measure::time, Measure::angle})
        if (dimension_of(measure) == dimension) return std::string(unit_name(measure));
    constexpr std::array<std::string_view, 4> symbols{"m", "kg", "s", "rad"};
    std::string name;
    for (std::size_t i = 0; i < symbols.size(); ++i) {
        if (dimension[i] == 0) continue;
        if (!name.empty()) name += ' ';
        name += symbols[i];
        if (dimension[i] != 1) name += std::to_string(dimension[i]);
    }
    return name;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t digits_from(std::string_view text, std::size_t from) {
    while (from < text.size() && is_digit(text[from])) ++from;
    return from;
}

/// Length of the decimal number at the start of `text`; 0 if there is none or if it has a leading zero.
std::size_t number_length(std::string_view text) {
    const std::size_t start = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    std::size_t end = digits_from(text, start);
    const std::size_t n_whole = end - start;
    if (n_whole > 1 && text[start] == '0') return 0;
    std::size_t n_fraction = 0;
    if (end < text.size() && text[end] == '.') {
        const std::size_t after = digits_from(text, end + 1);
        n_fraction = after - end - 1;
        end = after;
    }
    if (n_whole + n_fraction == 0) return 0;
    if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
        std::size_t exponent = end + 1;
        if (exponent < text.size() && (text[exponent] == '-' || text[exponent] == '+')) ++exponent;
        const std::size_t after = digits_from(text, exponent);
        if (after > exponent) end = after;
    }
    return end;
}

struct UnitReading {
    int exponent = 0;
    double factor = 1.0;
    Dimension dimension{};
    std::string problem;
};

bool is_separator(char c) { return c == ' ' || c == '*' || c == '/'; }
bool ends_symbol(char c) { return is_separator(c) || is_digit(c) || c == '^' || c == '-' || c == '+'; }

const UnitRow* find_unit(std::string_view symbol) {
    const auto* row = std::find_if(units.begin(), units.end(), [&](const UnitRow& r) { return r.symbol == symbol; });
    return row == units.end() ? nullptr : row;
}

std::string unknown_unit(std::string_view symbol) {
    std::vector<std::string> symbols;
    for (const auto& row : units) symbols.emplace_back(row.symbol);
    return fmt::format(" with the unknown unit '{}'{}", symbol, suggestion(symbol, symbols));
}

void multiply(UnitReading& reading, const UnitRow& row, int power) {
    reading.exponent += power * row.exponent;
    reading.factor *= std::pow(row.factor, power);
    for (std::size_t i = 0; i < row.dimension.size(); ++i) reading.dimension[i] += power * row.dimension[i];
}

/// number * 10^exponent, rounded once: 1.3 % is the same double as 0.013.
std::optional<double> scaled_number(std::string_view number, int exponent) {
    const std::size_t e = number.find_first_of("eE");
    if (e != std::string_view::npos) {
        const char* start = number.data() + e + (number[e + 1] == '+' ? 2 : 1);
        int own = 0;
        if (std::from_chars(start, number.data() + number.size(), own).ec != std::errc{}) return std::nullopt;
        exponent += std::clamp(own, -10'000, 10'000);
    }
    return read_number(fmt::format("{}e{}", number.substr(0, e), exponent));
}

/// Power behind a symbol (3, ^3, -2), 1 if none; moves `at` behind it. 0 for what is no power.
int read_power(std::string_view text, std::size_t& at) {
    if (at >= text.size() || is_separator(text[at])) return 1;
    if (text[at] == '^') ++at;
    const bool negative = at < text.size() && text[at] == '-';
    if (negative) ++at;
    if (at >= text.size() || !is_digit(text[at]) || text[at] == '0') return 0;
    const int power = text[at] - '0';
    ++at;
    if (at < text.size() && !is_separator(text[at])) return 0;
    return negative ? -power : power;
}

UnitReading read_unit(std::string_view text) {
    UnitReading reading;
    std::size_t at = 0;
    bool divide = false;
    bool symbol_due = true;
    while (at < text.size()) {
        if (is_separator(text[at])) {
            if (text[at] != ' ') {
                if (symbol_due) reading.problem = fmt::format(" with the unknown unit '{}'", text);
                divide = text[at] == '/';
                symbol_due = true;
            }
            ++at;
            if (!reading.problem.empty()) return reading;
            continue;
        }
        const std::size_t start = at;
        while (at < text.size() && !ends_symbol(text[at])) ++at;
        const std::string_view symbol = text.substr(start, at - start);
        const UnitRow* row = find_unit(symbol);
        const int power = read_power(text, at);
        if (row == nullptr || power == 0) {
            reading.problem = unknown_unit(row == nullptr && !symbol.empty() ? symbol : text);
            return reading;
        }
        multiply(reading, *row, divide ? -power : power);
        divide = false;
        symbol_due = false;
    }
    if (symbol_due) reading.problem = fmt::format(" with the unknown unit '{}'", text);
    return reading;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

} // namespace

std::string_view unit_name(Measure measure) {
    switch (measure) {
    case Measure::fraction:
        return "";
    case Measure::length:
        return "m";
    case Measure::stress:
        return "Pa";
    case Measure::stiffness:
        return "Pa/m";
    case Measure::density:
        return "kg/m3";
    case Measure::velocity:
        return "m/s";
    case Measure::acceleration:
        return "m/s2";
    case Measure::line_force:
        return "N/m";
    case Measure::time:
        return "s";
    case Measure::angle:
        return "deg";
    }
    return "";
}

std::optional<double> read_number(std::string_view text) {
    if (text.empty() || number_length(text) != text.size()) return std::nullopt;
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0.0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<long long> read_integer(std::string_view text) {
    if (text.find_first_not_of("+-0123456789") != std::string_view::npos) return std::nullopt;
    if (number_length(text) != text.size() || text.empty()) return std::nullopt;
    if (text.front() == '+') text.remove_prefix(1);
    long long value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    constexpr long long limit = 1LL << 53;
    if (result.ec != std::errc{} || value > limit || value < -limit) return std::nullopt;
    return value;
}

double to_si(double plain, Measure measure) { return measure == Measure::angle ? plain * degree : plain; }

namespace {

QuantityReading checked(double value) {
    if (value != 0.0 && std::abs(value) < smallest) return {std::nullopt, too_small};
    return {value, {}};
}

} // namespace

QuantityReading read_quantity(std::string_view text, Measure measure) {
    text = trimmed(text);
    const std::size_t length = number_length(text);
    const std::string flaw = number_flaw(text);
    if (length == 0 || !flaw.empty()) return {std::nullopt, flaw};
    const auto number = read_number(text.substr(0, length));
    if (!number) return {std::nullopt, too_large};
    const std::string_view unit_text = trimmed(text.substr(length));
    if (unit_text.empty()) return checked(to_si(*number, measure));
    const UnitReading unit = read_unit(unit_text);
    if (!unit.problem.empty()) return {std::nullopt, unit.problem};
    if (unit.dimension != dimension_of(measure))
        return {std::nullopt, fmt::format(", which is in {}", dimension_name(unit.dimension))};
    const auto value = scaled_number(text.substr(0, length), unit.exponent);
    if (!value || !std::isfinite(*value * unit.factor)) return {std::nullopt, too_large};
    return checked(*value * unit.factor);
}

std::string number_flaw(std::string_view text) {
    std::string lower;
    for (const char c : text)
        if (c != '+' && c != '-' && c != '.') lower += static_cast<char>(c | 0x20);
    if (lower == "nan" || lower == "inf" || lower == "infinity") return ", which is not finite";
    const std::size_t first = text.find_first_not_of("+-");
    if (first == std::string_view::npos || first + 1 >= text.size()) return {};
    if (text[first] == '0' && is_digit(text[first + 1])) return ", which has a leading zero";
    if (text[first] == '0' && (text[first + 1] | 0x20) == 'x') return ", which is not decimal";
    const std::size_t end = digits_from(text, first);
    if (end > first && end < text.size() && text[end] == '_') return ", which has digit groups";
    if (end > first && end + 1 < text.size() && text[end] == ',' && is_digit(text[end + 1]))
        return ", which has a comma; decimals have a point, and digits no groups";
    return {};
}

std::string known_units() {
    std::vector<std::string> symbols;
    for (const auto& row : units) symbols.emplace_back(row.symbol);
    return listed(symbols);
}

} // namespace kluft
