// Runs the members of a batch and keeps of each only what was asked for.
#pragma once

#include <algorithm>
#include <atomic>
#include <memory>

#include "impact/measures.hpp"
#include "impact/run.hpp"
#include "python/crew.hpp"
#include "python/read.hpp"
#include "python/write.hpp"

namespace rattlebox::door {

// One thread's own problem, which its columns write into.
struct Worker {
    Problem problem;
    Batch batch;
    Window window;
};

struct Wanted {
    std::vector<const Measure*> measures;
    bool motion = false, state = false;
    std::size_t last = 0; // impacts at the end
};

class Sweep {
    Wanted wanted_;
    std::size_t first_, count_, samples_ = 0, balls_ = 0, states_ = 0;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::vector<std::vector<real>> values_;
    std::vector<real> displacement_, velocity_, place_, speed_, state_;
    std::vector<real> last_time_, last_speed_, last_contact_;
    std::vector<std::int8_t> status_;

    void keep(const Worker& worker, const Result& result, std::size_t i) {
        status_[i] = static_cast<std::int8_t>(result.status);
        if (result.status != Status::finished) return;
        const Observer seen(worker.problem, result, worker.window);
        if (!seen.closes(worker.problem.settings.closure_bound()))
            status_[i] = static_cast<std::int8_t>(Status::ledger_open);
        for (std::size_t m = 0; m < values_.size(); ++m) values_[m][i] = wanted_.measures[m]->value(seen);
        for (std::size_t s = 0; wanted_.motion && s < samples_; ++s) {
            const ModeState z = seen.point(s);
            displacement_[i * samples_ + s] = z.q;
            velocity_[i * samples_ + s] = z.p;
            for (std::size_t b = 0; b < balls_; ++b) {
                const std::size_t at = (i * samples_ + s) * balls_ + b;
                const auto damper = static_cast<std::size_t>(worker.problem.ball_damper[b]);
                const ModeState c = seen.along(worker.problem.dampers[damper].shape, s);
                place_[at] = positions(worker.problem, seen.state(s))[b] - c.q;
                speed_[at] = velocities(worker.problem, seen.state(s))[b] - c.p;
            }
        }
        if (wanted_.state) std::copy_n(seen.state(seen.last()), states_, state_.data() + i * states_);
        const std::size_t known = std::min(wanted_.last, result.impacts.size());
        for (std::size_t k = 0; k < known; ++k) {
            const Impact& impact = result.impacts[result.impacts.size() - known + k];
            const std::size_t at = (i + 1) * wanted_.last - known + k;
            last_time_[at] = impact.time;
            last_speed_[at] = impact.approach_speed;
            last_contact_[at] = impact.contact;
        }
    }

public:
    Sweep(const nb::dict& packed, const std::vector<std::size_t>& shape, std::size_t first, std::size_t count,
          const nb::dict& window, Wanted wanted, int threads)
        : wanted_(std::move(wanted)), first_(first), count_(count) {
        for (int t = 0; t < threads; ++t) {
            auto worker = std::make_unique<Worker>();
            worker->batch.shape = shape;
            Reader reader(worker->problem, &worker->batch);
            reader.problem(packed);
            reader.number(worker->window.from, window, "from");
            reader.number(worker->window.period, window, "period");
            reader.vector(worker->window.shape, window["shape"]);
            worker->window.samples = nb::cast<int>(window["samples"]);
            worker->problem.settings.peaks = std::any_of(wanted_.measures.begin(), wanted_.measures.end(),
                                                         [](const Measure* m) { return m->peaks; });
            workers_.push_back(std::move(worker));
        }
        const Problem& problem = workers_.at(0)->problem;
        samples_ = static_cast<std::size_t>(workers_[0]->window.samples);
        balls_ = problem.ball_mass.size();
        states_ = 2 * (problem.modes.size() + balls_);
        values_.assign(wanted_.measures.size(), std::vector<real>(count, not_a_number));
        status_.assign(count, static_cast<std::int8_t>(Status::interrupted));
        if (wanted_.motion) {
            displacement_.assign(count * samples_, not_a_number);
            velocity_ = displacement_;
            place_.assign(count * samples_ * balls_, not_a_number);
            speed_ = place_;
        }
        if (wanted_.state) state_.assign(count * states_, not_a_number);
        last_time_.assign(count * wanted_.last, not_a_number);
        last_speed_ = last_contact_ = last_time_;
    }

    std::size_t size() const { return count_; }

    void run(std::size_t i, int thread, const std::atomic<bool>& stop) {
        Worker& worker = *workers_[static_cast<std::size_t>(thread)];
        worker.batch.apply(first_ + i);
        worker.window.place(worker.problem);
        keep(worker, rattlebox::run(worker.problem, &stop), i);
    }

    nb::dict results() {
        nb::dict d;
        d["status"] = array(std::move(status_));
        for (std::size_t m = 0; m < values_.size(); ++m)
            d[wanted_.measures[m]->name] = array(std::move(values_[m]));
        if (wanted_.motion) {
            d["displacement"] = array(std::move(displacement_), {count_, samples_});
            d["velocity"] = array(std::move(velocity_), {count_, samples_});
            d["ball_place"] = array(std::move(place_), {count_, samples_, balls_});
            d["ball_speed"] = array(std::move(speed_), {count_, samples_, balls_});
        }
        if (wanted_.state) d["state"] = array(std::move(state_), {count_, states_});
        if (wanted_.last > 0) {
            d["last_time"] = array(std::move(last_time_), {count_, wanted_.last});
            d["last_approach_speed"] = array(std::move(last_speed_), {count_, wanted_.last});
            d["last_contact"] = array(std::move(last_contact_), {count_, wanted_.last});
        }
        return d;
    }
};

// Members start to stop of a batch; None when `progress` has answered False.
inline nb::object sweep(const nb::dict& packed, const std::vector<std::size_t>& shape, std::size_t start,
                        std::size_t stop, const std::vector<std::string>& names, const nb::dict& window,
                        bool motion, bool state, std::size_t last, int threads, const nb::object& progress) {
    Wanted wanted{{}, motion, state, last};
    for (const std::string& name : names) {
        const Measure* found = nullptr;
        for (const Measure& m : measures)
            if (name == m.name) found = &m;
        if (!found) throw std::invalid_argument("the core has no measure named '" + name + "'");
        wanted.measures.push_back(found);
    }
    Sweep sweep(packed, shape, start, stop - start, window, std::move(wanted), threads);
    const bool whole = work_off(
        sweep.size(), threads, 4,
        [&](std::size_t i, int thread, const std::atomic<bool>& stopped) { sweep.run(i, thread, stopped); },
        [&](std::size_t done) { return progress.is_none() || !progress(done).is(nb::bool_(false)); });
    if (!whole) return nb::none();
    return sweep.results();
}

} // namespace rattlebox::door
