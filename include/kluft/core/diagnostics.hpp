// The errors that leave the library, one type for each way a run can end badly.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace kluft {

/// Bad input (exit code 2). Each message is complete in itself: place, key, expected, found, nearest valid key.
class InputError : public std::runtime_error {
public:
    explicit InputError(const std::string& message);
    explicit InputError(std::vector<std::string> messages);

    [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

private:
    std::vector<std::string> messages_;
};

/// No equilibrium was found (exit code 3); the text names the blocks and interfaces concerned.
class NoEquilibriumError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Out of disk or memory (exit code 4).
class ResourceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace kluft
