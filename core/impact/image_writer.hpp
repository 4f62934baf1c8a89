// Writes some members of a batch as one block of bytes (impact/image.hpp), and says what it takes to run
// them.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "impact/image.hpp"

namespace rattlebox::image {

class Writer {
    struct Piece {
        const char* from;
        std::size_t size, at;
    };
    std::vector<Piece> pieces_;

    template <class T> void put(const T* data, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* from = reinterpret_cast<const char*>(data);
        pieces_.push_back({from, count * sizeof(T), bytes.size()});
        bytes.insert(bytes.end(), from, from + count * sizeof(T));
        bytes.resize((bytes.size() + grain - 1) / grain * grain);
    }
    template <class T> void one(const T& value) { put(&value, 1); }
    template <class T> void one(const std::vector<T>& values) {
        const std::size_t count = values.size();
        put(&count, 1);
        put(values.data(), count);
    }

public:
    std::vector<char> bytes;

    template <class... T> void operator()(const T&... values) { (one(values), ...); }
    template <class T, class F> void each(std::vector<T>& values, F&& f) {
        const std::size_t count = values.size();
        put(&count, 1);
        for (T& value : values) f(value);
    }

    // Where a number of the problem stands among the bytes.
    std::size_t place(const real* number) const {
        const auto* at = reinterpret_cast<const char*>(number);
        for (const Piece& p : pieces_)
            if (at >= p.from && at < p.from + p.size) return p.at + static_cast<std::size_t>(at - p.from);
        throw std::logic_error("a number that varies is not in the image");
    }
};

// Members first to first + count of a batch whose columns point into the problem and the window.
inline std::vector<char> write(Problem& problem, const Batch& batch, Window& window, Wanted& wanted,
                               std::size_t first, std::size_t count) {
    Writer writer;
    Head head{count, sizeof(Head), 0, 0, 0, problem.tables.size(), batch.columns.size()};
    writer(head);
    transfer(writer, problem, window, wanted);
    head.old_tables = writer.bytes.size();
    for (const auto& table : problem.tables) writer(table.data());
    std::vector<std::pair<std::size_t, const Column*>> columns;
    for (const Column& c : batch.columns) columns.push_back({writer.place(c.target), &c});
    std::sort(columns.begin(), columns.end());
    head.columns = writer.bytes.size();
    for (const auto& [place, column] : columns) writer(place);
    head.values = writer.bytes.size();
    writer.bytes.resize(head.values + columns.size() * count * sizeof(real));
    auto* values = reinterpret_cast<real*>(writer.bytes.data() + head.values);
    for (const auto& [place, column] : columns)
        for (std::size_t i = 0; i < count; ++i) *values++ = column->data[batch.offset(*column, first + i)];
    std::memcpy(writer.bytes.data(), &head, sizeof head);
    return std::move(writer.bytes);
}

// A bound on the bytes of all vectors of one member while it runs, tables and samples included.
inline std::size_t memory(const Problem& problem, const Window& window, const Wanted& wanted) {
    const std::size_t m = problem.modes.size(), b = problem.ball_mass.size(), c = problem.contacts.size(),
                      d = problem.dampers.size(), l = problem.loads.size(),
                      n = 2 * (m + b) + 4 + 2 * c, // of the equations of closed contacts
        samples = static_cast<std::size_t>(window.samples);
    std::size_t tables = 0;
    for (const auto& table : problem.tables) tables += table.size() * sizeof(real);
    const std::size_t small = sizeof(Problem) + c * (sizeof(Contact) + 64) + d * (sizeof(Damper) + 64) +
                              l * (sizeof(Load) + 64) + 64 * (m + b) + 8 * m * (d + l),
                      rows = 2 * (2 * (2 * m + 3) + 5 * m + l) * sizeof(PhaseGrid::Rule::Row),
                      series = (m + b + 4 * l) * (sizeof(Series) + sizeof(FreeMode)),
                      vectors = 8 * (24 + 12) * n + 8 * 4 * c * c,
                      log = 2 * 2 * (wanted.last + c + 4) * sizeof(Impact),
                      sampled = samples * 8 * (5 + 2 * (m + b) + 4 * d);
    return tables + sampled + 2 * (small + rows + series + vectors + log) + 16384;
}

} // namespace rattlebox::image
