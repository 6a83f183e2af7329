#include "kluft/core/nearest_name.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace kluft {

namespace {

constexpr std::size_t longest_name = 64; ///< of a word worth comparing; the distance costs length times length

constexpr std::size_t most_listed = 8; ///< names in a message

char folded(char c) {
    if (c == '-' || c == ' ') return '_';
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool begins_with(std::string_view word, std::string_view beginning) {
    return word.size() > beginning.size() && std::equal(beginning.begin(), beginning.end(), word.begin(),
                                                        [](char a, char b) { return folded(a) == folded(b); });
}

} // namespace

int edit_distance(std::string_view a, std::string_view b) {
    const std::size_t n_columns = b.size() + 1;
    std::vector<int> before_last(n_columns), last(n_columns), current(n_columns);
    for (std::size_t j = 0; j < n_columns; ++j) last[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = static_cast<int>(i);
        for (std::size_t j = 1; j < n_columns; ++j) {
            const bool same = folded(a[i - 1]) == folded(b[j - 1]);
            current[j] = std::min({last[j] + 1, current[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) && folded(a[i - 2]) == folded(b[j - 1]);
            if (swapped) current[j] = std::min(current[j], before_last[j - 2] + 1);
        }
        std::swap(before_last, last);
        std::swap(last, current);
    }
    return last[b.size()];
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
    if (name.empty() || name.size() > longest_name) return {};
    const int limit = name.size() == 1 ? 0 : std::max(1, static_cast<int>(name.size() + 1) / 3);
    std::string nearest;
    int smallest = limit + 1;
    for (const auto& candidate : candidates) {
        if (candidate.size() > longest_name) continue;
        const int distance = edit_distance(name, candidate);
        if (distance < smallest) {
            smallest = distance;
            nearest = candidate;
        }
    }
    if (!nearest.empty() || name.size() < 3) return nearest;
    const auto longer = std::find_if(candidates.begin(), candidates.end(),
                                     [&](const std::string& candidate) { return begins_with(candidate, name); });
    return longer == candidates.end() ? std::string{} : *longer;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
    const std::string nearest = nearest_name(name, candidates);
    return nearest.empty() ? std::string{} : fmt::format("; did you mean '{}'?", nearest);
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names) {
        if (!text.empty()) text += ", ";
        text += name;
    }
    return text.empty() ? "none" : text;
}

std::string listed_near(std::string_view name, const std::vector<std::string>& names) {
    std::vector<std::string> each;
    std::set<std::string_view> seen;
    for (const std::string& one : names)
        if (seen.insert(one).second) each.push_back(one);
    if (each.size() <= most_listed) return listed(each);
    const std::size_t n_others = each.size() - most_listed;
    std::vector<std::pair<int, std::string>> by_distance;
    for (std::string& one : each) {
        const bool comparable = name.size() <= longest_name && one.size() <= longest_name;
        const int distance = comparable ? edit_distance(name, one) : std::numeric_limits<int>::max();
        by_distance.emplace_back(distance, std::move(one));
    }
    std::ranges::stable_sort(by_distance, {}, &std::pair<int, std::string>::first);
    std::vector<std::string> nearest;
    for (std::size_t i = 0; i < most_listed; ++i) nearest.push_back(std::move(by_distance[i].second));
    return fmt::format("{} and {} {}", listed(nearest), n_others, n_others == 1 ? "other" : "others");
}

} // namespace kluft
