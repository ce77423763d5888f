// Tables that went through a spreadsheet: a byte order mark, CR LF, semicolons between fields and decimal commas in numbers.
#pragma once

#include <string>
#include <string_view>

namespace thimble {

enum class Semicolons { kRefuse, kTake };

// The text as the readers of tables take it, line for line: no byte order mark, LF alone, and `separator` where the header has
// semicolons instead. There, decimal commas become points. Throws Error (data) that names file and line: UTF-16, a comma that is
// no decimal comma, decimal commas beside decimal points, or semicolons that are to be refused.
std::string plain_table(std::string text, std::string_view name, char separator = ',',
                        Semicolons semicolons = Semicolons::kTake);

}  // namespace thimble
