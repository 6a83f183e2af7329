#include "gdal_library.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <dlfcn.h>
#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/maps/gdal.hpp"

namespace kluft {

namespace {

/// The loaded library, or why there is none. It is never unloaded.
struct GdalLibrary {
    void* handle = nullptr;
    std::string problem;
    bool lacks_memory = false;
};

/// Of what the C library says of a library that it cannot load; the number of the error is lost there.
bool is_lack_of_memory(std::string_view reason) {
    constexpr std::array<std::string_view, 3> words{"failed to map segment", "cannot map zero-fill pages", "llocate"};
    return std::ranges::any_of(words, [&](std::string_view word) { return reason.find(word) != reason.npos; });
}

GdalLibrary load_gdal() {
    GdalLibrary library;
    for (const char* const name : {KLUFT_GDAL_NAME, KLUFT_GDAL_LIBRARY}) {
        library.handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL); // NOLINT(bugprone-unused-return-value)
        if (library.handle != nullptr) return {library.handle, {}};
        const char* const reason = ::dlerror();
        library.problem = fmt::format("GDAL cannot be loaded: {}", reason == nullptr ? name : reason);
        library.lacks_memory = library.lacks_memory || is_lack_of_memory(library.problem);
    }
    return library;
}

const GdalLibrary& gdal_library() {
    static const GdalLibrary library = load_gdal();
    return library;
}

std::string on_one_line(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

} // namespace

std::string gdal_version() { return KLUFT_GDAL_VERSION; }

std::string gdal_problem() { return gdal_library().problem; }

void require_gdal(const std::string& what) {
    if (gdal_problem().empty()) return;
    const std::string message = what.empty() ? gdal_problem() : fmt::format("{}: {}", what, gdal_problem());
    if (gdal_library().lacks_memory) throw ResourceError("out of memory: " + message);
    throw InputError(message);
}

void* gdal_symbol(const char* name) {
    require_gdal();
    void* const found = ::dlsym(gdal_library().handle, name);
    if (found == nullptr)
        throw InputError(fmt::format("expected GDAL {} or newer, found one without {}", gdal_version(), name));
    return found;
}

GdalMessages::GdalMessages() : pop_(KLUFT_GDAL(CPLPopErrorHandler)) {
    KLUFT_GDAL(CPLPushErrorHandlerEx)(&GdalMessages::take, this);
}

GdalMessages::~GdalMessages() { pop_(); }

void CPL_STDCALL GdalMessages::take(CPLErr kind, CPLErrorNum number, const char* text) {
    auto* const messages = static_cast<GdalMessages*>(KLUFT_GDAL(CPLGetErrorHandlerUserData)());
    if (kind >= CE_Failure)
        messages->failures_.emplace_back(on_one_line(text));
    else if (kind == CE_Warning)
        messages->warnings_.emplace_back(on_one_line(text));
    messages->out_of_memory_ = messages->out_of_memory_ || number == CPLE_OutOfMemory;
}

std::string GdalMessages::text() const {
    if (!failures_.empty()) return failures_.front();
    return warnings_.empty() ? std::string{} : warnings_.front();
}

void GdalMessages::require_memory() const {
    if (out_of_memory_) throw ResourceError("not enough memory for a map: " + text());
}

} // namespace kluft
