#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "python/bindings.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

std::string quoted(const std::string& text) {
    std::string quoted = "\"";
    for (const char letter : text) {
        const auto byte = static_cast<unsigned char>(letter);
        if (byte < 0x20 || byte == 0x7F) {
            quoted += fmt::format("\\u{:04X}", byte);
        } else {
            if (letter == '"' || letter == '\\') quoted += '\\';
            quoted += letter;
        }
    }
    return quoted + '"';
}

std::string toml_value(const py::handle& value);

std::string toml_number(const py::handle& value) {
    try {
        if (PyIndex_Check(value.ptr()) != 0) {
            const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
            if (!whole) throw py::error_already_set();
            return fmt::format("{}", whole.cast<std::int64_t>());
        }
        return fmt::format("{}", py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>());
    } catch (const py::cast_error&) {
        throw Error(ExitCode::kUsage, "{}: is no whole number of 64 bits, which is the most that a key takes",
                    py::repr(value).cast<std::string>());
    }
}

std::string toml_list(const py::handle& list) {
    std::vector<std::string> values;
    for (const py::handle value : list) values.push_back(toml_value(value));
    return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string toml_table(const py::dict& table, std::string_view separator) {
    std::vector<std::string> pairs;
    pairs.reserve(table.size());
    for (const auto& [key, value] : table)
        pairs.push_back(fmt::format("{} = {}", quoted(py::str(key)), toml_value(value)));
    return fmt::format("{}", fmt::join(pairs, separator));
}

std::string toml_value(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    if (py::isinstance<py::str>(value)) return quoted(value.cast<std::string>());
    if (py::hasattr(value, "__fspath__")) return quoted(py::str(value));
    if (py::isinstance<py::dict>(value))
        return fmt::format("{{{}}}", toml_table(py::reinterpret_borrow<py::dict>(value), ", "));
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) return toml_list(value);
    // An array passes for a number as well, so it comes first.
    if (py::hasattr(value, "tolist") && py::hasattr(value, "__len__"))
        return toml_value(value.attr("tolist")());
    // Numbers of numpy too.
    if (PyNumber_Check(value.ptr()) != 0) return toml_number(value);
    throw Error(ExitCode::kUsage, "{}: is no number, text, list or dictionary",
                py::repr(value).cast<std::string>());
}

}  // namespace

std::string toml_text(const py::dict& table) { return toml_table(table, "\n") + "\n"; }

SystemSettings settings_from(const py::object& session, const std::map<std::string, double>& changes) {
    if (py::isinstance<py::dict>(session)) {
        ConfigFile file = ConfigFile::parse(toml_text(session), "the session's dictionary");
        for (const auto& [key, value] : changes) file.set(key, value);
        return read_system_settings(file);
    }
    std::vector<SettingChange> list;
    list.reserve(changes.size());
    for (const auto& [key, value] : changes) list.push_back({key, value});
    return load_system_settings(session.is_none() ? std::string() : py::str(session).cast<std::string>(),
                                list);
}

}  // namespace thimble
