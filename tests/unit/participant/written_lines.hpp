// Lines that a person would type, written beforehand.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "session/participant/prompt.hpp"

namespace thimble {

class WrittenLines final : public LineSource {
  public:
    explicit WrittenLines(std::deque<std::string> lines) : lines_(std::move(lines)) {}
    std::optional<std::string> take_line() override {
        if (lines_.empty()) return std::nullopt;
        std::string line = lines_.front();
        lines_.pop_front();
        return line;
    }
    bool ended() const override { return lines_.empty(); }

  private:
    std::deque<std::string> lines_;
};

}  // namespace thimble
