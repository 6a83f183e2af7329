// The errors that leave the library, one type for each way a run can end badly.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace kluft {

/// One thing that is wrong with an input, for programs that show it in their own way.
struct InputProblem {
    std::string message; ///< complete in itself: place, key, expected, found, nearest valid key
    std::string what;    ///< the same without place and key; empty where they are not known apart
    std::string path;    ///< of the key, "materials.rock.cohesion"; empty where it is of none
    std::string file;    ///< that says it; empty where no file does
    int line = 0;        ///< of the file, from 1; 0 without one
    int column = 0;
};

/// Bad input (exit code 2). Each message is complete in itself: place, key, expected, found, nearest valid key.
class InputError : public std::runtime_error {
public:
    explicit InputError(const std::string& message);
    explicit InputError(std::vector<std::string> messages);
    explicit InputError(std::vector<InputProblem> problems);

    [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }
    /// One for each message.
    [[nodiscard]] const std::vector<InputProblem>& problems() const { return problems_; }

private:
    std::vector<std::string> messages_;
    std::vector<InputProblem> problems_;
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
