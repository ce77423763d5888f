// Rows of plug-ins, whose code may crash or hang, run through here.
#pragma once

#include <functional>

#include "study/board/board_row.hpp"

namespace thimble {

// The result of `row`. A plug-in that does not come to an end is an Error that says how it ended.
inline BoardRow run_apart(const std::function<BoardRow()>& row) { return row(); }

}  // namespace thimble
