// GDAL's functions, looked up in its library when they are called: a program that reads no map does not load it.
#pragma once

#include <string>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

namespace kluft {

/// Throws InputError where GDAL cannot be loaded or has no such function.
[[nodiscard]] void* gdal_symbol(const char* name);

template <class Function> [[nodiscard]] Function gdal_function(const char* name) {
    return reinterpret_cast<Function>(gdal_symbol(name)); // NOLINT: what dlsym gives
}

/// A function of GDAL by its name, with its type.
#define KLUFT_GDAL(name) (::kluft::gdal_function<decltype(&::name)>(#name))

/// As long as it lives, what GDAL and PROJ say on this thread comes here and not to the standard error.
class GdalMessages {
public:
    GdalMessages();
    GdalMessages(const GdalMessages&) = delete;
    GdalMessages& operator=(const GdalMessages&) = delete;
    ~GdalMessages();

    /// Whether something has failed since.
    [[nodiscard]] bool has_failure() const { return !failures_.empty(); }
    /// What has failed first, on one line; else the first warning; else "".
    [[nodiscard]] std::string text() const;
    /// Throws ResourceError where memory was missing.
    void require_memory() const;

private:
    static void CPL_STDCALL take(CPLErr kind, CPLErrorNum number, const char* text);

    std::vector<std::string> failures_, warnings_;
    bool out_of_memory_ = false;
    decltype(&::CPLPopErrorHandler) pop_;
};

} // namespace kluft
