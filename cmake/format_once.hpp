// Precompiled with the headers of others: no source compiles again how fmt formats for format_to and spdlog, because its library can.
//
// fmt 9 exports the function, which its header does not declare so. clang++ gives it another name.
#pragma once
#include <fmt/format.h>
#if !defined(FMT_HEADER_ONLY) && !defined(__clang__) && FMT_VERSION < 100000
namespace fmt::detail {
extern template void vformat_to<char>(buffer<char>&, string_view, basic_format_args<FMT_BUFFER_CONTEXT(char)>,
                                      locale_ref);
}
#endif
