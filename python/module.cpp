// The module _thimble, which thimble/__init__.py shows. An Error becomes one of the exceptions of thimble/errors.py, with its words.
#include <utility>

#include "common/error.hpp"
#include "common/version.hpp"
#include "python/bindings.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Error& error) {
        const py::object of_code = py::module_::import("thimble.errors").attr("of_code");
        const py::object made = of_code(static_cast<int>(error.code()), error.what());
        PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
    }
}

}  // namespace
}  // namespace thimble

PYBIND11_MODULE(_thimble, module) {
    module.attr("__version__") = THIMBLE_VERSION;
    pybind11::register_exception_translator(&thimble::translate);
    thimble::add_link(module);
    thimble::add_scene(module);
    thimble::add_session(module);
    thimble::add_study(module);
    thimble::add_board(module);
    thimble::add_logs(module);
}
