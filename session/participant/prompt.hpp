// The experimenter's commands between two trials, and where they are typed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

enum class PromptKind : std::uint8_t {
    kGoOn,     // an empty line
    kReject,   // r WHY: the last trial is run again
    kExclude,  // x WHY: the last trial is left out of the analysis and not repeated
    kQuit,     // q
    kNoReason,
    kUnknown,
};

struct PromptCommand {
    PromptKind kind = PromptKind::kUnknown;
    std::string reason;
};

inline constexpr const char* kInputEnded = "no more answers: the input has ended";
inline constexpr const char* kPromptHelp =
    "Enter: continue; r REASON: repeat the last trial; x REASON: exclude the last trial; q: quit";

PromptCommand parse_prompt_line(std::string_view line);

// A rest. It ends after its minimum and, where an experimenter answers, with Enter.
class Rest {
  public:
    Rest(SessionTime begin, Duration minimum, bool asks) : end_(begin + minimum), asks_(asks) {}
    Duration left(SessionTime now) const { return now < end_ ? end_ - now : Duration{0}; }
    bool over_by_itself(SessionTime now) const { return !asks_ && now >= end_; }
    bool over_by_enter(SessionTime now) const { return asks_ && now >= end_; }

  private:
    SessionTime end_;
    bool asks_;
};

// Lines from a keyboard or a pipe, read without waiting.
class LineSource : boost::noncopyable {
  public:
    virtual ~LineSource() = default;

    // The next whole line, without its end; nothing if none is there yet.
    virtual std::optional<std::string> take_line() = 0;
    // Forgets the empty lines that a person typed while a trial ran. Lines of a script stay.
    virtual void forget_enter() {}
    // No line will come any more.
    virtual bool ended() const = 0;
};

// The first line of either source, which may be the same one. Both outlive this.
class TwoLineSources final : public LineSource {
  public:
    TwoLineSources(LineSource& one, LineSource& other) : one_(&one), other_(&other) {}
    std::optional<std::string> take_line() override {
        auto line = one_->take_line();
        return line ? line : other_->take_line();
    }
    void forget_enter() override {
        one_->forget_enter();
        other_->forget_enter();
    }
    bool ended() const override { return one_->ended() && other_->ended(); }

  private:
    LineSource *one_, *other_;
};

// A line of 64 KiB ends the source.
class DescriptorLines final : public LineSource {
  public:
    explicit DescriptorLines(int descriptor) : descriptor_(descriptor) {}
    std::optional<std::string> take_line() override;
    void forget_enter() override;
    bool ended() const override { return ended_ && buffer_.empty(); }

  private:
    void read_what_is_there();

    int descriptor_;
    std::string buffer_;
    bool ended_ = false;
};

}  // namespace thimble
