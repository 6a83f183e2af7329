#include "kluft/core/input_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace {

constexpr std::size_t piece = 1U << 16U; ///< bytes read at once

/// A file opened for reading, without waiting for a writer where it is a pipe.
class InputFile {
public:
    InputFile(const std::filesystem::path& file, std::string_view what)
        : expected_(file.string() + ": expected " + std::string(what)),
          number_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
        if (number_ < 0) fail(errno == ENOENT ? "no such file" : reason());
    }
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile() {
        if (number_ >= 0) ::close(number_);
    }

    [[nodiscard]] std::string content(std::size_t largest, std::string_view hint) const {
        const std::size_t size = size_of_regular_file();
        if (size > largest) fail_by_size(largest, hint);
        std::string text;
        text.reserve(size + 1);
        for (std::size_t end = 0;; end = text.size()) {
            text.resize(end + piece);
            const std::size_t n_read = read(text.data() + end, piece);
            text.resize(end + n_read);
            if (text.size() > largest) fail_by_size(largest, hint);
            if (n_read == 0) return text;
        }
    }

private:
    [[noreturn]] void fail_expected(const std::string& further, const std::string& found) const {
        throw InputError(expected_ + further + ", found " + found);
    }
    [[noreturn]] void fail(const std::string& found) const { fail_expected({}, found); }
    [[noreturn]] void fail_by_size(std::size_t largest, std::string_view hint) const {
        fail_expected(" of at most " + std::to_string(largest / 1'000'000) + " MB", "more" + std::string(hint));
    }
    static std::string reason() {
        return "a file that cannot be read (" + std::generic_category().message(errno) + ")";
    }

    [[nodiscard]] std::size_t size_of_regular_file() const {
        struct stat status {};
        if (::fstat(number_, &status) != 0) fail(reason());
        if (S_ISDIR(status.st_mode)) fail("a directory");
        if (!S_ISREG(status.st_mode)) fail("no regular file");
        return static_cast<std::size_t>(status.st_size);
    }

    std::size_t read(char* to, std::size_t most) const {
        for (;;) {
            const ssize_t n_read = ::read(number_, to, most);
            if (n_read >= 0) return static_cast<std::size_t>(n_read);
            if (errno != EINTR) fail(reason());
        }
    }

    std::string expected_;
    int number_;
};

} // namespace

std::string read_input_file(const std::filesystem::path& file, std::string_view what, std::size_t largest,
                            std::string_view hint) {
    return InputFile(file, what).content(largest, hint);
}

} // namespace kluft
