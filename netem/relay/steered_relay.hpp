// A running relay as the control socket sees it: its settings can be read and changed.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "netem/relay/relay_totals.hpp"

namespace thimble {

class SteeredRelay : boost::noncopyable {
  public:
    virtual ~SteeredRelay() = default;
    // From now on other links; what is in flight keeps its fate.
    virtual void change(SessionTime now, const LinkPair& links) = 0;
    virtual RelayState state(SessionTime now) const = 0;
};

}  // namespace thimble
