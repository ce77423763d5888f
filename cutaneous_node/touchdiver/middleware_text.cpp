#include "cutaneous_node/touchdiver/middleware_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr std::string_view kBlank = " \t\r\n";
constexpr std::string_view kPlain = "+-.0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

std::string_view name_of(GloveSide side) { return side == GloveSide::kLeft ? "LEFT" : "RIGHT"; }

std::string_view name_of(Thimble thimble) {
    constexpr std::array<std::string_view, 3> kNames{"THUMB", "INDEX", "MIDDLE"};
    return kNames.at(static_cast<std::size_t>(thimble));
}

// A reader of JSON that allocates nothing, since states come while a trial runs. It gives each member at any depth, an object or list as
// its opening bracket, and leaves escapes in texts as they are.
class Members {
  public:
    explicit Members(std::string_view text) : text_(text) {}

    // False: not JSON.
    template <class Take>
    bool each(Take&& take) {
        if (next() != '{') return false;
        do {
            const char symbol = next();
            if (symbol == '"') {
                key_ = quoted();
            } else if (!step(symbol)) {
                return false;
            }
            if (symbol == '"' && next() == ':') {
                ++at_;
                const auto value = next() == '"' ? quoted() : plain();
                if (value.empty() && !empty_text_) return false;
                take(key_, value);
            }
        } while (depth_ > 0);
        return next() == '\0';
    }

  private:
    char next() {
        at_ = std::min(text_.find_first_not_of(kBlank, at_), text_.size());
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool step(char symbol) {
        if (symbol == '{' || symbol == '[') ++depth_;
        if (symbol == '}' || symbol == ']') --depth_;
        if (std::string_view("{}[],").find(symbol) != std::string_view::npos && symbol != '\0') {
            ++at_;
            return true;
        }
        return !plain().empty();  // an item of a list
    }
    std::string_view quoted() {
        const std::size_t from = ++at_;
        while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
        if (at_ >= text_.size()) return {};  // it never ends, and neither does the object
        empty_text_ = at_ == from;
        return text_.substr(from, at_++ - from);
    }
    // A number, true, false or null; of an object or list its bracket, which step() then takes.
    std::string_view plain() {
        empty_text_ = false;
        if (next() == '{' || next() == '[') return text_.substr(at_, 1);
        const std::size_t end = std::min(text_.find_first_not_of(kPlain, at_), text_.size());
        const auto value = text_.substr(at_, end - at_);
        at_ = end;
        return value;
    }

    std::string_view text_, key_;
    std::size_t at_ = 0;
    int depth_ = 0;
    bool empty_text_ = false;
};

MiddlewareKind kind_of(std::string_view type) {
    if (type == "MW_STATUS") return MiddlewareKind::kMiddleware;
    return type == "WA_STATUS" ? MiddlewareKind::kApp : MiddlewareKind::kUnknown;
}

void take_member(std::string_view key, std::string_view value, MiddlewareStatus& status) {
    if (key == "type") status.kind = kind_of(value);
    if (key == "status") status.phase = value;
    if (key == "statusCode") std::from_chars(value.data(), value.data() + value.size(), status.code);
    if (key == "errorDesc") status.problem = value;
    if (key == "actuationsEnabled") status.actuations = value != "false";
    if (key == "connectedDevices" && value == "[") status.left = status.right = false;
    if (key == "handSide" && value == "LEFT") status.left = true;
    if (key == "handSide" && value == "RIGHT") status.right = true;
}

}  // namespace

void add_force(std::string& out, GloveSide side, Thimble thimble, double share) {
    fmt::format_to(std::back_inserter(out), "force:{:.6f}:0.000000:0.000000:{}:{}~", share, name_of(side),
                   name_of(thimble));
}

void add_stop_force(std::string& out, GloveSide side, Thimble thimble) {
    fmt::format_to(std::back_inserter(out), "stopForce:{}:{}~", name_of(side), name_of(thimble));
}

void add_question(std::string& out, MiddlewareKind kind, std::int64_t time_ms) {
    const auto ask = [&](std::string_view type) {
        fmt::format_to(std::back_inserter(out), "{{\"type\":\"{}\",\"ts\":{}}}~", type, time_ms);
    };
    if (kind != MiddlewareKind::kApp) ask("MW_GET_STATUS");
    if (kind != MiddlewareKind::kMiddleware) ask("WA_GET_STATUS");
}

std::optional<MiddlewareStatus> read_middleware_status(std::string_view message) {
    MiddlewareStatus status;
    const bool whole = Members(message).each(
        [&status](std::string_view key, std::string_view value) { take_member(key, value, status); });
    if (!whole || status.kind == MiddlewareKind::kUnknown || status.phase.empty()) return std::nullopt;
    return status;
}

bool is_middleware_message(std::string_view message) {
    constexpr std::array<std::string_view, 3> kCommands{
        "Tracking:", "CalibrationStatus:", "CalibrationResult:"};
    const bool command = std::any_of(kCommands.begin(), kCommands.end(), [message](std::string_view word) {
        return message.substr(0, word.size()) == word;
    });
    return command || Members(message).each([](std::string_view, std::string_view) {});
}

}  // namespace thimble
