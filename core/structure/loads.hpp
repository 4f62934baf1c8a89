// The loads of a problem, and their signals between two knots.
#pragma once

#include <algorithm>
#include <vector>

#include "structure/signal.hpp"
#include "structure/taylor_series.hpp"

namespace rattlebox {

struct Load {
    Signal signal;
    std::vector<real> shape; // force on each mode per unit of the signal; for a base acceleration, minus the
                             // participation factor
    bool base = false;       // whether it is a base acceleration, which also acts on balls as -m b''
};

class Loads {
    const std::vector<Load>& loads_;
    std::vector<Piece> pieces_;
    bool any_active_ = false;
    real next_knot_ = infinity;
    real frequency_ = 0;

public:
    explicit Loads(const std::vector<Load>& loads) : loads_(loads), pieces_(loads.size()) { advance(0); }

    // Selects the pieces that are valid from t to the next knot.
    void advance(real t) {
        any_active_ = false;
        next_knot_ = infinity;
        frequency_ = 0;
        for (std::size_t l = 0; l < loads_.size(); ++l) {
            pieces_[l] = loads_[l].signal.piece(t);
            any_active_ = any_active_ || !pieces_[l].is_zero();
            next_knot_ = std::min(next_knot_, loads_[l].signal.next_knot(t));
            if (pieces_[l].amplitude != 0) frequency_ = std::max(frequency_, pieces_[l].frequency);
        }
    }

    bool active() const { return any_active_; }
    real next_knot() const { return next_knot_; }
    real frequency() const { return frequency_; } // highest, rad/s
    std::size_t size() const { return loads_.size(); }
    const Load& load(std::size_t l) const { return loads_[l]; }
    const Piece& piece(std::size_t l) const { return pieces_[l]; }
};

} // namespace rattlebox
