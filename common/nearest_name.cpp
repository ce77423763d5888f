#include "common/nearest_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

namespace thimble {
namespace {

bool same_letter(char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

// Optimal string alignment distance (Damerau-Levenshtein without repeated edits), three rows at a time.
std::size_t letters_apart(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = last[j - 1] + (same_letter(a[i - 1], b[j - 1]) ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, changed});
            const bool swapped =
                i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) && same_letter(a[i - 2], b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

bool same_word(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_letter);
}

bool is_unit(std::string_view word) {
    constexpr std::array<std::string_view, 27> kUnits{
        "s",  "ms", "us", "ns", "min", "sec", "seconds", "m",   "mm",   "cm",    "um",      "N",   "mN", "Ns",
        "Nm", "kg", "g",  "Hz", "kHz", "J",   "rad",     "deg", "bits", "bytes", "percent", "per", "W"};
    return std::any_of(kUnits.begin(), kUnits.end(),
                       [&](std::string_view unit) { return same_word(word, unit); });
}

// "stiffness" of "stiffness_N_per_m", "delay" of "--delay-ms".
std::string_view without_unit(std::string_view name) {
    name.remove_prefix(std::min(name.find_first_not_of('-'), name.size()));
    for (std::size_t mark = name.find_last_of("_-"); mark != std::string_view::npos && mark > 0;
         mark = name.find_last_of("_-")) {
        if (!is_unit(name.substr(mark + 1))) break;
        name = name.substr(0, mark);
    }
    return name;
}

// Whole words of it: "delay" of "force_delay".
bool has_words(std::string_view name, std::string_view words) {
    const auto ends = [&](std::size_t at) { return at == name.size() || name[at] == '_' || name[at] == '-'; };
    for (std::size_t at = 0; at + words.size() <= name.size(); ++at) {
        if ((at == 0 || ends(at - 1)) && ends(at + words.size()) &&
            same_word(name.substr(at, words.size()), words))
            return true;
    }
    return false;
}

}  // namespace

std::string nearest_name(std::string_view typed, const std::vector<std::string>& names) {
    constexpr std::size_t kLongestTyped =
        100;  // the work grows with its length, and no name is near a longer one
    if (typed.size() > kLongestTyped) return "";
    const std::string_view stem = without_unit(typed);
    std::string nearest, longer;
    std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
    for (const std::string& name : names) {
        const std::string_view other = without_unit(name);
        std::size_t apart = letters_apart(typed, name);
        const std::size_t stems_apart = letters_apart(stem, other);
        if (!stem.empty() && stems_apart <= stem.size() / 3) apart = std::min(apart, stems_apart);
        if (apart < least) {
            least = apart;
            nearest = name;
        }
        const bool part = stem.size() > 2 && has_words(other, stem);
        if (part && (longer.empty() || name.size() < longer.size())) longer = name;
    }
    return nearest.empty() || (least > 1 && !longer.empty()) ? longer : nearest;
}

}  // namespace thimble
