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

std::vector<std::string> messages_of(const std::vector<InputProblem>& problems) {
    std::vector<std::string> messages;
    for (const InputProblem& problem : problems) messages.push_back(problem.message);
    return messages;
}

} // namespace

InputError::InputError(const std::string& message) : InputError(std::vector<std::string>{message}) {}

InputError::InputError(std::vector<std::string> messages)
    : std::runtime_error(joined(messages)), messages_(std::move(messages)) {
    for (const std::string& message : messages_) problems_.push_back({.message = message});
}

InputError::InputError(std::vector<InputProblem> problems)
    : std::runtime_error(joined(messages_of(problems))), messages_(messages_of(problems)),
      problems_(std::move(problems)) {}

} // namespace kluft
