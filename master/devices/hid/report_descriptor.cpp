#include "master/devices/hid/report_descriptor.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr std::size_t kMostFields = 256, kMostUsages = 256, kMostPushed = 16, kMostApplications = 16;
constexpr std::uint32_t kMostBits = 8 * 4096;  // of one report

struct Item {
    unsigned type = 0, tag = 0, size = 0;
    std::uint32_t data = 0;

    std::int32_t signed_data() const {
        if (size == 0 || size == 4) return static_cast<std::int32_t>(data);
        const std::uint32_t sign = std::uint32_t{1} << (8 * size - 1);
        return static_cast<std::int32_t>((data ^ sign) - sign);
    }
};

constexpr unsigned kMain = 0, kGlobal = 1, kLocal = 2;
constexpr std::uint32_t kApplication = 1;  // kind of collection
constexpr std::size_t kNoApplication = SIZE_MAX;

struct Globals {
    std::uint16_t usage_page = 0;
    std::int32_t minimum = 0, maximum = 0;
    std::uint32_t unsigned_maximum = 0;
    std::uint32_t report_size = 0, report_count = 0;
    std::uint8_t report = 0;
};

// Of the page that holds at its main item (6.2.2.8), unless it brings one along.
struct LocalUsage {
    std::optional<std::uint16_t> page;
    std::uint16_t usage = 0;
};

class DescriptorReader {
  public:
    bool read(std::span<const std::uint8_t> bytes) {
        while (!bytes.empty()) {
            const unsigned prefix = bytes[0];
            const bool is_long = prefix == 0xfe;
            const std::size_t size = is_long             ? (bytes.size() > 1 ? std::size_t{2} + bytes[1] : 0)
                                     : (prefix & 3) == 3 ? 4
                                                         : prefix & 3;
            if (bytes.size() < 1 + size || (is_long && size == 0)) return false;
            if (!is_long && !take(item_of(bytes.subspan(0, 1 + size)))) return false;
            bytes = bytes.subspan(1 + size);
        }
        return depth_ == 0 && !layout.applications.empty();
    }
    HidLayout layout;

  private:
    static Item item_of(std::span<const std::uint8_t> bytes) {
        const unsigned prefix = bytes[0];
        Item item{(prefix >> 2U) & 3U, prefix >> 4U, static_cast<unsigned>(bytes.size() - 1), 0};
        for (std::size_t i = 1; i < bytes.size(); ++i) item.data |= std::uint32_t{bytes[i]} << (8 * (i - 1));
        return item;
    }

    bool take(const Item& item) {
        switch (item.type) {
            case kMain:
                return take_main(item);
            case kGlobal:
                return take_global(item);
            case kLocal:
                take_local(item);
                return true;
            default:
                return false;
        }
    }

    bool take_main(const Item& item) {
        bool good = true;
        if (item.tag == 8) good = add_fields(item.data);
        if (item.tag == 10) {
            if (depth_++ == 0 && item.data == kApplication && !usages_.empty()) {
                if (layout.applications.size() == kMostApplications) return false;
                application_ = layout.applications.size();
                layout.applications.push_back(complete(usages_.front()));
            }
        }
        if (item.tag == 12) {
            good = depth_-- > 0;
            if (depth_ == 0) application_ = kNoApplication;
        }
        usages_.clear();
        return good;
    }

    bool take_global(const Item& item) {
        switch (item.tag) {
            case 0:
                globals_.usage_page = static_cast<std::uint16_t>(item.data);
                break;
            case 1:
                globals_.minimum = item.signed_data();
                break;
            case 2:
                globals_.maximum = item.signed_data();
                globals_.unsigned_maximum = item.data;
                break;
            case 7:
                globals_.report_size = item.data;
                break;
            case 8:
                if (item.data == 0 || item.data > 255) return false;
                globals_.report = static_cast<std::uint8_t>(item.data);
                layout.numbered = true;
                break;
            case 9:
                globals_.report_count = item.data;
                break;
            case 10:
                if (pushed_.size() == kMostPushed) return false;
                pushed_.push_back(globals_);
                break;
            case 11:
                if (pushed_.empty()) return false;
                globals_ = pushed_.back();
                pushed_.pop_back();
                break;
            default:
                break;  // units and physical limits
        }
        return true;
    }

    // A usage of four bytes brings its page along.
    static LocalUsage usage_of(const Item& item) {
        LocalUsage usage{std::nullopt, static_cast<std::uint16_t>(item.data)};
        if (item.size == 4) usage.page = static_cast<std::uint16_t>(item.data >> 16);
        return usage;
    }
    HidUsage complete(const LocalUsage& usage) const {
        return {usage.page.value_or(globals_.usage_page), usage.usage};
    }

    void take_local(const Item& item) {
        if (item.tag == 0 && usages_.size() < kMostUsages) usages_.push_back(usage_of(item));
        if (item.tag == 1) first_ = usage_of(item);
        if (item.tag != 2) return;
        const LocalUsage last = usage_of(item);
        for (std::uint32_t usage = first_.usage; usage <= last.usage && usages_.size() < kMostUsages; ++usage)
            usages_.push_back({first_.page, static_cast<std::uint16_t>(usage)});
    }

    bool add_fields(std::uint32_t flags) {
        const std::uint32_t size = globals_.report_size, count = globals_.report_count;
        std::uint32_t& offset = offsets_[globals_.report];
        if (size > kMostBits || count > kMostBits || size * count > kMostBits - offset) return false;
        const bool constant = (flags & 1U) != 0, variable = (flags & 2U) != 0;
        for (std::uint32_t i = 0; i < count; ++i, offset += size) {
            if (constant || !variable || size > 32 || size == 0 || usages_.empty()) continue;
            const HidUsage usage = complete(usages_[std::min<std::size_t>(i, usages_.size() - 1)]);
            HidField field{usage.page, usage.usage, application_,     globals_.report,
                           offset,     size,        globals_.minimum, maximum()};
            if (field.minimum < field.maximum && layout.fields.size() < kMostFields)
                layout.fields.push_back(field);
        }
        return true;
    }

    // Many devices write a maximum of 255 in one byte. If no value is negative, this is not -1.
    std::int32_t maximum() const {
        if (globals_.minimum < 0 || globals_.maximum >= 0) return globals_.maximum;
        return static_cast<std::int32_t>(std::min<std::uint32_t>(globals_.unsigned_maximum, INT32_MAX));
    }

    Globals globals_;
    std::vector<Globals> pushed_;
    std::vector<LocalUsage> usages_;
    LocalUsage first_;
    std::uint32_t offsets_[256]{};
    int depth_ = 0;
    std::size_t application_ = kNoApplication;
};

}  // namespace

std::optional<HidLayout> parse_report_descriptor(std::span<const std::uint8_t> bytes) {
    DescriptorReader reader;
    if (!reader.read(bytes)) return std::nullopt;
    return reader.layout;
}

std::optional<std::int32_t> value_of(const HidLayout& layout, const HidField& field,
                                     std::span<const std::uint8_t> report) {
    if (layout.numbered) {
        if (report.empty() || report[0] != field.report) return std::nullopt;
        report = report.subspan(1);
    }
    if (field.bit_offset + field.bits > 8 * report.size()) return std::nullopt;
    std::uint32_t value = 0;
    for (std::uint32_t bit = 0; bit < field.bits; ++bit) {
        const std::uint32_t at = field.bit_offset + bit;
        value |= static_cast<std::uint32_t>((report[at / 8] >> (at % 8)) & 1U) << bit;
    }
    if (field.minimum < 0 && field.bits < 32) {
        const std::uint32_t sign = std::uint32_t{1} << (field.bits - 1);
        value = (value ^ sign) - sign;
    }
    return static_cast<std::int32_t>(value);
}

}  // namespace thimble
