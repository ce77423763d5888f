#include "cutaneous_node/emulator/object_dictionary.hpp"

#include <cassert>

namespace thimble {
namespace {

constexpr std::uint8_t kMostMapped = 4;
constexpr std::uint32_t kPdoOff = 0x80000000U;
constexpr std::uint32_t kNoRemoteFrames = 0x40000000U;

// The communication object of a mapping, 0 if it is none.
std::uint16_t communication_of(std::uint16_t index) {
    if (index == 0x1600 || index == 0x1a00) return static_cast<std::uint16_t>(index - 0x200);
    return 0;
}

ObjectKey mapped_key(std::uint32_t entry) {
    return {static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)};
}

// Calls use(key, at, bytes) for each object in the PDO.
template <class Use>
std::uint8_t each_mapped(const ObjectDictionary& dictionary, std::uint16_t mapping, const Use& use) {
    std::uint8_t at = 0;
    for (std::uint32_t i = 1; i <= dictionary.get({mapping, 0}); ++i) {
        const std::uint32_t entry = dictionary.get({mapping, static_cast<std::uint8_t>(i)});
        const auto bytes = static_cast<std::uint8_t>((entry & 0xffU) / 8);
        use(mapped_key(entry), at, bytes);
        at = static_cast<std::uint8_t>(at + bytes);
    }
    return at;
}

std::uint32_t code(SdoAbort abort) { return static_cast<std::uint32_t>(abort); }

}  // namespace

ObjectDictionary::ObjectDictionary(std::uint8_t node) {
    const auto constant = [this](ObjectKey key, std::uint32_t value, std::uint8_t bytes = 4) {
        entries_[key] = {value, bytes, false};
    };
    const auto variable = [this](ObjectKey key, std::uint32_t value, std::uint8_t bytes) {
        entries_[key] = {value, bytes, true};
    };
    constant({0x1000, 0}, 0x00020192);  // servo drive, CiA 402
    constant({0x1001, 0}, 0, 1);
    variable({0x1006, 0}, 0, 4);
    variable({0x1016, 1}, 0, 4);
    variable({0x1017, 0}, 0, 2);
    constant({0x1018, 1}, 0);
    add_mapping(0x1400, 0x1600, cob(CobBase::kReceive1, node));
    add_mapping(0x1800, 0x1a00, cob(CobBase::kTransmit1, node) | kNoRemoteFrames);
    variable({0x6007, 0}, 1, 2);
    constant({0x603f, 0}, 0, 2);
    variable({0x6040, 0}, 0, 2);
    constant({0x6041, 0}, 0x40, 2);
    variable({0x605e, 0}, 2, 2);
    variable({0x6060, 0}, 0, 1);
    constant({0x6061, 0}, 0, 1);
    constant({0x6064, 0}, 0);
    variable({0x6071, 0}, 0, 2);
    constant({0x6076, 0}, 150);  // uNm
    constant({0x6077, 0}, 0, 2);
    variable({0x607a, 0}, 0, 4);
    variable({0x60c2, 1}, 1, 1);  // 1 x 10^-3 s
    variable({0x60c2, 2}, 0xfd, 1);
    constant({0x6502, 0}, 1U << 7U | 1U << 9U);  // synchronous position and torque
}

void ObjectDictionary::add_mapping(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id) {
    entries_[{communication, 1}] = {id, 4, true};
    entries_[{communication, 2}] = {255, 1, true};
    entries_[{mapping, 0}] = {0, 1, true};
    for (std::uint8_t i = 1; i <= kMostMapped; ++i) entries_[{mapping, i}] = {0, 4, true};
}

std::uint32_t ObjectDictionary::get(ObjectKey key) const {
    const auto found = entries_.find(key);
    assert(found != entries_.end());
    return found->second.value;
}

void ObjectDictionary::set(ObjectKey key, std::uint32_t value) {
    Entry& entry = entries_.at(key);
    entry.value = entry.bytes == 4 ? value : value & ((1U << 8U * entry.bytes) - 1U);
}

Sdo ObjectDictionary::answer(const Sdo& request) {
    std::uint32_t abort = 0;
    const auto found = entries_.find(request.key);
    if (found == entries_.end()) {
        const auto same_index = entries_.lower_bound({request.key.index, 0});
        const bool known = same_index != entries_.end() && same_index->first.index == request.key.index;
        abort = code(known ? SdoAbort::kNoSubIndex : SdoAbort::kNoObject);
    } else if (request.kind == SdoKind::kRead) {
        return {SdoKind::kRead, request.key, found->second.value, found->second.bytes};
    } else {
        abort = write(request);
    }
    if (abort != 0) return {SdoKind::kAbort, request.key, abort, 4};
    return {SdoKind::kWrite, request.key, 0, 4};
}

// The abort code, 0 if it is done.
std::uint32_t ObjectDictionary::write(const Sdo& request) {
    Entry& entry = entries_.at(request.key);
    if (!entry.writable) return code(SdoAbort::kReadOnly);
    if (request.bytes != entry.bytes) return code(SdoAbort::kLength);
    if (request.key == ObjectKey{0x1800, 1} && (request.value & kNoRemoteFrames) == 0)
        return code(SdoAbort::kValue);  // as a drive that sends none on request
    if (const std::uint32_t abort = check_mapping(request); abort != 0) return abort;
    entry.value = request.value;
    return 0;
}

std::uint32_t ObjectDictionary::check_mapping(const Sdo& request) const {
    const std::uint16_t communication = communication_of(request.key.index);
    if (communication == 0) return 0;
    if ((get({communication, 1}) & kPdoOff) == 0) return code(SdoAbort::kDeviceState);
    if (request.key.sub > 0) {
        const auto mapped = entries_.find(mapped_key(request.value));
        const bool whole = mapped != entries_.end() && (request.value & 0xffU) == 8U * mapped->second.bytes;
        return whole ? 0 : code(SdoAbort::kCannotMap);
    }
    if (request.value > kMostMapped) return code(SdoAbort::kValue);
    std::uint32_t bits = 0;
    for (std::uint32_t i = 1; i <= request.value; ++i) {
        const std::uint32_t entry = get({request.key.index, static_cast<std::uint8_t>(i)});
        if (!has(mapped_key(entry))) return code(SdoAbort::kCannotMap);
        bits += entry & 0xffU;
    }
    return bits > 64 ? code(SdoAbort::kMapTooLong) : 0;
}

CanFrame pack_pdo(const ObjectDictionary& dictionary, std::uint16_t mapping, std::uint32_t id) {
    CanFrame frame;
    frame.id = id;
    frame.length = each_mapped(dictionary, mapping, [&](ObjectKey key, std::uint8_t at, std::uint8_t bytes) {
        store(frame, at, bytes, dictionary.get(key));
    });
    return frame;
}

std::uint8_t pdo_bytes(const ObjectDictionary& dictionary, std::uint16_t mapping) {
    return each_mapped(dictionary, mapping, [](ObjectKey, std::uint8_t, std::uint8_t) {});
}

void unpack_pdo(ObjectDictionary& dictionary, std::uint16_t mapping, const CanFrame& frame) {
    each_mapped(dictionary, mapping, [&](ObjectKey key, std::uint8_t at, std::uint8_t bytes) {
        dictionary.set(key, load(frame, at, bytes));
    });
}

}  // namespace thimble
