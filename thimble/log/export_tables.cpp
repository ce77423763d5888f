// Logs as CSV files or as one HDF5 file: a table per log, topic and kind of message.
#include <algorithm>
#include <cstring>
#include <functional>
#include <hdf5.h>
#include <map>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

struct TableRow {
    const LoggedFile& file;
    const LoggedTopic& topic;
    const McapMessage& message;
    Bytes packet;
    const PacketPart& kind;
};

void each_row(const LoggedFiles& files, const std::string& topic, const PacketFields& fields,
              const std::function<void(const TableRow&)>& use) {
    std::vector<std::uint64_t> aligned;
    for (const auto& file : files) {
        file->for_each([&](const LoggedTopic& its, const McapMessage& message) {
            Bytes packet;
            if (!its.readable || !its.topic.starts_with(topic)) return;
            if (!verify_packet(message.data, aligned, packet)) return;
            if (const PacketPart* kind = fields.kind_of(packet)) use({*file, its, message, packet, *kind});
        });
    }
}

// Only a fault's text may hold characters that our own tables would have to quote.
std::string csv_text(const FieldValue& value) {
    std::string text = to_text(value);
    if (!std::holds_alternative<std::string>(value)) return text;
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + '"';
}

std::string csv_name(const TableRow& row) {
    std::string name = row.file.name() + row.topic.topic + '.' + row.kind.name;
    std::replace(name.begin(), name.end(), '/', '.');
    return name + ".csv";
}

std::string csv_header(const PacketFields& fields, const PacketPart& kind) {
    std::string columns = "log_time_ns,publish_time_ns,direction";
    for (const PacketField& field : fields.header().fields) columns += ",header_" + field.name;
    for (const PacketField& field : kind.fields) columns += ',' + field.name;
    return columns + '\n';
}

std::string csv_line(const PacketFields& fields, const TableRow& row) {
    std::string line = fmt::format("{},{},{}", row.message.log_time_ns, row.message.publish_time_ns,
                                   row.topic.sent ? "sent" : "received");
    for (const PacketPart* part : {&fields.header(), &row.kind}) {
        for (const FieldValue& value : fields.values(row.packet, *part)) line += ',' + csv_text(value);
    }
    return line + '\n';
}

// One dataset: numbers of eight bytes, or texts of one length.
struct HdfColumn {
    std::string name, unit, values;  // values: the meaning of an enum's numbers
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
        refuse_folder(path);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // no words of its own on stderr
        file_ = H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
        if (file_ < 0) {
            throw Error(ExitCode::kUsage,
                        fmt::format("{}: cannot be created: does it already exist, or is its folder missing?",
                                    path.string()));
        }
        groups_ = check(H5Pcreate(H5P_LINK_CREATE));
        check(H5Pset_create_intermediate_group(groups_, 1));
    }
    ~Hdf5Export() {
        if (file_ >= 0) H5Fclose(file_);
    }
    Hdf5Export(const Hdf5Export&) = delete;
    Hdf5Export& operator=(const Hdf5Export&) = delete;

    void add(const PacketFields& fields, const TableRow& row) {
        HdfTable& table = tables_[row.file.name() + row.topic.topic + '/' + row.kind.name];
        if (table.columns.empty()) start(table, fields, row);
        if (table.file != &row.file)
            throw Error(ExitCode::kUsage, fmt::format("{}: two logs would use the same group {}",
                                                      path_.string(), row.file.name() + row.topic.topic));
        ++table.rows;
        std::size_t next = 0;
        for (const std::uint64_t number : {row.message.log_time_ns, row.message.publish_time_ns})
            table.columns[next++].add(number);
        table.columns[next++].add(std::int64_t{row.topic.sent ? 1 : 0});
        for (const PacketPart* part : {&fields.header(), &row.kind}) {
            for (const FieldValue& value : fields.values(row.packet, *part, EnumValues::kNumbers))
                table.columns[next++].add(value);
        }
    }

    std::size_t finish() {
        for (const auto& [name, table] : tables_) {
            for (const HdfColumn& column : table.columns) write(name, column, table.rows);
        }
        check(H5Fclose(std::exchange(file_, -1)));
        return tables_.size();
    }

  private:
    static void start(HdfTable& table, const PacketFields& fields, const TableRow& row) {
        table.file = &row.file;
        table.columns = {
            {"log_time_ns", "ns", ""}, {"publish_time_ns", "ns", ""}, {"sent", "", "0 received, 1 sent"}};
        for (const PacketField& field : fields.header().fields)
            table.columns.push_back(column_of("header/", field));
        for (const PacketField& field : row.kind.fields) table.columns.push_back(column_of("", field));
    }

    hid_t check(hid_t result) const {
        if (result >= 0) return result;
        throw Error(ExitCode::kRunFailed,
                    fmt::format("{}: cannot be written; check the disk's free space", path_.string()));
    }

    hid_t text_type(std::size_t bytes) const {
        const hid_t type = check(H5Tcopy(H5T_C_S1));
        check(H5Tset_size(type, bytes));
        return type;
    }

    hid_t type_of(const HdfColumn& column) const {
        if (column.text_bytes > 0) return text_type(column.text_bytes);
        if (column.kind == 0) return H5T_NATIVE_DOUBLE;
        return column.kind == 1 ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
    }

    void write(const std::string& table, const HdfColumn& column, hsize_t rows) const {
        const hid_t space = check(H5Screate_simple(1, &rows, nullptr)), type = type_of(column);
        const std::string name = table + '/' + column.name;
        const hid_t set =
            check(H5Dcreate2(file_, name.c_str(), type, space, groups_, H5P_DEFAULT, H5P_DEFAULT));
        check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.bytes.data()));
        describe(set, "unit", column.unit);
        describe(set, "values", column.values);
        check(H5Dclose(set));
        check(H5Sclose(space));
    }

    void describe(hid_t set, const char* name, const std::string& text) const {
        if (text.empty()) return;
        const hid_t space = check(H5Screate(H5S_SCALAR)), type = text_type(text.size());
        const hid_t attribute = check(H5Acreate2(set, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
        check(H5Awrite(attribute, type, text.data()));
        check(H5Aclose(attribute));
        check(H5Sclose(space));
    }

    std::filesystem::path path_;
    hid_t file_ = -1, groups_ = -1;
    std::map<std::string, HdfTable> tables_;
};

}  // namespace

std::size_t export_csv(const LoggedFiles& files, const std::filesystem::path& folder,
                       const std::string& topic) {
    make_folder(folder);
    const PacketFields fields;
    std::map<std::tuple<const LoggedFile*, std::string, const PacketPart*>, CsvFile> tables;
    each_row(files, topic, fields, [&](const TableRow& row) {
        const std::tuple key(&row.file, row.topic.topic, &row.kind);
        auto table = tables.find(key);
        if (table == tables.end()) {
            table = tables.try_emplace(key, folder / csv_name(row), IfExists::kRefuse).first;
            table->second.write(csv_header(fields, row.kind));
        }
        table->second.write(csv_line(fields, row));
    });
    for (auto& [key, table] : tables) table.flush();
    return tables.size();
}

std::size_t export_hdf5(const LoggedFiles& files, const std::filesystem::path& path,
                        const std::string& topic) {
    Hdf5Export tables(path);
    const PacketFields fields;
    each_row(files, topic, fields, [&](const TableRow& row) { tables.add(fields, row); });
    return tables.finish();
}

}  // namespace thimble
