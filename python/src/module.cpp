// The module _core of the package kluft: the library for Python. What users see stands in python/kluft.
#include "module.hpp"

#include <exception>
#include <filesystem>
#include <new>
#include <utility>

#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/version.hpp"

namespace py = pybind11;

namespace kluft {

namespace {

py::object errors() { return py::module_::import("kluft.errors"); }

void raise(const py::object& error) { PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr()); }

void raise_input_error(const std::vector<InputProblem>& problems) {
    py::list listed;
    for (const InputProblem& problem : problems)
        listed.append(
            py::make_tuple(problem.message, problem.what, problem.path, problem.file, problem.line, problem.column));
    raise(errors().attr("input_error")(listed));
}

/// The errors of the library as those of kluft.errors.
void translate(std::exception_ptr failure) {
    try {
        if (failure) std::rethrow_exception(std::move(failure));
    } catch (const InputError& error) {
        raise_input_error(error.problems());
    } catch (const NoEquilibriumError& error) {
        raise(errors().attr("NoEquilibriumError")(error.what()));
    } catch (const ResourceError& error) {
        raise(errors().attr("ResourceError")(error.what()));
    } catch (const std::bad_alloc&) {
        raise(errors().attr("ResourceError")("out of memory"));
    } catch (const std::filesystem::filesystem_error& error) {
        raise(errors().attr("ResourceError")(error.what()));
    }
}

} // namespace

} // namespace kluft

PYBIND11_MODULE(_core, module) {
    module.doc() = "The library behind the package kluft.";
    py::register_exception_translator(kluft::translate);
    module.attr("version") = std::string(kluft::version());
    module.def("blas_core", kluft::blas_core);
    module.def("wider_blas_core", kluft::wider_blas_core);
    kluft::bind_scene(module);
    kluft::bind_simulation(module);
    kluft::bind_study(module);
}
