#include <algorithm>
#include <cstring>
#include <map>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "thimble/log/hdf5_library.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

using HdfId = Hdf5Library::Id;

// One dataset: numbers of eight bytes, or texts of one length.
struct HdfColumn {
    std::string name, unit, values;  // values: what the numbers of an enum stand for
    std::size_t text_bytes = 0;      // 0: numbers
    std::size_t kind = 1;            // of FieldValue's numbers: double, int64, uint64
    std::vector<std::uint8_t> bytes{};

    void add(const FieldValue& value) {
        const std::size_t at = bytes.size();
        bytes.resize(at + (text_bytes > 0 ? text_bytes : 8));
        if (const auto* text = std::get_if<std::string>(&value)) {
            std::memcpy(bytes.data() + at, text->data(), std::min(text->size(), text_bytes));
        } else if (const auto* flag = std::get_if<bool>(&value)) {
            const std::int64_t number = *flag ? 1 : 0;
            std::memcpy(bytes.data() + at, &number, sizeof number);
        } else {
            kind = value.index();
            std::visit(
                [&](const auto& v) {
                    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>)
                        std::memcpy(bytes.data() + at, &v, sizeof v);
                },
                value);
        }
    }
};

HdfColumn column_of(const std::string& folder, const PacketField& field) {
    HdfColumn column{folder + field.name, unit_of(field.name), "", field.elements};
    for (const auto& [value, name] : field.names) {
        column.values += fmt::format("{}{} {}", column.values.empty() ? "" : ", ", value, name);
    }
    return column;
}

struct HdfTable {
    const LoggedFile* file = nullptr;
    std::vector<HdfColumn> columns;
    std::size_t rows = 0;
};

class Hdf5Export {
  public:
    explicit Hdf5Export(const std::filesystem::path& path) : path_(path) {
        constexpr unsigned kExclusive = 0x0004;  // H5F_ACC_EXCL
        file_ = hdf_.create_file(path.c_str(), kExclusive, 0, 0);
        if (file_ < 0) {
            throw Error(ExitCode::kUsage,
                        fmt::format("{}: cannot be created: does it exist already, or its folder not?",
                                    path.string()));
        }
        groups_ = check(hdf_.create_properties(hdf_.link_creation));
        check(hdf_.create_groups_on_the_way(groups_, 1));
    }
    ~Hdf5Export() {
        if (file_ >= 0) hdf_.close_file(file_);
    }
    Hdf5Export(const Hdf5Export&) = delete;
    Hdf5Export& operator=(const Hdf5Export&) = delete;

    void add(const LoggedFile& file, const LoggedTopic& topic, const McapMessage& message) {
        Bytes packet;
        if (!topic.readable || !verify_packet(message.data, aligned_, packet)) return;
        const PacketPart* kind = fields_.kind_of(packet);
        if (kind == nullptr) return;
        HdfTable& table = tables_[file.name() + topic.topic + '/' + kind->name];
        if (table.columns.empty()) start(table, file, *kind);
        if (table.file != &file)
            throw Error(ExitCode::kUsage, fmt::format("{}: two logs would share the group {}", path_.string(),
                                                      file.name() + topic.topic));
        ++table.rows;
        std::size_t next = 0;
        for (const std::uint64_t number : {message.log_time_ns, message.publish_time_ns})
            table.columns[next++].add(number);
        table.columns[next++].add(std::int64_t{topic.sent ? 1 : 0});
        for (const PacketPart* part : {&fields_.header(), kind}) {
            for (const FieldValue& value : fields_.values(packet, *part, EnumValues::kNumbers))
                table.columns[next++].add(value);
        }
    }

    std::size_t finish() {
        for (const auto& [name, table] : tables_) {
            for (const HdfColumn& column : table.columns) write(name, column, table.rows);
        }
        check(hdf_.close_file(std::exchange(file_, -1)));
        return tables_.size();
    }

  private:
    void start(HdfTable& table, const LoggedFile& file, const PacketPart& kind) const {
        table.file = &file;
        table.columns = {
            {"log_time_ns", "ns", ""}, {"publish_time_ns", "ns", ""}, {"sent", "", "0 received, 1 sent"}};
        for (const PacketField& field : fields_.header().fields)
            table.columns.push_back(column_of("header/", field));
        for (const PacketField& field : kind.fields) table.columns.push_back(column_of("", field));
    }

    HdfId check(HdfId result) const {
        if (result >= 0) return result;
        throw Error(ExitCode::kRunFailed,
                    fmt::format("{}: cannot be written; check the disk's free space", path_.string()));
    }

    HdfId text_type(std::size_t bytes) {
        const HdfId type = check(hdf_.copy_type(hdf_.text));
        check(hdf_.set_size(type, bytes));
        return type;
    }

    HdfId type_of(const HdfColumn& column) {
        if (column.text_bytes > 0) return text_type(column.text_bytes);
        return column.kind == 0   ? hdf_.native_double
               : column.kind == 1 ? hdf_.native_int64
                                  : hdf_.native_uint64;
    }

    void write(const std::string& table, const HdfColumn& column, std::size_t rows) {
        const Hdf5Library::Size size = rows;
        const HdfId space = check(hdf_.create_space(1, &size, nullptr));
        const HdfId type = type_of(column);
        const std::string name = table + '/' + column.name;
        const HdfId set = check(hdf_.create_dataset(file_, name.c_str(), type, space, groups_, 0, 0));
        check(hdf_.write_dataset(set, type, 0, 0, 0, column.bytes.data()));
        describe(set, "unit", column.unit);
        describe(set, "values", column.values);
        check(hdf_.close_dataset(set));
        check(hdf_.close_space(space));
    }

    void describe(HdfId set, const char* name, const std::string& text) {
        if (text.empty()) return;
        const HdfId space = check(hdf_.create_scalar(0));  // H5S_SCALAR
        const HdfId type = text_type(text.size());
        const HdfId attribute = check(hdf_.create_attribute(set, name, type, space, 0, 0));
        check(hdf_.write_attribute(attribute, type, text.data()));
        check(hdf_.close_attribute(attribute));
        check(hdf_.close_space(space));
    }

    Hdf5Library hdf_;
    std::filesystem::path path_;
    HdfId file_ = -1, groups_ = -1;
    PacketFields fields_;
    std::map<std::string, HdfTable> tables_;
    std::vector<std::uint64_t> aligned_;
};

}  // namespace

std::size_t export_hdf5(const std::vector<std::unique_ptr<LoggedFile>>& files,
                        const std::filesystem::path& path, const std::string& topic) {
    Hdf5Export tables(path);
    for (const auto& file : files) {
        file->for_each([&](const LoggedTopic& its, const McapMessage& message) {
            if (its.topic.starts_with(topic)) tables.add(*file, its, message);
        });
    }
    return tables.finish();
}

}  // namespace thimble
