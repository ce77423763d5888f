// Lines from a keyboard or a pipe, read without waiting.
#pragma once

#include <optional>
#include <string>

namespace thimble {

class LineSource {
  public:
    virtual ~LineSource() = default;
    LineSource() = default;
    LineSource(const LineSource&) = delete;
    LineSource& operator=(const LineSource&) = delete;

    // The next whole line, without its end; nothing if none is there yet.
    virtual std::optional<std::string> take_line() = 0;
    // No line will come any more.
    virtual bool ended() const = 0;
};

// The first line of either source. Both outlive this.
class TwoLineSources final : public LineSource {
  public:
    TwoLineSources(LineSource& one, LineSource& other) : one_(&one), other_(&other) {}
    std::optional<std::string> take_line() override {
        auto line = one_->take_line();
        return line ? line : other_->take_line();
    }
    bool ended() const override { return one_->ended() && other_->ended(); }

  private:
    LineSource *one_, *other_;
};

class DescriptorLines final : public LineSource {
  public:
    explicit DescriptorLines(int descriptor) : descriptor_(descriptor) {}
    std::optional<std::string> take_line() override;
    bool ended() const override { return ended_ && buffer_.empty(); }

  private:
    void read_what_is_there();

    int descriptor_;
    std::string buffer_;
    bool ended_ = false;
};

}  // namespace thimble
