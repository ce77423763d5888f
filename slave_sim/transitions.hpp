// The changes within a step: which element entered which phase, and when. Several changes can share one
// instant (a fast needle touches and pierces at once); each is recorded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace thimble {

struct Transition {
    double offset_s;         // from the start of the step
    std::uint32_t element;   // which one, in the order of the scene's declaration
    std::string_view phase;  // entered; points to text that lives as long as the program
};

// In the order of time for one element; elements follow one another. A list with a limit never allocates
// after its construction, and counts what found no room.
class Transitions {
  public:
    static constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

    explicit Transitions(std::size_t limit = 16) : limit_(limit) { list_.reserve(limit < 64 ? limit : 64); }

    void clear() { list_.clear(); }
    // Sets the element to which the next transitions belong.
    void of(std::uint32_t element) { element_ = element; }
    void push(double offset_s, std::string_view phase) {
        if (list_.size() < limit_) {
            list_.push_back({offset_s, element_, phase});
        } else {
            ++overflows_;
        }
    }

    std::size_t size() const { return list_.size(); }
    const Transition& operator[](std::size_t i) const { return list_[i]; }
    auto begin() const { return list_.begin(); }
    auto end() const { return list_.end(); }
    std::uint64_t overflows() const { return overflows_; }  // transitions that found no room, ever

  private:
    std::vector<Transition> list_;
    std::size_t limit_;
    std::uint64_t overflows_ = 0;
    std::uint32_t element_ = 0;
};

}  // namespace thimble
