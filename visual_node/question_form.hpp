// The answer that a subject is about to give: chosen with the mouse or by keys, given with Enter or a click on OK. Nothing is chosen
// at first: a default would look like an answer.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "visual_node/display.hpp"
#include "visual_node/page_set.hpp"

namespace thimble {

class QuestionForm {
  public:
    // Which question is shown; null: none. The same one again changes nothing. `question` outlives its time on the screen.
    void show(std::uint32_t number, const Question* question) {
        if (number == number_ && question == question_) return;
        number_ = number;
        question_ = question;
        value_.reset();
        read_ = false;
        pages_ = 0;
    }

    std::uint32_t number() const { return number_; }
    const Question* question() const { return question_; }
    const std::optional<double>& value() const { return value_; }

    // The nearest answer that the question has.
    void choose(double value) {
        if (question_ == nullptr) return;
        const Question& q = *question_;
        const double steps = std::round((std::clamp(value, q.from, q.to) - q.from) / q.step);
        value_ = std::min(q.from + steps * q.step, q.to);
    }

    // An arrow key. The first one goes to the middle of a scale, else to the first or the last answer.
    void move(int steps) {
        if (question_ == nullptr) return;
        const Question& q = *question_;
        if (value_) return choose(*value_ + steps * q.step);
        if (q.kind == QuestionKind::kScale) return choose((q.from + q.to) / 2);
        choose(steps > 0 ? q.from : q.to);
    }

    // Of a number one digit after another, the most instead of more; of a choice and of a likert scale the answer itself.
    void type(int digit) {
        if (question_ == nullptr || question_->kind == QuestionKind::kScale) return;
        const Question& q = *question_;
        if (q.kind == QuestionKind::kNumber) {
            // After a number below zero, which an arrow key has chosen, digits begin anew.
            value_ = std::min(10 * std::max(0.0, value_.value_or(0)) + digit, q.to);
        } else if (digit >= q.from && digit <= q.to) {
            value_ = digit;
        }
    }

    void clear() { value_.reset(); }

    // A question that is longer than the screen: how many pages to turn since the last call, and that its end has been shown.
    void turn_pages(int pages) { pages_ += pages; }
    int take_pages() { return std::exchange(pages_, 0); }
    void read_to_end() { read_ = true; }

    // Nothing while nothing is chosen, a number is still too small, or the question has not been shown to its end.
    std::optional<GivenAnswer> given() const {
        if (question_ == nullptr || !read_ || !value_ || !question_->accepts(*value_)) return std::nullopt;
        return GivenAnswer{number_, *value_};
    }

  private:
    std::uint32_t number_ = 0;
    const Question* question_ = nullptr;
    std::optional<double> value_;
    bool read_ = false;
    int pages_ = 0;
};

}  // namespace thimble
