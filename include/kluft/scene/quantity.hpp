// Numbers as scenes write them: plain in SI (angles in degrees), or with a unit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kluft {

/// What a number of a scene measures.
enum class Measure { fraction, length, stress, stiffness, density, velocity, acceleration, line_force, time, angle };

/// The unit of a plain number: "", "m", "Pa", "Pa/m", "kg/m3", "m/s", "m/s2",
/// "N/m" (a force per metre of thickness), "s", "deg".
[[nodiscard]] std::string_view unit_name(Measure measure);

/// A decimal number, all of `text`: 25, -0.5, .5, 1e-3. Nothing for 012, 0x1f, 1_000, nan, inf and what a double cannot
/// hold.
[[nodiscard]] std::optional<double> read_number(std::string_view text);

/// A decimal integer without leading zeros, within +-2^53.
[[nodiscard]] std::optional<long long> read_integer(std::string_view text);

/// Why a text is no number where that is known (".nan", "012", "0x1f", "1_000"), made to follow "found ..."; else "".
[[nodiscard]] std::string number_flaw(std::string_view text);

struct QuantityReading {
    std::optional<double> value; ///< SI, angles in radians
    std::string problem;         ///< without a value: what is wrong, made to follow "found ..."; may be empty
};

/// A number with or without a unit: "25 MPa", "200 MPa/m", "2650 kg/m3", "1.3 %", "30 deg", 9.81. Units combine with
/// '/', '*' and blanks and take powers (m3, m^3, s-2). A number without a unit is in SI, an angle in degrees.
[[nodiscard]] QuantityReading read_quantity(std::string_view text, Measure measure);

/// A plain number of the measure in SI: degrees become radians, the rest is unchanged.
[[nodiscard]] double to_si(double plain, Measure measure);

/// Every unit that is understood, for the documentation.
[[nodiscard]] std::string known_units();

} // namespace kluft
