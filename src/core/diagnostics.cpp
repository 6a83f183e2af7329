#include "kluft/core/diagnostics.hpp"

#include <utility>

namespace kluft {

namespace {

std::string joined(const std::vector<std::string>& messages) {
    std::string text;
    for (const auto& message : messages) {
        if (!text.empty()) text += '\n';
        text += message;
    }
    return text;
}

} // namespace

InputError::InputError(const std::string& message) : InputError(std::vector<std::string>{message}) {}

InputError::InputError(std::vector<std::string> messages)
    : std::runtime_error(joined(messages)), messages_(std::move(messages)) {}

} // namespace kluft
