// Some members of a batch as one block of bytes, from which a GPU makes the problem of each.
//
// The bytes of one problem come first, in the order in which `transfer` names its parts; then, for each
// number that varies, its place among these bytes and its value for each member.
#pragma once

#include <cstring>

#include "impact/batch.hpp"
#include "impact/member.hpp"
#include "impact/run.hpp"

namespace rattlebox {

// Everything that a problem and what is looked at consist of, for writing and reading alike.
template <class Archive> void transfer(Archive& a, Problem& p, Window& window, Wanted& wanted) {
    a(p.settings, p.modes, p.start, p.contacts, p.ball_mass, p.ball_position, p.ball_velocity, p.ball_damper);
    a.each(p.loads, [&](Load& l) { a(l.signal, l.shape, l.base); });
    a.each(p.dampers,
           [&](Damper& d) { a(d.first_ball, d.balls, d.first_contact, d.clearance, d.gravity, d.shape); });
    a.each(p.tables, [&](std::vector<real>& table) { a(table); });
    a(window.from, window.period, window.samples, window.shape);
    a(wanted.measures, wanted.motion, wanted.state, wanted.last);
}

// Views of tables: found again by where their tables lay when they were written.
template <class F> void each_view(Problem& p, F&& f) {
    for (Load& l : p.loads) {
        f(l.signal.times);
        f(l.signal.values);
    }
    for (Contact& c : p.contacts)
        c.restitution.change([&](auto& law) {
            if constexpr (requires { law.tables; })
                for (const auto& table : law.tables) f(law.*table.member);
        });
}

namespace image {

inline constexpr std::size_t grain = sizeof(real); // every part begins at a multiple of it

struct Head {
    std::size_t members, problem, old_tables, columns, values; // number of members; where parts begin
    std::size_t tables, varying;                               // how many there are
};

// Reads member i.
class Reader {
    const char* bytes_;
    const Head& head_;
    std::size_t at_, member_, next_ = 0; // column

    template <class T> T part(std::size_t from, std::size_t i) const {
        return reinterpret_cast<const T*>(bytes_ + from)[i];
    }

    template <class T> void get(T* to, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t size = count * sizeof(T);
        std::memcpy(static_cast<void*>(to), bytes_ + at_, size);
        for (; next_ < head_.varying; ++next_) {
            const auto place = part<std::size_t>(head_.columns, next_);
            if (place >= at_ + size) break;
            const real value = part<real>(head_.values, next_ * head_.members + member_);
            std::memcpy(reinterpret_cast<char*>(to) + (place - at_), &value, sizeof(real));
        }
        at_ += (size + grain - 1) / grain * grain;
    }
    template <class T> void one(T& value) { get(&value, 1); }
    template <class T> void one(std::vector<T>& values) {
        std::size_t count;
        get(&count, 1);
        values.resize(count);
        get(values.data(), count);
    }

public:
    Reader(const char* bytes, std::size_t member)
        : bytes_(bytes), head_(*reinterpret_cast<const Head*>(bytes)), at_(head_.problem), member_(member) {}

    std::size_t members() const { return head_.members; }

    template <class... T> void operator()(T&... values) { (one(values), ...); }
    template <class T, class F> void each(std::vector<T>& values, F&& f) {
        std::size_t count;
        get(&count, 1);
        values.resize(count);
        for (T& value : values) f(value);
    }

    void read(Problem& problem, Window& window, Wanted& wanted) {
        transfer(*this, problem, window, wanted);
        each_view(problem, [&](Table& view) {
            for (std::size_t t = 0; t < head_.tables; ++t)
                if (part<const real*>(head_.old_tables, t) == view.data) view.data = problem.tables[t].data();
        });
    }
};

} // namespace image

// The problem of one member, solved on its own: what a thread of a GPU does.
inline void work(const char* bytes, std::size_t member, Kept kept, const std::atomic<bool>* stop) {
    Problem problem;
    Window window;
    Wanted wanted;
    image::Reader reader(bytes, member);
    reader.read(problem, window, wanted);
    window.place(problem);
    wanted.limit_log(problem, window);
    kept.members = reader.members();
    kept.lay(problem, window, wanted);
    kept.keep(member, problem, window, wanted, run(problem, stop));
}

} // namespace rattlebox
