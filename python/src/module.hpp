// The parts of the module _core.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace kluft {

/// A scene as the package knows it: a text with settings over it, as the program knows a file and --set.
struct SceneText {
    std::string text;
    std::vector<std::string> settings; ///< "key.path=value"
    std::string file;                  ///< gives the name and the directory that relative paths start from
};

/// A NumPy array over the memory of `owned`, which it keeps: no copy, read-only. `pointer` is the first of its numbers.
template <class Number, class Owned>
pybind11::array array_over(std::shared_ptr<Owned> owned, const Number* pointer, std::vector<pybind11::ssize_t> shape) {
    pybind11::capsule keeper(new std::shared_ptr<Owned>(std::move(owned)),
                             [](void* held) { delete static_cast<std::shared_ptr<Owned>*>(held); });
    pybind11::array_t<Number> array(std::move(shape), pointer, keeper);
    array.attr("flags").attr("writeable") = false;
    return array;
}

void bind_scene(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_study(pybind11::module_& module);

} // namespace kluft
