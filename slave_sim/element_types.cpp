#include "slave_sim/element_types.hpp"

#include <array>

namespace thimble {

std::span<const ElementType> element_types() {
#define THIMBLE_ELEMENT_TYPE(type) ElementType{#type, &read_##type},
    static constexpr std::array kTypes{THIMBLE_ELEMENT_TYPES(THIMBLE_ELEMENT_TYPE)};
#undef THIMBLE_ELEMENT_TYPE
    return kTypes;
}

}  // namespace thimble
