// The nearest valid name to a mistyped one, for error messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kluft {

/// Insertions, deletions, substitutions and swaps of neighbouring characters that turn one word into the other
/// (optimal string alignment). Case and the difference of '-', ' ' and '_' do not count.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);

/// The candidate that is most likely meant by `name`: the one of smallest edit distance if that is at most a third of
/// the name's length (1 for two or three characters, 0 for one), else the first that begins with it, else nothing ("").
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "; did you mean 'density'?", or "" where nothing is near. Made to be appended to an error message.
[[nodiscard]] std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

/// "a, b, c", or "none" for an empty list.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// The same, each name once, with of more than eight the eight nearest to `name`, nearest first: "a, b, c, d, e, f, g, h and
/// 31 others".
[[nodiscard]] std::string listed_near(std::string_view name, const std::vector<std::string>& names);

} // namespace kluft
