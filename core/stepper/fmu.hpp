// A co-simulation FMU: variables of a stepper by number, steps from inputs at one end of each step, and
// states. Independent of the version of FMI; stepper/fmu.cpp has the functions of FMI 2 and 3.
#pragma once

#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "stepper/stepper.hpp"

namespace rattlebox::fmu {

// Value references. Where several numbers follow each other, these are the first ones.
enum Reference : unsigned {
    time = 0,
    input_time = 1, // start or end
    gravity = 2,    // 2 to 4
    restitution = 5,
    friction = 6,
    work = 7, // sums since the start
    loss = 8,
    stored = 9,
    input = 10,
    force = 100,  // three for each damper
    moment = 400, // three
    displacement = 1000,
    velocity = 2000,
};

// To which end of a step the values of the inputs belong.
enum InputTime : int { start = 1, end = 2 };

// A value that contacts should not exceed: of the overlap or the approach speed with this index.
struct Limit {
    bool speed = false;
    std::size_t index = 0;
    real value = 0;
    std::string text; // consequence of exceeding it, and advice
    bool exceeded = false;
};

class Fmu {
    std::vector<std::uint8_t> packed_;
    std::vector<Limit> limits_;
    bool by_velocity_; // whether the inputs are velocities
    Options options_;
    Components gravity_{};
    int input_time_ = end;
    std::vector<real> input_, before_; // now, and at the end of the last step
    real length_ = 0;                  // of the last step
    real work_ = 0, loss_ = 0, origin_ = 0;
    bool began_ = false, ended_ = false, start_reported_ = false;
    Stepper stepper_;

    static std::vector<std::uint8_t> read(const std::string& path) {
        const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                                   std::fclose);
        std::vector<std::uint8_t> bytes, part(1 << 16);
        if (file)
            while (const std::size_t n = std::fread(part.data(), 1, part.size(), file.get()))
                bytes.insert(bytes.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(n));
        if (bytes.empty()) throw std::runtime_error(path + " cannot be read");
        return bytes;
    }

    // Lines of quantity, index, value and text, after a comment. A value is the integer with the same bits,
    // because importers may have set a locale with a decimal comma.
    static std::vector<Limit> read_limits(const std::string& path) {
        const std::vector<std::uint8_t> bytes = read(path);
        const std::string text(bytes.begin(), bytes.end());
        std::vector<Limit> limits;
        for (std::size_t from = 0, to; from < text.size(); from = to + 1) {
            to = std::min(text.find('\n', from), text.size());
            const std::string line = text.substr(from, to - from);
            if (line.empty() || line[0] == '#') continue;
            char quantity[16];
            unsigned long long index, value;
            int begin = 0;
            if (std::sscanf(line.c_str(), "%15s %llu %llu %n", quantity, &index, &value, &begin) < 3)
                throw std::runtime_error(path + " is damaged");
            limits.push_back({std::strcmp(quantity, "speed") == 0, static_cast<std::size_t>(index),
                              std::bit_cast<real>(static_cast<std::uint64_t>(value)),
                              line.substr(static_cast<std::size_t>(begin))});
        }
        return limits;
    }

    std::size_t count() const {
        return static_cast<std::size_t>(stepper_.is_alone() ? stepper_.components() : stepper_.inputs());
    }

    template <class Archive> void serialize(Archive& archive) {
        archive(options_, gravity_, input_time_, input_, before_, length_, work_, loss_, origin_, began_,
                ended_);
    }

    void make() {
        stepper_ = Stepper(packed_.data(), packed_.size(), options_);
        // Dampers of one case may have different gravity until the importer changes it.
        if (gravity_ != stepper_.gravity()) stepper_.set_gravity(gravity_);
    }

    void read_state(const std::uint8_t* bytes, std::size_t size) {
        Reader reader(reinterpret_cast<const char*>(bytes), size);
        std::vector<std::uint8_t> inner;
        serialize(reader);
        reader(inner);
        if (!reader.at_end() || input_.size() != count() || before_.size() != count() ||
            (input_time_ != start && input_time_ != end))
            throw std::invalid_argument("the state is of another case");
        make();
        stepper_.restore(inner.data(), inner.size());
    }

    // Values of the inputs for a step: velocities at its end, or means over the step. Inputs of the start are
    // extrapolated linearly.
    std::vector<real> values(real length) const {
        std::vector<real> result = input_;
        const real ratio = length_ > 0 ? length / length_ : 0;
        for (std::size_t i = 0; i < result.size(); ++i) {
            const real change = input_[i] - before_[i];
            if (input_time_ == start)
                result[i] += ratio * change * (by_velocity_ ? 1 : 0.5);
            else if (!by_velocity_)
                result[i] -= 0.5 * change;
        }
        return result;
    }

public:
    explicit Fmu(const std::string& resources)
        : packed_(read(resources + "/case.bin")), limits_(read_limits(resources + "/limits")),
          by_velocity_(read(resources + "/input").at(0) == 'v'), stepper_(packed_.data(), packed_.size()) {
        gravity_ = stepper_.gravity();
        input_.assign(count(), 0.0);
        before_ = input_;
    }

    // Starts again, with the variables as they are at first.
    void reset() {
        options_ = Options{};
        stepper_ = Stepper(packed_.data(), packed_.size());
        gravity_ = stepper_.gravity();
        input_time_ = end;
        input_.assign(count(), 0.0);
        before_ = input_;
        length_ = work_ = loss_ = origin_ = 0;
        began_ = ended_ = false;
        start_reported_ = false;
        for (Limit& limit : limits_) limit.exceeded = false;
    }

    // Sets the time of the start.
    void set_origin(real time) {
        if (!(std::fabs(time) < infinity)) throw std::invalid_argument("the start time is not finite");
        origin_ = time;
    }

    // Fixes the parameters and, from the inputs, the initial velocity of the attachment.
    void initialize() {
        if (ended_)
            throw std::invalid_argument("the simulation was terminated; reset the FMU to begin again");
        if (stepper_.is_alone() && by_velocity_)
            std::copy_n(input_.begin(), input_.size() == 1 ? 1 : 3, options_.velocity);
        make();
        before_ = input_;
        began_ = true;
    }

    void terminate() { ended_ = true; }

    real get(unsigned reference) const {
        const auto within = [&](unsigned first, std::size_t n) {
            return reference >= first && reference < first + n;
        };
        const auto components = static_cast<std::size_t>(stepper_.components());
        const auto dampers = static_cast<std::size_t>(stepper_.dampers()),
                   rows = stepper_.is_alone() ? components : static_cast<std::size_t>(stepper_.outputs());
        const auto triple = [&](const std::vector<Components>& all, unsigned first) {
            return all[(reference - first) / 3][(reference - first) % 3];
        };
        if (reference == time) return origin_ + stepper_.time();
        if (within(gravity, components)) return gravity_[reference - gravity];
        if (reference == restitution) return stepper_.options().restitution;
        if (reference == friction) return stepper_.options().friction;
        if (reference == work) return work_;
        if (reference == loss) return loss_;
        if (reference == stored) return stepper_.result().stored;
        if (within(input, input_.size())) return input_[reference - input];
        if (within(force, 3 * dampers)) return triple(stepper_.result().force, force);
        if (within(moment, 3 * dampers)) return triple(stepper_.result().moment, moment);
        const bool rate = within(velocity, rows);
        if (!rate && !within(displacement, rows)) throw std::invalid_argument("there is no such variable");
        const unsigned row = reference - (rate ? velocity : displacement);
        if (stepper_.is_alone()) return rate ? stepper_.velocity()[row] : stepper_.displacement()[row];
        return stepper_.output(static_cast<int>(row), rate);
    }

    void set(unsigned reference, real value) {
        if (!(std::fabs(value) < infinity)) throw std::invalid_argument("a value is not finite");
        if (reference >= input && reference < input + input_.size()) {
            input_[reference - input] = value;
        } else if (reference >= gravity &&
                   reference < gravity + static_cast<unsigned>(stepper_.components())) {
            gravity_[reference - gravity] = value;
            stepper_.set_gravity(gravity_);
        } else if (reference == restitution || reference == friction) {
            if (began_) throw std::invalid_argument("this parameter is fixed after the initialization");
            (reference == restitution ? options_.restitution : options_.friction) = value;
            make(); // raises an error if the value is not possible
        } else {
            throw std::invalid_argument("this variable cannot be set");
        }
    }

    int choice(unsigned reference) const {
        if (reference != input_time) throw std::invalid_argument("there is no such variable");
        return input_time_;
    }
    void choose(unsigned reference, std::int64_t value) {
        if (reference != input_time) throw std::invalid_argument("there is no such variable");
        if (value != start && value != end) throw std::invalid_argument("input_time is 1 (start) or 2 (end)");
        input_time_ = static_cast<int>(value);
    }

    void step(real from, real length) {
        if (!began_) throw std::invalid_argument("a step before the end of the initialization");
        if (ended_)
            throw std::invalid_argument(
                "a step after the simulation was terminated; reset the FMU to begin again");
        if (!(length > 0 && length < infinity))
            throw std::invalid_argument("a step must be longer than zero, and finite");
        if (!(std::fabs(from - get(time)) <= 1e-3 * length + 1e-9 * std::fabs(from)))
            throw std::invalid_argument(
                "the step does not begin where the last one ended; restore a state to go back");
        const std::vector<real> given = values(length);
        const bool velocities = stepper_.is_alone() && by_velocity_;
        const Status status = velocities ? stepper_.advance_to_velocity(length, given.data())
                                         : stepper_.advance(length, given.data());
        if (status != Status::finished) throw std::runtime_error(stop_reason(status));
        before_ = input_;
        length_ = length;
        work_ += stepper_.result().work;
        loss_ += stepper_.result().loss;
    }

    // Returns the texts of the limits that contacts have exceeded since the last call; each of them once.
    std::vector<std::string> warnings() {
        std::vector<std::string> texts;
        if (stepper_.start_jump() > 0 && !start_reported_) {
            start_reported_ = true;
            texts.push_back(
                "the velocity of the attachment jumped in the first step, as if its initial value had been "
                "forgotten: set the input velocity before the end of the initialization");
        }
        const Extremes extremes = stepper_.extremes();
        for (Limit& limit : limits_) {
            const std::vector<real>& largest = limit.speed ? extremes.speed : extremes.overlap;
            if (limit.exceeded || limit.index >= largest.size() || !(largest[limit.index] > limit.value))
                continue;
            for (Limit& other : limits_) other.exceeded |= other.text == limit.text;
            texts.push_back(limit.text);
        }
        return texts;
    }

    std::vector<std::uint8_t> save() {
        const std::vector<std::uint8_t> inner = stepper_.save();
        Sizer size;
        serialize(size);
        size(inner);
        Writer writer(size.bytes);
        serialize(writer);
        writer(inner);
        return std::move(writer.bytes);
    }

    // A damaged state changes nothing.
    void restore(const std::uint8_t* bytes, std::size_t size) {
        const std::vector<std::uint8_t> now = save();
        try {
            read_state(bytes, size);
        } catch (...) {
            read_state(now.data(), now.size());
            throw;
        }
    }
};

} // namespace rattlebox::fmu
