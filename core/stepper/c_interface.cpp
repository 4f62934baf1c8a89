#include "rattlebox.h"

#include <exception>
#include <new>

#include "stepper/engines.hpp"
#include "stepper/stepper.hpp"

// The object to which a handle points.
struct rattlebox_stepper {
    std::vector<std::uint8_t> packed;
    rattlebox::Stepper stepper;
    std::string error;
    std::vector<std::uint8_t> saved;

    rattlebox_stepper(const void* packed_case, std::size_t size)
        : packed(static_cast<const std::uint8_t*>(packed_case),
                 static_cast<const std::uint8_t*>(packed_case) + size),
          stepper(packed.data(), size) {}
};

using rattlebox::Status;

namespace {

thread_local std::string creation_error;

// Calls f and stores the text of an exception; no exception leaves the library.
template <class F> bool guarded(std::string& error, F&& f) noexcept {
    try {
        f();
        return true;
    } catch (const std::bad_alloc&) {
        error.assign("no memory");
    } catch (const std::exception& e) {
        try {
            error = e.what();
        } catch (...) {
            error.clear();
        }
    } catch (...) {
        error.assign("unknown error");
    }
    return false;
}

void require(bool holds) {
    if (!holds) throw std::invalid_argument("a pointer is NULL");
}

template <class F> int advance(rattlebox_stepper* s, const double* inputs, F&& f) {
    if (!s) return 1;
    Status status = Status::finished;
    const bool works = guarded(s->error, [&] {
        require(inputs || s->stepper.inputs() == 0);
        status = f();
        if (status != Status::finished) s->error = rattlebox::stop_reason(status);
    });
    return !works || status != Status::finished;
}

void copy(const rattlebox::Components& from, double* to) { std::copy(from.begin(), from.end(), to); }

} // namespace

extern "C" {

rattlebox_stepper* rattlebox_create(const void* packed_case, size_t size) {
    rattlebox_stepper* made = nullptr;
    guarded(creation_error, [&] {
        require(packed_case);
        made = new rattlebox_stepper(packed_case, size);
    });
    return made;
}
void rattlebox_free(rattlebox_stepper* s) { delete s; }

const char* rattlebox_error(const rattlebox_stepper* s) {
    return s ? s->error.c_str() : creation_error.c_str();
}

int rattlebox_is_alone(const rattlebox_stepper* s) { return s->stepper.is_alone(); }
int rattlebox_components(const rattlebox_stepper* s) { return s->stepper.components(); }
int rattlebox_dampers(const rattlebox_stepper* s) { return s->stepper.dampers(); }
int rattlebox_inputs(const rattlebox_stepper* s) { return s->stepper.inputs(); }
int rattlebox_outputs(const rattlebox_stepper* s) { return s->stepper.outputs(); }

int rattlebox_set_gravity(rattlebox_stepper* s, const double* gravity) {
    return !s || !guarded(s->error, [&] {
        require(gravity);
        rattlebox::Components g{};
        for (std::size_t a = 0; a < (s->stepper.components() == 1 ? 1u : 3u); ++a) g[a] = gravity[a];
        s->stepper.set_gravity(g);
    });
}

double rattlebox_restitution(const rattlebox_stepper* s) { return s->stepper.options().restitution; }
double rattlebox_friction(const rattlebox_stepper* s) { return s->stepper.options().friction; }
int rattlebox_choose(rattlebox_stepper* s, double restitution, double friction, const double* velocity) {
    return !s || !guarded(s->error, [&] {
        if (s->stepper.time() > 0)
            throw std::invalid_argument("this can be chosen before the first step only");
        rattlebox::Options options{restitution, friction};
        if (velocity) std::copy_n(velocity, s->stepper.components() == 1 ? 1 : 3, options.velocity);
        const rattlebox::Components gravity = s->stepper.gravity();
        s->stepper = rattlebox::Stepper(s->packed.data(), s->packed.size(), options);
        if (gravity != s->stepper.gravity()) s->stepper.set_gravity(gravity);
    });
}

int rattlebox_advance(rattlebox_stepper* s, double length, const double* inputs) {
    return advance(s, inputs, [&] { return s->stepper.advance(length, inputs); });
}
int rattlebox_advance_to_velocity(rattlebox_stepper* s, double length, const double* velocity) {
    return advance(s, velocity, [&] {
        if (!s->stepper.is_alone())
            throw std::invalid_argument("a structure with dampers is driven by its loads");
        return s->stepper.advance_to_velocity(length, velocity);
    });
}

double rattlebox_time(const rattlebox_stepper* s) { return s->stepper.time(); }
void rattlebox_force(const rattlebox_stepper* s, int damper, double* force) {
    copy(s->stepper.result().force[static_cast<size_t>(damper)], force);
}
void rattlebox_moment(const rattlebox_stepper* s, int damper, double* moment) {
    copy(s->stepper.result().moment[static_cast<size_t>(damper)], moment);
}
double rattlebox_work(const rattlebox_stepper* s) { return s->stepper.result().work; }
double rattlebox_loss(const rattlebox_stepper* s) { return s->stepper.result().loss; }
double rattlebox_stored(const rattlebox_stepper* s) { return s->stepper.result().stored; }

void rattlebox_motion(const rattlebox_stepper* s, double* displacement, double* velocity) {
    const rattlebox::Stepper& stepper = s->stepper;
    const int n = stepper.is_alone() ? stepper.components() : stepper.outputs();
    for (int i = 0; i < n; ++i) {
        const auto k = static_cast<size_t>(i);
        if (displacement)
            displacement[i] = stepper.is_alone() ? stepper.displacement()[k] : stepper.output(i, false);
        if (velocity) velocity[i] = stepper.is_alone() ? stepper.velocity()[k] : stepper.output(i, true);
    }
}

const void* rattlebox_save(rattlebox_stepper* s, size_t* size) {
    if (!s || !guarded(s->error, [&] {
            require(size);
            s->saved = s->stepper.save();
        }))
        return nullptr;
    *size = s->saved.size();
    return s->saved.data();
}
int rattlebox_restore(rattlebox_stepper* s, const void* state, size_t size) {
    return !s || !guarded(s->error, [&] {
        require(state);
        s->stepper.restore(static_cast<const std::uint8_t*>(state), size);
    });
}

} // extern "C"
