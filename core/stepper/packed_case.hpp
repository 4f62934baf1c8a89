// Packed cases: the bytes from which a stepper is made, without Python.
//
//     "RATTLEBX"   magic, 8 bytes
//     i64          version of the format
//     i64          engine: 1 impact dampers (1-D), 2 particle dampers (3-D)
//     i64          number of bytes that follow the header
//     u64          FNV-1a hash of these bytes
//
// Then the fields in the order of pack() below. A real is an IEEE 754 double, an integer or a choice an i64,
// a list its length and then its items; a law is the number of its name in the table of laws, its
// coefficients in the order of its `fields`, and its tables. All numbers are little-endian.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <vector>

#include "stepper/packed_check.hpp"

namespace rattlebox {

enum class Engine : std::int64_t { impact = 1, particles = 2 };

template <class Problem> struct PackedCase {
    Problem problem;
    Component component;
    std::deque<std::vector<real>> tables; // of the laws of the problem
};

class PackWriter {
    template <class T> void write(T value) {
        static_assert(std::endian::native == std::endian::little && sizeof(T) == 8);
        const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
        bytes.insert(bytes.end(), from, from + sizeof(T));
    }

public:
    static constexpr bool reads = false;
    std::vector<std::uint8_t> bytes;

    void number(const real& value) { write(value); }
    template <class Integer> void integer(const Integer& value) { write(static_cast<std::int64_t>(value)); }
    template <class T, class Item> void list(std::vector<T>& items, Item&& item) {
        integer(items.size());
        for (T& one : items) item(one);
    }
    void table(Table& table) {
        integer(table.size);
        for (int i = 0; i < table.size; ++i) number(table[i]);
    }
};

class PackReader {
    const std::uint8_t* next_;
    const std::uint8_t* end_;
    std::deque<std::vector<real>>& tables_;

    template <class T> T read() {
        static_assert(std::endian::native == std::endian::little && sizeof(T) == 8);
        if (end_ - next_ < 8) throw std::invalid_argument("the packed case is cut short");
        T value;
        std::memcpy(&value, next_, sizeof(T));
        next_ += sizeof(T);
        return value;
    }
    std::size_t length() {
        const auto n = read<std::int64_t>();
        if (n < 0 || n > (end_ - next_) / 8) throw std::invalid_argument("the packed case is cut short");
        return static_cast<std::size_t>(n);
    }

public:
    static constexpr bool reads = true;

    PackReader(const std::uint8_t* data, std::size_t size, std::deque<std::vector<real>>& tables)
        : next_(data), end_(data + size), tables_(tables) {}

    void number(real& value) { value = read<real>(); }
    template <class Integer> void integer(Integer& value) {
        value = static_cast<Integer>(read<std::int64_t>());
    }
    template <class T, class Item> void list(std::vector<T>& items, Item&& item) {
        items.assign(length(), T{});
        for (T& one : items) item(one);
    }
    void table(Table& table) {
        std::vector<real>& values = tables_.emplace_back(length());
        for (real& value : values) number(value);
        table = {values.data(), static_cast<int>(values.size())};
    }
    bool at_end() const { return next_ == end_; }
};

template <class Pack> void pack(Pack& p, std::vector<real>& values) {
    p.list(values, [&](real& value) { p.number(value); });
}

template <class Pack, class Law> void pack_law(Pack& p, Law& law) {
    if constexpr (!Pack::reads && std::is_same_v<Law, ExternalLaw>)
        throw std::invalid_argument(
            "a contact law of another package cannot be in a packed case, an FMU or a stepper");
    for (const auto& field : Law::fields) p.number(law.*field.member);
    if constexpr (requires { Law::tables; })
        for (const auto& field : Law::tables) p.table(law.*field.member);
}

template <class Pack, class... Laws> void pack(Pack& p, Variant<Laws...>& choice) {
    int chosen = choice.index();
    p.integer(chosen);
    bool found = false;
    Variant<Laws...>::each([&]<class Law>(int index) {
        if (index != chosen) return;
        found = true;
        Law law{};
        if constexpr (!Pack::reads) law = *choice.template get_if<Law>();
        pack_law(p, law);
        if constexpr (Pack::reads) choice.set(law);
    });
    if (!found) throw std::invalid_argument("the packed case has a law that this version does not know");
}

template <class Pack> void pack(Pack& p, Row& row, int components) {
    for (int a = 0; a < components; ++a) {
        real value = row[a];
        p.number(value);
        row[a] = value;
    }
}
template <class Pack> void pack(Pack& p, std::vector<Row>& rows, int components) {
    p.list(rows, [&](Row& row) { pack(p, row, components); });
}

// Loads become inputs: their signals are constant over a step.
template <class Pack, class Problem> void pack_structure(Pack& p, Problem& problem) {
    p.list(problem.modes, [&](Mode& mode) { p.number(mode.decay), p.number(mode.stiffness); });
    pack(p, problem.coupling);
    p.list(problem.start, [&](ModeState& state) { p.number(state.q), p.number(state.p); });
    p.list(problem.loads, [&](Load& load) {
        pack(p, load.shape);
        p.integer(load.base);
        if constexpr (Pack::reads) load.signal.kind = Signal::Kind::constant;
    });
}

template <class Pack> void pack(Pack& p, rattlebox::Problem& problem) {
    pack_structure(p, problem);
    p.list(problem.dampers, [&](Damper& damper) {
        p.integer(damper.first_ball), p.integer(damper.balls), p.integer(damper.first_contact);
        p.number(damper.clearance), p.number(damper.gravity);
        pack(p, damper.shape);
    });
    if constexpr (Pack::reads)
        problem.stop_count = static_cast<int>(std::count_if(problem.dampers.begin(), problem.dampers.end(),
                                                            [](const Damper& d) { return d.is_stop(); }));
    p.list(problem.contacts, [&](Contact& contact) {
        p.integer(contact.damper), p.integer(contact.below), p.integer(contact.above);
        p.number(contact.mass);
        pack(p, contact.normal);
        pack(p, contact.restitution);
    });
    pack(p, problem.ball_mass);
    pack(p, problem.ball_position);
    pack(p, problem.ball_velocity);
    p.list(problem.ball_damper, [&](int& damper) { p.integer(damper); });
    Settings& settings = problem.settings;
    p.integer(settings.method), p.number(settings.duration), p.number(settings.tolerance);
    p.integer(settings.max_events), p.number(settings.stick), p.integer(settings.collocation);
}

template <class Pack> void pack(Pack& p, dem::Problem& problem) {
    pack_structure(p, problem);
    pack(p, problem.load_direction, 3);
    p.number(problem.dt), p.number(problem.enduring);
    pack(p, problem.gravity, 3);
    p.list(problem.cavities, [&](dem::Cavity& cavity) {
        pack(p, cavity.shape, 3);
        p.list(cavity.walls, [&](dem::Wall& wall) {
            pack(p, wall.axis, 4);
            p.integer(wall.form), p.integer(wall.material);
        });
        pack(p, cavity.period, 3);
        pack(p, cavity.position, 4);
        pack(p, cavity.velocity, 3);
        pack(p, cavity.spin, 3);
        pack(p, cavity.mass);
        pack(p, cavity.inertia);
        for (auto* numbers : {&cavity.species, &cavity.particle_pair, &cavity.wall_pair})
            p.list(*numbers, [&](int& number) { p.integer(number); });
        p.integer(cavity.species_count), p.integer(cavity.wall_material_count);
    });
    p.list(problem.pair_laws, [&](dem::PairLaw& law) {
        pack(p, law.normal);
        pack(p, law.restitution);
        pack(p, law.tangential);
        pack_law(p, law.rolling);
        p.number(law.size.radius), p.number(law.size.mass);
    });
}

template <class Pack> void pack(Pack& p, Component& component) {
    p.integer(component.alone);
    for (real& v : component.velocity) p.number(v);
    p.list(component.rows, [&](std::vector<real>& row) { pack(p, row); });
}

// ---- header

inline constexpr char pack_magic[9] = "RATTLEBX";
inline constexpr std::int64_t pack_version = 2;
inline constexpr std::size_t pack_header = 40;

inline std::uint64_t pack_hash(const std::uint8_t* data, std::size_t size) {
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 1099511628211u;
    return hash;
}

template <class Problem> std::vector<std::uint8_t> pack_case(PackedCase<Problem>& given) {
    PackWriter content, whole;
    pack(content, given.problem);
    pack(content, given.component);
    for (int i = 0; i < 8; ++i) whole.bytes.push_back(static_cast<std::uint8_t>(pack_magic[i]));
    whole.integer(pack_version);
    constexpr bool in_space = std::is_same_v<Problem, dem::Problem>;
    whole.integer(in_space ? Engine::particles : Engine::impact);
    whole.integer(content.bytes.size());
    whole.integer(pack_hash(content.bytes.data(), content.bytes.size()));
    whole.bytes.insert(whole.bytes.end(), content.bytes.begin(), content.bytes.end());
    return std::move(whole.bytes);
}

// Checks the header and returns the engine.
inline Engine packed_engine(const std::uint8_t* data, std::size_t size) {
    if (size < pack_header || std::memcmp(data, pack_magic, 8) != 0)
        throw std::invalid_argument("this is not a packed case of Rattlebox");
    std::int64_t words[3];
    std::uint64_t hash;
    std::memcpy(words, data + 8, sizeof words);
    std::memcpy(&hash, data + 32, sizeof hash);
    if (words[0] != pack_version)
        throw std::invalid_argument("the packed case has version " + std::to_string(words[0]) +
                                    " of the format; this library reads version " +
                                    std::to_string(pack_version));
    if (words[2] != static_cast<std::int64_t>(size - pack_header))
        throw std::invalid_argument("the packed case is cut short");
    if (hash != pack_hash(data + pack_header, size - pack_header))
        throw std::invalid_argument("the packed case is damaged: its hash differs");
    check(words[1] == 1 || words[1] == 2);
    return static_cast<Engine>(words[1]);
}

template <class Problem>
void read_case(PackedCase<Problem>& target, const std::uint8_t* data, std::size_t size) {
    PackReader reader(data + pack_header, size - pack_header, target.tables);
    pack(reader, target.problem);
    pack(reader, target.component);
    check(reader.at_end());
    check(target.problem, target.component);
}

} // namespace rattlebox
