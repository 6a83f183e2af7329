#include "failure.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

/// Names of files may hold what moves the cursor or colours the terminal.
void tell_line(const char* message) noexcept {
    for (const char* c = message; *c != '\0'; ++c) {
        const bool is_control = (static_cast<unsigned char>(*c) < 0x20 && *c != '\n' && *c != '\t') || *c == 0x7F;
        std::fputc(is_control ? '?' : *c, stderr);
    }
    std::fputc('\n', stderr);
}

ExitCode told(const char* message, ExitCode code) noexcept {
    tell_line(message);
    return code;
}

bool is_shortage(const std::error_code& error) {
    const auto shortages = {std::errc::no_space_on_device, std::errc::not_enough_memory, std::errc::io_error,
                            std::errc::too_many_files_open, std::errc::too_many_files_open_in_system};
    return std::ranges::any_of(shortages, [&](std::errc shortage) { return error == shortage; });
}

/// Of a mistake that is made many times (a range whose values are all refused) the first ones are enough.
ExitCode told(const InputError& error) noexcept {
    constexpr std::size_t most = 20;
    const auto& messages = error.messages();
    for (std::size_t i = 0; i < std::min(messages.size(), most); ++i) tell_line(messages[i].c_str());
    if (messages.size() > most) std::fprintf(stderr, "and %zu more\n", messages.size() - most);
    return ExitCode::bad_input;
}

ExitCode told(const std::filesystem::filesystem_error& error) {
    const std::string message = error.path1().string() + ": " + error.code().message();
    return told(message.c_str(), is_shortage(error.code()) ? ExitCode::out_of_resources : ExitCode::bad_input);
}

} // namespace

void leave_without_handlers(ExitCode code) {
    std::fflush(nullptr);
    std::_Exit(static_cast<int>(code));
}

ExitCode tell_failure() noexcept {
    try {
        throw;
    } catch (const InputError& error) {
        return told(error);
    } catch (const NoEquilibriumError& error) {
        return told(error.what(), ExitCode::no_equilibrium);
    } catch (const ResourceError& error) {
        return told(error.what(), ExitCode::out_of_resources);
    } catch (const std::bad_alloc&) {
        return told("out of memory", ExitCode::out_of_resources);
    } catch (const std::length_error&) { // of an array that no memory could hold
        return told("out of memory", ExitCode::out_of_resources);
    } catch (const std::filesystem::filesystem_error& error) {
        try {
            return told(error);
        } catch (const std::exception&) {
            return told("out of memory", ExitCode::out_of_resources);
        }
    } catch (const std::exception& error) { // which nothing foresees: what was given made the program err
        std::fputs("kluft cannot go on with this input: ", stderr);
        return told(error.what(), ExitCode::bad_input);
    } catch (...) {
        return told("kluft cannot go on with this input", ExitCode::bad_input);
    }
}

namespace {

/// Nothing can be made at a link that leads to what is not there, nor below it.
void require_no_dead_link(const fs::path& path) {
    std::error_code error;
    for (fs::path place = fs::absolute(path); place.has_relative_path(); place = place.parent_path()) {
        if (fs::exists(place, error)) return;
        if (fs::is_symlink(fs::symlink_status(place, error)))
            throw InputError(fmt::format("{}: expected a place for the results, found a link to {}, which is not there",
                                         place.string(), fs::read_symlink(place, error).string()));
    }
}

} // namespace

void require_no_file(const fs::path& directory) {
    require_no_dead_link(directory);
    std::error_code error;
    if (fs::exists(directory, error) && !fs::is_directory(directory, error))
        throw InputError(directory.string() + ": expected a directory for the results, found a file");
}

void require_possible_output(const std::string& path) {
    const auto refuse = [&](int error) {
        throw InputError("-o: expected a name for the results, found " + path + " (" +
                         std::generic_category().message(error) + ")");
    };
    struct stat status {};
    if (stat((path + ".part").c_str(), &status) != 0 && (errno == ENAMETOOLONG || errno == ENOTDIR || errno == ELOOP))
        refuse(errno);
    if (path.empty()) return;
    if (stat(path.c_str(), &status) == 0) {
        if (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode))
            throw InputError("-o: expected a name for the results, found a pipe, " + path);
        return;
    }
    require_no_dead_link(path);
    fs::path place = fs::absolute(path).parent_path(); // or the next one above it that is there
    std::error_code error;
    while (!fs::exists(place, error) && place.has_relative_path()) place = place.parent_path();
    if (access(place.c_str(), W_OK | X_OK) == 0) return;
    if (errno == EACCES || errno == EROFS)
        throw ResourceError(
            fmt::format("{}: cannot write in {}: {}", path, place.string(), std::generic_category().message(errno)));
    refuse(errno);
}

void require_own_file(const std::string& file, std::string_view what,
                      const std::function<bool(std::string_view content)>& is_own) {
    std::error_code error;
    if (!fs::is_regular_file(file, error) || fs::file_size(file, error) == 0 || is_own(read_file(file))) return;
    throw InputError(fmt::format("-o: expected {} that Kluft made or none, found another file, which would be lost: {}",
                                 what, file));
}

void require_directory_of(const std::string& file) {
    const fs::path place = fs::absolute(file).parent_path();
    std::error_code error;
    if (!fs::is_directory(place, error))
        throw InputError("-o: expected a file in a directory that is there, found " + file);
    if (fs::is_directory(file, error)) throw InputError("-o: expected a name for a file, found a directory, " + file);
}

} // namespace kluft
