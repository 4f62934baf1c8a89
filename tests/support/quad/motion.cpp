// Motion of balls in cavities on a structure in 113-bit arithmetic, and its derivatives by central
// differences.
//
// Written from the equations in docs/theory alone, with another method than that of the core: Taylor series
// of order 30 for flights and contacts alike, in physical coordinates. README.md has the format of the input.
#include <quadmath.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Q = __float128;
using List = std::vector<Q>;

constexpr int most = 40; // of the order
int order = 30;
double log_tolerance = -23 * std::log2(10.0);
const Q pi = M_PIq;
const Q never = 1e300Q;

using Series = std::array<Q, most + 1>;

struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

Q product(const Series& a, const Series& b, int n) {
    Q sum = 0;
    for (int i = 0; i <= n; ++i) sum += a[i] * b[n - i];
    return sum;
}

Q evaluate(const Series& a, Q s) {
    Q sum = a[order];
    for (int i = order - 1; i >= 0; --i) sum = sum * s + a[i];
    return sum;
}

double log2_of(Q x) {
    if (x == 0) return -std::numeric_limits<double>::infinity();
    int exponent = 0;
    const double mantissa = static_cast<double>(frexpq(fabsq(x), &exponent));
    return exponent + std::log2(mantissa);
}

// Root of a function that is positive at a and not at b (Illinois, with bisections where it is slow).
Q root(const std::function<Q(Q)>& f, Q a, Q b) {
    Q fa = f(a);
    Q fb = f(b);
    int side = 0;
    for (int i = 0; i < 400 && fabsq(b - a) > 1e-33Q * (fabsq(a) + fabsq(b)); ++i) {
        Q c = i % 8 == 7 ? (a + b) / 2 : (a * fb - b * fa) / (fb - fa);
        if (!(c > std::min(a, b) && c < std::max(a, b))) c = (a + b) / 2;
        if (c == a || c == b) break;
        const Q fc = f(c);
        if (fc == 0) return c;
        if (fc > 0) {
            a = c;
            fa = fc;
            if (side == 1) fb /= 2;
            side = 1;
        } else {
            b = c;
            fb = fc;
            if (side == -1) fa /= 2;
            side = -1;
        }
    }
    return fabsq(fa) < fabsq(fb) ? a : b;
}

// ---- input

struct Reader {
    const List& numbers;
    std::size_t at = 0;
    Q next() { return numbers.at(at++); }
    int whole() { return static_cast<int>(next()); }
    List several(int n) {
        List result(n);
        for (Q& x : result) x = next();
        return result;
    }
};

struct Matter {
    Q young, poisson, strength; // no yield stress: 0; a rigid body has the modulus 0
    Q compliance() const { return young == 0 ? Q(0) : (1 - poisson * poisson) / young; }
    Q hardness() const { return 1.295Q * expq(0.736Q * poisson) * strength; }
};

// ---- restitution

struct Pair {
    Q mass, radius, modulus;
    std::vector<Matter> sides;
    Q hertz() const { return 4 * modulus * sqrtq(radius) / 3; }
    const Matter& first_to_yield() const {
        const Matter* result = nullptr;
        for (const Matter& side : sides) {
            if (side.strength == 0) continue;
            const bool softer =
                result != nullptr && side.hardness() == result->hardness() && side.young < result->young;
            if (result == nullptr || side.hardness() < result->hardness() || softer) result = &side;
        }
        if (result == nullptr) throw Refusal("no yield stress");
        return *result;
    }
};

void keep_from(Q value, Q kink) {
    if (fabsq(value - kink) < 2e-3Q * fabsq(kink)) throw Refusal("kink");
}

struct Restitution {
    int kind = 0;
    Q maximum = 1, value = 0;
    List speeds, values;

    static Restitution read(Reader& in) {
        Restitution result;
        result.kind = in.whole();
        result.maximum = in.next();
        if (result.kind == 4) {
            const int n = in.whole();
            result.speeds = in.several(n);
            result.values = in.several(n);
        } else {
            result.value = in.next();
        }
        return result;
    }

    Q at(Q speed, const Pair& pair) const {
        const Q e = law(speed, pair);
        if (kind != 0) keep_from(e, maximum);
        return std::min(e, maximum);
    }

private:
    Q law(Q speed, const Pair& pair) const {
        if (kind == 0) return value;
        if (kind == 1) return jackson_green(speed, pair);
        if (kind == 2) return thornton(speed, pair);
        if (kind == 3) {
            const Q yield = value == 0 ? pair.first_to_yield().strength : Q(0);
            const Q scale = value != 0 ? value
                                       : powq(3.8Q, 4) * powq(yield / pair.modulus, 2) *
                                             sqrtq(2 * yield * powq(pair.radius, 3) / pair.mass);
            return powq(speed / scale, -0.25Q);
        }
        for (const Q& knot : speeds) keep_from(speed, knot);
        if (speed <= speeds.front()) return values.front();
        for (std::size_t i = 1; i < speeds.size(); ++i)
            if (speed < speeds[i])
                return values[i - 1] +
                       (values[i] - values[i - 1]) * (speed - speeds[i - 1]) / (speeds[i] - speeds[i - 1]);
        return values.back();
    }

    static Q jackson_green(Q speed, const Pair& pair) {
        const Matter& weak = pair.first_to_yield();
        const Q pressure = pi * weak.hardness() / 2;
        const Q depth = powq(pressure / pair.modulus, 2) * pair.radius;
        const Q load = 4 * powq(pair.radius / pair.modulus, 2) * powq(pressure, 3) / 3;
        const Q v = speed / sqrtq(4 * depth * load / (5 * pair.mass));
        keep_from(v, 1);
        keep_from(v, 60);
        if (v > 1000) throw Refusal("beyond the law");
        if (v <= 1) return 1;
        if (v <= 60) return 1 - 0.1Q * logq(v) * powq((v - 1) / 59, 0.156Q);
        return 1 - 0.1Q * logq(Q(60)) -
               0.11Q * logq(v / 60) * powq(v - 60, 2.36Q * weak.strength / weak.young);
    }

    Q thornton(Q speed, const Pair& pair) const {
        const Q p = value != 0 ? value : 1.6Q * pair.first_to_yield().strength;
        const Q yield = powq(pi / (2 * pair.modulus), 2) *
                        sqrtq(8 * pi * powq(pair.radius, 3) / (15 * pair.mass)) * powq(p, 2.5Q);
        keep_from(speed, yield);
        if (speed <= yield) return 1;
        const Q r = yield / speed;
        return sqrtq(6 * sqrtq(3) / 5) * sqrtq(1 - r * r / 6) *
               powq(r / (r + 2 * sqrtq(1.2Q - r * r / 5)), 0.25Q);
    }
};

// Damping ratio of a linear oscillator that ends at zero force, or at zero overlap, with a restitution.
Q damping_ratio(Q e, bool zero_overlap) {
    if (e == 1) return 0;
    const Q l = logq(e);
    if (zero_overlap) return -l / sqrtq(pi * pi + l * l);
    if (l > -2) return cosq(root([l](Q b) { return l + 2 * b * cosq(b) / sinq(b); }, 1e-12Q, pi / 2));
    return coshq(root([l](Q b) { return -2 * b * coshq(b) / sinhq(b) - l; }, 1e-12Q, -l));
}

Q restitution_of(Q ratio, bool zero_overlap) {
    if (zero_overlap) return expq(-pi * ratio / sqrtq(1 - ratio * ratio));
    if (ratio < 1) {
        const Q b = acosq(ratio);
        return expq(-2 * b * cosq(b) / sinq(b));
    }
    const Q b = acoshq(ratio);
    return expq(-2 * b * coshq(b) / sinhq(b));
}

// ---- contact laws

// A piecewise cubic through points, monotone (Fritsch and Butland): coefficients of each piece in powers of x
// - knot.
struct Cubics {
    List knots;
    std::vector<std::array<Q, 4>> pieces;

    Cubics() = default;
    Cubics(const List& x, const List& y) : knots(x) {
        const int n = static_cast<int>(x.size());
        List h(n - 1), m(n - 1), slope(n);
        for (int i = 0; i + 1 < n; ++i) {
            h[i] = x[i + 1] - x[i];
            m[i] = (y[i + 1] - y[i]) / h[i];
        }
        for (int i = 1; i + 1 < n; ++i) {
            const Q a = 2 * h[i] + h[i - 1];
            const Q b = h[i] + 2 * h[i - 1];
            slope[i] = m[i - 1] * m[i] > 0 ? (a + b) / (a / m[i - 1] + b / m[i]) : Q(0);
        }
        slope[0] = n == 2 ? m[0] : end(h[0], h[1], m[0], m[1]);
        slope[n - 1] = n == 2 ? m[0] : end(h[n - 2], h[n - 3], m[n - 2], m[n - 3]);
        for (int i = 0; i + 1 < n; ++i)
            pieces.push_back({y[i], slope[i], (3 * m[i] - 2 * slope[i] - slope[i + 1]) / h[i],
                              (slope[i] + slope[i + 1] - 2 * m[i]) / (h[i] * h[i])});
    }

    Q operator()(Q x, int piece) const {
        const auto& c = pieces[piece];
        const Q s = x - knots[piece];
        return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
    }

private:
    static Q end(Q h0, Q h1, Q m0, Q m1) {
        const Q d = ((2 * h0 + h1) * m0 - h0 * m1) / (h0 + h1);
        if (d * m0 <= 0) return 0;
        return m0 * m1 <= 0 && fabsq(d) > 3 * fabsq(m0) ? 3 * m0 : d;
    }
};

enum Kind { tsuji = 1, tsuji_alpha, linear, linear_damping, linear_time, power, thornton, tabulated };

struct Law {
    int kind = 0;
    Restitution restitution;
    Q a = 0, n = 0, p = 0, c = 0;
    bool zero_overlap = false;
    Cubics loading, unloading;

    static Law read(Reader& in) {
        Law law;
        law.kind = in.whole();
        switch (law.kind) {
        case tsuji:
            law.restitution = Restitution::read(in);
            break;
        case tsuji_alpha:
            law.a = in.next();
            break;
        case linear:
        case linear_time:
            law.a = in.next();
            law.restitution = Restitution::read(in);
            break;
        case linear_damping:
            law.a = in.next();
            law.c = in.next();
            break;
        case power:
            law.a = in.next();
            law.n = in.next();
            law.p = in.next();
            law.c = in.next();
            break;
        case thornton:
            law.a = in.next();
            return law;
        case tabulated: {
            const int n = in.whole();
            const List x = in.several(n);
            law.loading = Cubics(x, in.several(n));
            const int m = in.whole();
            if (m > 0) {
                List u = in.several(m);
                List f = in.several(m);
                for (Q& v : u) v /= Q(u.back());
                for (Q& v : f) v /= Q(f.back());
                law.unloading = Cubics(u, f);
            }
            return law;
        }
        default:
            throw Refusal("unknown law");
        }
        law.zero_overlap = in.next() != 0;
        return law;
    }
};

// One branch of a force: with x^k = d - origin, either c0 x^a0 + c1 x^a1 rate, or (k = 1) a cubic in x plus
// c1 rate.
struct Branch {
    Q origin = 0;
    int k = 1;
    std::array<Q, 4> cubic{};
    Q c0 = 0, a0 = 0, c1 = 0, a1 = 0;
    bool ends_at_zero_force = false;
};

enum Phase { is_open, is_closed, is_released };

struct Contact {
    int damper = 0, number = 0;
    std::array<int, 2> place{-1, -1}; // of positions
    std::array<Q, 2> sign{};
    Q offset = 0;
    Pair pair;
    Law law;

    Phase phase = is_open;
    Branch branch;
    int stage = 0, piece = 0; // stage 0: one branch; 1: loading; 2: unloading
    Q x = 0;                  // regular variable of a branch with k > 1
    Q deepest = 0, largest = 0;

    bool is_regular() const { return phase == is_closed && branch.k > 1; }
    Q yield_pressure() const { return law.a != 0 ? law.a : 1.6Q * pair.first_to_yield().strength; }
    Q yield_overlap() const { return pair.radius * powq(pi * yield_pressure() / (2 * pair.modulus), 2); }
    Q yield_force() const { return pair.hertz() * powq(yield_overlap(), 1.5Q); }

    Q restitution(Q speed) const {
        switch (law.kind) {
        case tsuji_alpha:
            return restitution_of(law.a / sqrtq(5), law.zero_overlap);
        case linear_damping:
            return restitution_of(law.c / (2 * sqrtq(law.a * pair.mass)), law.zero_overlap);
        case thornton: {
            Restitution same;
            same.kind = 2;
            same.value = law.a;
            return same.at(speed, pair);
        }
        case power:
        case tabulated:
            throw Refusal("no restitution in closed form");
        default:
            return law.restitution.at(speed, pair);
        }
    }

    void touch(Q speed) {
        phase = is_closed;
        branch = Branch();
        stage = 0;
        x = 0;
        const bool by_force = !law.zero_overlap;
        switch (law.kind) {
        case tsuji:
        case tsuji_alpha: {
            const Q alpha = law.kind == tsuji_alpha
                                ? law.a
                                : sqrtq(5) * damping_ratio(restitution(speed), law.zero_overlap);
            branch.k = 4;
            branch.c0 = pair.hertz();
            branch.a0 = 6;
            branch.c1 = alpha * sqrtq(pair.mass * pair.hertz());
            branch.a1 = 1;
            branch.ends_at_zero_force = by_force && alpha > 0;
            break;
        }
        case linear:
        case linear_damping:
        case linear_time: {
            const Q k = law.kind == linear_time ? pair.mass * powq(pi / law.a, 2) : law.a;
            const Q c = law.kind == linear_damping
                            ? law.c
                            : 2 * damping_ratio(restitution(speed), law.zero_overlap) * sqrtq(k * pair.mass);
            branch.cubic = {0, k, 0, 0};
            branch.c1 = c;
            branch.ends_at_zero_force = by_force && c > 0;
            break;
        }
        case power: {
            const bool quarters = 4 * law.n == rintq(4 * law.n) && 4 * law.p == rintq(4 * law.p);
            branch.k = quarters ? 4 : 8;
            branch.c0 = law.a != 0 ? law.a : pair.hertz();
            branch.a0 = branch.k * law.n;
            branch.c1 = law.c;
            branch.a1 = branch.k * law.p;
            branch.ends_at_zero_force = by_force && law.c > 0;
            break;
        }
        case thornton:
            branch.k = 2;
            branch.c0 = pair.hertz();
            branch.a0 = 3;
            break;
        case tabulated:
            stage = 1;
            piece = 0;
            follow_table();
            break;
        default:
            throw Refusal("unknown law");
        }
    }

    // Whether a contact cannot start at zero overlap as a series, because its exponents are no multiples of
    // 1/k.
    bool has_rough_start() const {
        return branch.k > 1 &&
               (branch.a0 != rintq(branch.a0) || (branch.c1 != 0 && branch.a1 != rintq(branch.a1)));
    }

    void follow_table() {
        branch = Branch();
        if (stage == 1) {
            branch.origin = law.loading.knots[piece];
            branch.cubic = law.loading.pieces[piece];
            return;
        }
        branch.origin = deepest * law.unloading.knots[piece];
        Q scale = largest;
        for (int i = 0; i < 4; ++i, scale /= deepest)
            branch.cubic[i] = scale * law.unloading.pieces[piece][i];
    }

    void yield(Q) {
        stage = 1;
        branch = Branch();
        branch.origin = yield_overlap();
        branch.cubic = {yield_force(), pi * yield_pressure() * pair.radius, 0, 0};
    }

    void unload(Q d) {
        deepest = d;
        if (law.kind == tabulated) {
            largest = law.loading(d, piece);
            stage = 2;
            piece = static_cast<int>(law.unloading.pieces.size()) - 1;
            follow_table();
            return;
        }
        const Q p = yield_pressure();
        const Q force = yield_force() + pi * p * pair.radius * (d - yield_overlap());
        if (force < 1.002Q * yield_force()) throw Refusal("kink");
        const Q radius =
            4 * pair.modulus / (3 * force) * powq((2 * force + yield_force()) / (2 * pi * p), 1.5Q);
        stage = 2;
        branch = Branch();
        branch.k = 2;
        branch.c0 = 4 * pair.modulus * sqrtq(radius) / 3;
        branch.a0 = 3;
        branch.origin = d - powq(3 * force / (4 * pair.modulus * sqrtq(radius)), 2 / Q(3));
        x = sqrtq(d - branch.origin);
    }

    void load_again(Q d) {
        if (law.kind == thornton) {
            yield(d);
            return;
        }
        stage = 1;
        piece = 0;
        while (law.loading.knots[piece + 1] <= d) ++piece;
        follow_table();
    }

    // Force without its positive factor of the overlap: its sign is that of the force.
    Q sign_of_force(Q power_of, Q rate) const {
        if (branch.k == 1) return branch.cubic[1] * power_of + branch.c1 * rate;
        if (branch.a0 >= branch.a1)
            return branch.c0 * powq(power_of, branch.a0 - branch.a1) + branch.c1 * rate;
        return branch.c0 + branch.c1 * powq(power_of, branch.a1 - branch.a0) * rate;
    }
};

// ---- loads

struct Load {
    int place = -1; // degree of freedom, or -1: acceleration of the base
    bool is_sine = false;
    Q a = 0, b = 0, w = 0, phase = 0; // a sin(w t + phase), or a + b t
    Q start = 0, stop = never;
};

void read_load(Reader& in, std::vector<Load>& loads) {
    Load load;
    load.place = in.whole();
    const int shape = in.whole();
    load.a = in.next();
    if (shape == 0) {
        load.is_sine = true;
        load.w = 2 * pi * in.next();
        load.phase = in.next();
        load.start = in.next();
        load.stop = in.next();
        loads.push_back(load);
        return;
    }
    const Q length = in.next();
    load.start = in.next();
    load.stop = load.start + length;
    if (shape == 1) {
        load.is_sine = true;
        load.w = pi / length;
        load.phase = -load.w * load.start;
        loads.push_back(load);
        return;
    }
    const auto line = [&](Q t0, Q f0, Q t1, Q f1) {
        Load part = load;
        part.start = t0;
        part.stop = t1;
        part.b = (f1 - f0) / (t1 - t0);
        part.a = f0 - part.b * t0;
        loads.push_back(part);
    };
    if (shape == 2) {
        const bool falls = in.next() != 0;
        line(load.start, falls ? load.a : Q(0), load.stop, falls ? Q(0) : load.a);
        return;
    }
    const Q rise = in.next();
    const Q fall = in.next();
    line(load.start, 0, load.start + rise, load.a);
    line(load.start + rise, load.a, load.stop - fall, load.a);
    line(load.stop - fall, load.a, load.stop, 0);
}

// ---- the system

struct Touch {
    Q time;
    int damper, contact;
    Q speed, restitution;
};

struct Motion {
    int n = 0, balls = 0; // degrees of freedom of structure and tuned masses; balls
    std::vector<List> by_velocity, by_position, inverse;
    List mass, gravity;
    List position, velocity; // of the degrees of freedom, then of the balls
    std::vector<Load> loads;
    std::vector<Contact> contacts;
    bool is_hard = false;
    Q time = 0;
    int target = 0;
    Q fraction = 0, end = 0;

    std::vector<Touch> touches;
    Q smallest_miss = never;
    long steps = 0;

    explicit Motion(const List& numbers) {
        Reader in{numbers};
        read_structure(in);
        const int count = in.whole();
        for (int i = 0; i < count; ++i) read_load(in, loads);
        read_stops(in, read_dampers(in));
        is_hard = in.next() != 0;
        for (Q& x : position) x += in.next();
        for (Q& v : velocity) v += in.next();
        target = in.whole();
        fraction = in.next();
        end = in.next();
        if (in.at != numbers.size()) throw Refusal("numbers are left over");
    }

    // Runs to the end, or, if there is none, until contacts are open after the wanted number: then sets the
    // end, in the flight that follows, or with a negative fraction within the last wanted contact.
    void run() {
        const bool plans = end == 0;
        Q opened = -1;
        const Q last = plans ? Q(2) : end;
        while (time < last) {
            if (++steps > 20000) throw Refusal("too many steps");
            const std::size_t before = touches.size();
            step(last);
            if (touches.size() > 24) throw Refusal("too many contacts");
            if (!plans || static_cast<int>(touches.size()) < target) continue;
            const Q last_touch = touches[target - 1].time;
            const bool in_flight = std::all_of(contacts.begin(), contacts.end(),
                                               [](const Contact& c) { return c.phase == is_open; });
            if (opened < 0) {
                if (in_flight) opened = time;
                if (in_flight && fraction < 0) {
                    end = static_cast<double>(last_touch - fraction * (opened - last_touch));
                    return;
                }
            } else if (touches.size() > before || time >= opened + 0.02Q) {
                const Q until = touches.size() > before ? touches.back().time : time;
                if (until - opened < 1e-6Q) throw Refusal("too short a flight");
                end = static_cast<double>(opened + fraction * (until - opened));
                return;
            }
        }
        if (plans) throw Refusal("too few contacts");
        for (const Contact& c : contacts)
            if (c.phase != is_open && fraction >= 0) throw Refusal("closed at the end");
        if (fraction < 0 && none_closed()) throw Refusal("open at the end");
    }

private:
    bool none_closed() const {
        return std::none_of(contacts.begin(), contacts.end(),
                            [](const Contact& c) { return c.phase == is_closed; });
    }

    void read_structure(Reader& in) {
        const int own = in.whole();
        std::vector<List> m, c, k;
        const int kind = in.whole();
        const auto square = [&](int size) {
            std::vector<List> a(size);
            for (List& row : a) row = in.several(size);
            return a;
        };
        if (own > 0 && kind == 0) {
            const Q weight = in.next();
            const Q w = 2 * pi * in.next();
            const Q ratio = in.next();
            m = {{weight}};
            c = {{2 * ratio * weight * w}};
            k = {{weight * w * w}};
        } else {
            m = square(own);
            c = square(own);
            k = square(own);
        }
        List x = in.several(own), v = in.several(own);
        const int tuned = in.whole();
        n = own + tuned;
        for (auto* a : {&m, &c, &k}) {
            for (List& row : *a) row.resize(n, 0);
            a->resize(n, List(n, 0));
        }
        for (int i = own; i < n; ++i) {
            const int p = in.whole();
            const Q weight = in.next();
            const Q w = 2 * pi * in.next();
            const Q ratio = in.next();
            x.push_back(in.next());
            v.push_back(in.next());
            m[i][i] = weight;
            const auto couple = [&](std::vector<List>& a, Q value) {
                a[i][i] += value;
                a[p][p] += value;
                a[i][p] -= value;
                a[p][i] -= value;
            };
            couple(c, 2 * ratio * weight * w);
            couple(k, weight * w * w);
        }
        position = x;
        velocity = v;
        inverse = inverted(m);
        by_velocity = times(inverse, c);
        by_position = times(inverse, k);
    }

    static std::vector<List> inverted(std::vector<List> a) {
        const int size = static_cast<int>(a.size());
        std::vector<List> b(size, List(size, 0));
        for (int i = 0; i < size; ++i) b[i][i] = 1;
        for (int i = 0; i < size; ++i) { // positive definite: no pivoting
            const Q pivot = a[i][i];
            for (int j = 0; j < size; ++j) {
                a[i][j] /= pivot;
                b[i][j] /= pivot;
            }
            for (int r = 0; r < size; ++r) {
                if (r == i) continue;
                const Q factor = a[r][i];
                for (int j = 0; j < size; ++j) {
                    a[r][j] -= factor * a[i][j];
                    b[r][j] -= factor * b[i][j];
                }
            }
        }
        return b;
    }

    static std::vector<List> times(const std::vector<List>& a, const std::vector<List>& b) {
        const std::size_t size = a.size();
        std::vector<List> c(size, List(size, 0));
        for (std::size_t i = 0; i < size; ++i)
            for (std::size_t j = 0; j < size; ++j)
                for (std::size_t l = 0; l < size; ++l) c[i][j] += a[i][l] * b[l][j];
        return c;
    }

    // Returns the number of dampers.
    int read_dampers(Reader& in) {
        const int count = in.whole();
        for (int damper = 0; damper < count; ++damper) {
            const int place = in.whole();
            const Q gap = in.next();
            const Q pull = in.next();
            const int row = in.whole();
            std::vector<Matter> matter;
            List radius, weight;
            for (int i = 0; i < row; ++i) {
                radius.push_back(in.next());
                const Q density = in.next();
                const Q young = in.next(), poisson = in.next(), strength = in.next();
                matter.push_back({young, poisson, strength});
                weight.push_back(4 * pi * powq(radius.back(), 3) * density / 3);
                mass.push_back(weight.back());
                gravity.push_back(pull);
                const Q base = place < 0 ? Q(0) : position[place];
                position.push_back(base + in.next() * gap);
                velocity.push_back(in.next());
            }
            const int wall = in.whole(); // 0: as the ball next to it, 1: its own, 2: rigid
            Matter own{0, 0, 0};
            if (wall == 1) {
                const Q young = in.next(), poisson = in.next(), strength = in.next();
                own = {young, poisson, strength};
            }
            const Law at_wall = Law::read(in);
            const Law between = Law::read(in);
            const Q yielding = place < 0 ? Q(0) : inverse[place][place];
            const int first = n + balls;
            for (int c = 0; c <= row; ++c) {
                Contact contact;
                contact.damper = damper;
                contact.number = c;
                const bool is_wall = c == 0 || c == row;
                contact.law = is_wall ? at_wall : between;
                if (is_wall) {
                    const int ball = c == 0 ? 0 : row - 1;
                    const Q side = c == 0 ? 1 : -1;
                    contact.place = {place, first + ball};
                    contact.sign = {side, -side};
                    contact.offset = -gap;
                    contact.pair.mass = 1 / (yielding + 1 / weight[ball]);
                    contact.pair.radius = radius[ball];
                    contact.pair.sides = {matter[ball], wall == 0 ? matter[ball] : own};
                } else {
                    contact.place = {first + c - 1, first + c};
                    contact.sign = {1, -1};
                    contact.pair.mass = 1 / (1 / weight[c - 1] + 1 / weight[c]);
                    contact.pair.radius = 1 / (1 / radius[c - 1] + 1 / radius[c]);
                    contact.pair.sides = {matter[c - 1], matter[c]};
                }
                contact.pair.modulus =
                    1 / (contact.pair.sides[0].compliance() + contact.pair.sides[1].compliance());
                if (overlap(contact) >= 0) throw Refusal("starts closed");
                contacts.push_back(contact);
            }
            balls += row;
        }
        return count;
    }

    // Stops between a degree of freedom and the ground or another one, numbered after the dampers.
    void read_stops(Reader& in, int dampers) {
        const int count = in.whole();
        for (int stop = 0; stop < count; ++stop) {
            Contact contact;
            contact.damper = dampers + stop;
            const int place = in.whole(), other = in.whole();
            const Q side = in.next();
            contact.place = {place, other};
            contact.sign = {side, -side};
            contact.offset = -in.next();
            contact.pair.radius = in.next();
            const Q young = in.next(), poisson = in.next(), strength = in.next();
            const Matter own{young, poisson, strength};
            contact.pair.sides = {own, in.whole() == 2 ? Matter{0, 0, 0} : own};
            contact.law = Law::read(in);
            Q yielding = inverse[place][place];
            if (other >= 0) yielding += inverse[other][other] - 2 * inverse[place][other];
            contact.pair.mass = 1 / yielding;
            contact.pair.modulus =
                1 / (contact.pair.sides[0].compliance() + contact.pair.sides[1].compliance());
            if (overlap(contact) >= 0) throw Refusal("starts closed");
            contacts.push_back(contact);
        }
    }

    Q along(const Contact& c, const List& values) const {
        Q sum = 0;
        for (int i = 0; i < 2; ++i)
            if (c.place[i] >= 0) sum += c.sign[i] * values[c.place[i]];
        return sum;
    }
    Q overlap(const Contact& c) const { return along(c, position) + c.offset; }
    Q rate(const Contact& c) const { return along(c, velocity); }

    void strike(const Contact& c, Q impulse) {
        for (int i = 0; i < 2; ++i) {
            const int p = c.place[i];
            if (p >= n) velocity[p] -= c.sign[i] * impulse / mass[p - n];
            if (p >= 0 && p < n)
                for (int r = 0; r < n; ++r) velocity[r] -= c.sign[i] * impulse * inverse[r][p];
        }
    }

    // ---- one step

    std::vector<Series> s_position, s_velocity, s_acceleration, s_force, s_overlap, s_rate, s_sine, s_cosine;
    Series s_time, s_scale;

    // Coefficient of a power of x > 0 by its recurrence.
    static void power_at(const Series& x, Q exponent, Series& y, int i) {
        if (i == 0) {
            y[0] = powq(x[0], exponent);
            return;
        }
        Q sum = 0;
        for (int m = 1; m <= i; ++m) sum += (m * exponent - (i - m)) * x[m] * y[i - m];
        y[i] = sum / (i * x[0]);
    }

    // Whole powers by halves: x^e = x^(e/2) x^(e - e/2).
    struct WholePower {
        std::vector<int> exponents;
        std::vector<Series> values;
        int index(int e) {
            for (std::size_t i = 0; i < exponents.size(); ++i)
                if (exponents[i] == e) return static_cast<int>(i);
            if (e > 1) {
                index(e / 2);
                index(e - e / 2);
            }
            exponents.push_back(e);
            values.emplace_back();
            return static_cast<int>(exponents.size()) - 1;
        }
        void extend(const Series& x, int i) {
            for (std::size_t j = 0; j < exponents.size(); ++j) {
                const int e = exponents[j];
                if (e == 0)
                    values[j][i] = i == 0;
                else if (e == 1)
                    values[j][i] = x[i];
                else
                    values[j][i] = product(values[find(e / 2)], values[find(e - e / 2)], i);
            }
        }
        int find(int e) const {
            return static_cast<int>(std::find(exponents.begin(), exponents.end(), e) - exponents.begin());
        }
    };

    struct Closed {
        int contact;
        WholePower whole;
        Series rough0{}, rough1{}, square{}, cube{}, scale{}, others{}, x{};
        Q unit = 1;
    };
    std::vector<Closed> closed;

    void make_series() {
        const int all = n + balls;
        s_position.assign(all, {});
        s_velocity.assign(all, {});
        s_acceleration.assign(all, {});
        s_sine.assign(loads.size(), {});
        s_cosine.assign(loads.size(), {});
        s_force.assign(contacts.size(), {});
        s_overlap.assign(contacts.size(), {});
        s_rate.assign(contacts.size(), {});
        closed.clear();
        int regular = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (contacts[i].phase != is_closed) continue;
            Closed one;
            one.contact = static_cast<int>(i);
            const Branch& b = contacts[i].branch;
            if (b.k > 1) {
                ++regular;
                one.x[0] = contacts[i].x;
                one.unit = powq(1e-6Q, Q(b.k - 1) / b.k);
                one.whole.index(b.k - 1);
                if (b.a0 == rintq(b.a0)) one.whole.index(static_cast<int>(b.a0));
                if (b.a1 == rintq(b.a1)) one.whole.index(static_cast<int>(b.a1));
            }
            closed.push_back(one);
        }
        s_time = {};
        s_time[0] = time;
        s_scale = {};
        for (int i = 0; i < all; ++i) {
            s_position[i][0] = position[i];
            s_velocity[i][0] = velocity[i];
        }
        for (std::size_t l = 0; l < loads.size(); ++l) {
            const Q angle = loads[l].w * time + loads[l].phase;
            if (loads[l].is_sine) sincosq(angle, &s_sine[l][0], &s_cosine[l][0]);
        }
        for (int i = 0; i < order; ++i) extend(i, regular > 0);
        for (std::size_t c = 0; c < contacts.size(); ++c) relative(c, order);
    }

    void relative(std::size_t c, int i) {
        Q d = i == 0 ? contacts[c].offset : Q(0);
        Q w = 0;
        for (int j = 0; j < 2; ++j) {
            const int p = contacts[c].place[j];
            if (p < 0) continue;
            d += contacts[c].sign[j] * s_position[p][i];
            w += contacts[c].sign[j] * s_velocity[p][i];
        }
        s_overlap[c][i] = d;
        s_rate[c][i] = w;
    }

    // Coefficient i of everything that the state determines, and coefficient i + 1 of the state.
    void extend(int i, bool is_scaled) {
        for (std::size_t c = 0; c < contacts.size(); ++c) relative(c, i);
        // Regular time: dt = (product of x^(k - 1) / unit) d tau.
        for (Closed& one : closed) {
            const Contact& contact = contacts[one.contact];
            const Branch& b = contact.branch;
            if (b.k == 1) continue;
            one.whole.extend(one.x, i);
            one.scale[i] = one.whole.values[one.whole.find(b.k - 1)][i] / one.unit;
        }
        if (is_scaled) {
            bool first = true;
            Series* last = nullptr;
            static std::vector<Series> partial;
            partial.resize(closed.size() + 1);
            std::size_t count = 0;
            for (Closed& one : closed) {
                if (contacts[one.contact].branch.k == 1) continue;
                if (first)
                    partial[count][i] = one.scale[i];
                else
                    partial[count][i] = product(*last, one.scale, i);
                last = &partial[count++];
                first = false;
            }
            s_scale[i] = (*last)[i];
            s_time[i + 1] = s_scale[i] / (i + 1);
        } else {
            s_scale[i] = i == 0;
            if (i == 0) s_time[1] = 1;
        }
        for (Closed& one : closed) force(one, i);
        for (std::size_t l = 0; l < loads.size(); ++l) {
            if (!loads[l].is_sine) continue;
            const Q c = is_scaled ? product(s_scale, s_cosine[l], i) : s_cosine[l][i];
            const Q s = is_scaled ? product(s_scale, s_sine[l], i) : s_sine[l][i];
            s_sine[l][i + 1] = loads[l].w * c / (i + 1);
            s_cosine[l][i + 1] = -loads[l].w * s / (i + 1);
        }
        accelerate(i);
        for (int p = 0; p < n + balls; ++p) {
            const Q v = is_scaled ? product(s_scale, s_velocity[p], i) : s_velocity[p][i];
            const Q a = is_scaled ? product(s_scale, s_acceleration[p], i) : s_acceleration[p][i];
            s_position[p][i + 1] = v / (i + 1);
            s_velocity[p][i + 1] = a / (i + 1);
        }
        for (std::size_t j = 0; j < closed.size(); ++j) advance_x(j, i);
    }

    void force(Closed& one, int i) {
        const Contact& contact = contacts[one.contact];
        const Branch& b = contact.branch;
        const Series& w = s_rate[one.contact];
        Q sum = 0;
        if (b.k == 1) {
            one.x[i] = s_overlap[one.contact][i] - (i == 0 ? b.origin : Q(0));
            sum = (i == 0 ? b.cubic[0] : Q(0)) + b.cubic[1] * one.x[i] + b.c1 * w[i];
            if (b.cubic[2] != 0 || b.cubic[3] != 0) {
                one.square[i] = product(one.x, one.x, i);
                one.cube[i] = product(one.square, one.x, i);
                sum += b.cubic[2] * one.square[i] + b.cubic[3] * one.cube[i];
            }
        } else {
            const auto power_of = [&](Q exponent, Series& rough) -> const Series& {
                if (exponent == rintq(exponent))
                    return one.whole.values[one.whole.find(static_cast<int>(exponent))];
                power_at(one.x, exponent, rough, i);
                return rough;
            };
            sum = b.c0 * power_of(b.a0, one.rough0)[i];
            if (b.c1 != 0) sum += b.c1 * product(power_of(b.a1, one.rough1), w, i);
        }
        s_force[one.contact][i] = sum;
    }

    void accelerate(int i) {
        static List forces;
        forces.assign(n, 0);
        Q base = 0;
        for (std::size_t l = 0; l < loads.size(); ++l) {
            const Load& load = loads[l];
            if (time < load.start || time >= load.stop) continue;
            const Q value =
                load.is_sine ? load.a * s_sine[l][i] : (i == 0 ? load.a : Q(0)) + load.b * s_time[i];
            if (load.place < 0)
                base += value;
            else
                forces[load.place] += value;
        }
        for (int p = n; p < n + balls; ++p) s_acceleration[p][i] = (i == 0 ? gravity[p - n] : Q(0)) - base;
        for (const Closed& one : closed) {
            const Contact& c = contacts[one.contact];
            for (int j = 0; j < 2; ++j) {
                const int p = c.place[j];
                if (p < 0) continue;
                const Q f = -c.sign[j] * s_force[one.contact][i];
                if (p < n)
                    forces[p] += f;
                else
                    s_acceleration[p][i] += f / mass[p - n];
            }
        }
        for (int r = 0; r < n; ++r) {
            Q a = -base;
            for (int j = 0; j < n; ++j)
                a += inverse[r][j] * forces[j] - by_velocity[r][j] * s_velocity[j][i] -
                     by_position[r][j] * s_position[j][i];
            s_acceleration[r][i] = a;
        }
    }

    // x' = rate / k / unit times the scales of the other contacts.
    void advance_x(std::size_t j, int i) {
        Closed& one = closed[j];
        const Branch& b = contacts[one.contact].branch;
        if (b.k == 1) return;
        const Series* others = nullptr;
        static std::array<std::array<Series, 8>, 8> partial;
        int count = 0;
        for (std::size_t m = 0; m < closed.size(); ++m) {
            if (m == j || contacts[closed[m].contact].branch.k == 1) continue;
            if (others == nullptr) {
                others = &closed[m].scale;
            } else {
                if (count >= 8 || j >= 8) throw Refusal("too many contacts at once");
                partial[j][count][i] = product(*others, closed[m].scale, i);
                others = &partial[j][count++];
            }
        }
        const Series& w = s_rate[one.contact];
        one.x[i + 1] = (others == nullptr ? w[i] : product(*others, w, i)) / (b.k * one.unit) / (i + 1);
    }

    // Longest step at which the last terms of all series are below the tolerance, from the radius of
    // convergence that they show. Where a contact begins, a series has only each second or third power, so
    // that two terms are not enough.
    Q longest() const {
        double best = std::numeric_limits<double>::infinity();
        const auto limit = [&](const Series& a, double log_size) {
            for (int m = order - 5; m <= order; ++m) {
                const double size = log2_of(a[m]);
                if (std::isfinite(size)) best = std::min(best, log_tolerance / order + (log_size - size) / m);
            }
        };
        const double length = std::log2(1e-6);
        for (const Series& a : s_position) limit(a, length);
        for (const Series& a : s_velocity) limit(a, std::log2(0.1));
        for (const Closed& one : closed)
            if (contacts[one.contact].branch.k > 1) limit(one.x, length / contacts[one.contact].branch.k);
        limit(s_time, length);
        return std::isfinite(best) ? exp2q(Q(best)) : Q(0.01Q);
    }

    struct Event {
        std::function<Q(Q)> f; // positive before
        std::function<void()> then;
    };

    void step(Q last) {
        make_series();
        bool is_scaled = false;
        for (const Closed& one : closed) is_scaled = is_scaled || contacts[one.contact].branch.k > 1;
        Q h = longest();
        Q knot = last;
        for (const Load& load : loads)
            for (Q t : {load.start, load.stop})
                if (t > time && t < knot) knot = t;
        bool reaches_knot = false;
        std::vector<Event> events;
        // A contact that was released opens soon, and may be closed again soon after.
        for (const Contact& c : contacts)
            if (c.phase == is_released && !is_scaled)
                h = std::min(h, 8 * fabsq(overlap(c) / rate(c)) + 1e-9Q);
        if (!is_scaled && h >= knot - time) {
            h = knot - time;
            reaches_knot = true;
        }
        if (is_scaled)
            events.push_back(
                {[this, knot](Q s) { return knot - evaluate(s_time, s); }, [this, knot] { time = knot; }});
        for (std::size_t c = 0; c < contacts.size(); ++c) add_events(c, events);
        constexpr int parts = 6;
        Q earliest = h;
        const Event* which = nullptr;
        std::vector<Event> touching;
        touching.reserve(contacts.size());
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            if (contacts[c].phase != is_open) continue;
            const Q s = first_touch(c, earliest);
            if (s >= earliest) continue;
            earliest = s;
            touching.push_back({nullptr, [this, c] { begin(c); }});
            which = &touching.back();
        }
        for (const Event& event : events) {
            Q before = event.f(Q(0));
            for (int i = 1; i <= parts; ++i) {
                const Q s = h * i / parts;
                if (h * (i - 1) / parts >= earliest) break;
                const Q after = event.f(s);
                if (before > 0 && after <= 0) {
                    const Q found = root(event.f, h * (i - 1) / parts, s);
                    if (found < earliest) {
                        earliest = found;
                        which = &event;
                    }
                    break;
                }
                before = after;
            }
        }
        note_misses(earliest);
        move_to(earliest);
        if (which != nullptr)
            which->then();
        else if (reaches_knot)
            time = knot;
    }

    // First root of the gap of an open contact in a step, or the end of the step. From each time on, the gap
    // is above a parabola with the largest second derivative, whose root is the next time: no root is passed
    // over.
    Q first_touch(std::size_t c, Q h) const {
        const Series& d = s_overlap[c];
        Series slope{};
        for (int i = 0; i < order; ++i) slope[i] = (i + 1) * d[i + 1];
        Q bend = 0;
        Q power_of = 1;
        Q reach = d[0];
        for (int i = 1; i <= order; ++i) {
            reach += fabsq(d[i]) * power_of * h;
            if (i >= 2) bend += i * (i - 1) * fabsq(d[i]) * power_of / h;
            power_of *= h;
        }
        if (reach < 0) return h;
        Q s = 0;
        for (int i = 0; i < 100000; ++i) {
            const Q gap = std::max(-evaluate(d, s), Q(0));
            const Q closing = evaluate(slope, s);
            if (closing > 0 && gap < 1e-15Q) {
                if (gap < 1e-33Q) return s; // rounding
                const Q beyond = std::min(h, s + 4 * gap / closing);
                if (evaluate(d, beyond) < 0) return h; // just beyond the step
                return root([&d](Q t) { return -evaluate(d, t); }, s, beyond);
            }
            const Q root_of = sqrtq(closing * closing + 2 * bend * gap);
            if (closing <= 0 && bend <= 0) return h;
            s += closing > 0 ? 2 * gap / (closing + root_of) : (root_of - closing) / bend;
            if (!(s < h)) return h;
        }
        throw Refusal("too many steps");
    }

    void move_to(Q s) {
        for (int p = 0; p < n + balls; ++p) {
            position[p] = evaluate(s_position[p], s);
            velocity[p] = evaluate(s_velocity[p], s);
        }
        time = evaluate(s_time, s);
        for (const Closed& one : closed)
            if (contacts[one.contact].branch.k > 1) contacts[one.contact].x = evaluate(one.x, s);
    }

    // Smallest gap of open contacts at a minimum within the step, over the half clearance of the first
    // damper.
    void note_misses(Q h) {
        if (h <= 0) return;
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            if (contacts[c].phase != is_open) continue;
            const auto w = [&](Q s) { return evaluate(s_rate[c], s); };
            constexpr int parts = 20;
            Q before = w(Q(0));
            for (int i = 1; i <= parts; ++i) {
                const Q after = w(h * i / parts);
                if (before > 0 && after <= 0) {
                    const Q gap = -evaluate(s_overlap[c], root(w, h * (i - 1) / parts, h * i / parts));
                    smallest_miss = std::min(smallest_miss, fabsq(gap));
                }
                before = after;
            }
        }
    }

    void add_events(std::size_t c, std::vector<Event>& events) {
        Contact& contact = contacts[c];
        const auto d = [this, c](Q s) { return evaluate(s_overlap[c], s); };
        const auto w = [this, c](Q s) { return evaluate(s_rate[c], s); };
        if (contact.phase == is_open) return; // first_touch
        if (contact.phase == is_released) {
            events.push_back({d, [&contact] { contact.phase = is_open; }});
            if (contact.branch.ends_at_zero_force)
                events.push_back({[&contact, d, w](Q s) {
                                      const Q depth = d(s);
                                      if (depth <= 0) return Q(1);
                                      return -contact.sign_of_force(powq(depth, 1 / Q(contact.branch.k)),
                                                                    w(s));
                                  },
                                  [this, c] { begin_again(c); }});
            else
                events.push_back({[&contact, d](Q s) { return contact.branch.origin - d(s); },
                                  [this, c] { begin_again(c); }});
            return;
        }
        const auto found = std::find_if(closed.begin(), closed.end(), [c](const Closed& one) {
            return one.contact == static_cast<int>(c);
        });
        const Series* x = &found->x;
        const Branch& b = contact.branch;
        if (b.ends_at_zero_force) {
            events.push_back({[&contact, x, d, w](Q s) {
                                  const Q rate = w(s);
                                  if (rate >= 0) return Q(1);
                                  if (contact.branch.k == 1) return contact.sign_of_force(d(s), rate);
                                  const Q at = evaluate(*x, s);
                                  return at <= 0 ? Q(-1) : contact.sign_of_force(at, rate);
                              },
                              [&contact] { contact.phase = is_released; }});
        }
        const auto falls_to = [&](Q value, std::function<void()> then) {
            events.push_back({[d, value](Q s) { return d(s) - value; }, std::move(then)});
        };
        const auto rises_to = [&](Q value, std::function<void()> then) {
            events.push_back({[d, value](Q s) { return value - d(s); }, std::move(then)});
        };
        if (contact.law.kind == thornton) {
            if (contact.stage == 0) {
                rises_to(contact.yield_overlap(), [this, c] { contacts[c].yield(overlap(contacts[c])); });
            } else if (contact.stage == 1) {
                events.push_back({w, [this, c] { contacts[c].unload(overlap(contacts[c])); }});
                return;
            } else {
                rises_to(contact.deepest, [this, c] { contacts[c].load_again(overlap(contacts[c])); });
                events.push_back(
                    {[x](Q s) { return evaluate(*x, s); }, [&contact] { contact.phase = is_released; }});
                return;
            }
        }
        if (contact.law.kind == tabulated) {
            const bool yields = !contact.law.unloading.knots.empty();
            const Cubics& curve = contact.stage == 1 ? contact.law.loading : contact.law.unloading;
            const Q size = contact.stage == 1 ? Q(1) : contact.deepest;
            const int final = static_cast<int>(curve.pieces.size()) - 1;
            const auto go_to = [&contact](int piece) {
                return [&contact, piece] {
                    contact.piece = piece;
                    contact.follow_table();
                };
            };
            if (contact.piece < final)
                rises_to(size * curve.knots[contact.piece + 1], go_to(contact.piece + 1));
            else if (contact.stage == 1)
                rises_to(curve.knots.back(), [] { throw Refusal("beyond the law"); });
            else
                rises_to(contact.deepest, [this, c] { contacts[c].load_again(overlap(contacts[c])); });
            if (contact.stage == 1 && yields)
                events.push_back({w, [this, c] { contacts[c].unload(overlap(contacts[c])); }});
            else if (contact.piece > 0)
                falls_to(size * curve.knots[contact.piece], go_to(contact.piece - 1));
            else if (contact.stage == 1)
                falls_to(0, [&contact] { contact.phase = is_open; });
            else
                falls_to(size * curve.knots[0], [&contact] { contact.phase = is_released; });
            return;
        }
        // All others end where their overlap vanishes, if not before.
        if (b.k > 1)
            events.push_back({[x](Q s) { return evaluate(*x, s); }, [&contact] { contact.phase = is_open; }});
        else
            falls_to(0, [&contact] { contact.phase = is_open; });
    }

    void begin(std::size_t c) {
        Contact& contact = contacts[c];
        const Q speed = rate(contact);
        if (!(speed > 0)) throw Refusal("grazing");
        if (!is_hard) {
            touches.push_back({time, contact.damper, contact.number, speed, -1});
            contact.touch(speed);
            if (contact.has_rough_start()) begin_roughly(c, speed);
            return;
        }
        const Q e = contact.restitution(speed);
        touches.push_back({time, contact.damper, contact.number, speed, e});
        strike(contact, (1 + e) * speed * contact.pair.mass);
    }

    void begin_again(std::size_t c) {
        Contact& contact = contacts[c];
        contact.phase = is_closed;
        if (contact.branch.k > 1)
            contact.x =
                contact.branch.ends_at_zero_force ? powq(overlap(contact), 1 / Q(contact.branch.k)) : Q(0);
    }

    // The first instant of a contact with any exponents: the overlap grows with the approach speed, the
    // impulse of the force follows in closed form. The error is the square of the part of the speed that this
    // impulse changes.
    void begin_roughly(std::size_t c, Q speed) {
        Contact& contact = contacts[c];
        const Q n1 = contact.law.n + 1, p1 = contact.law.p + 1;
        const auto impulse = [&](Q dt) {
            return contact.branch.c0 * powq(speed, contact.law.n) * powq(dt, n1) / n1 +
                   contact.branch.c1 * powq(speed, p1) * powq(dt, p1) / p1;
        };
        Q dt = 1e-6Q;
        while (impulse(dt) > 1e-13Q * contact.pair.mass * speed) dt /= 2;
        const Q lag = contact.branch.c0 * powq(speed, contact.law.n) * powq(dt, n1 + 1) / (n1 * (n1 + 1)) +
                      contact.branch.c1 * powq(speed, p1) * powq(dt, p1 + 1) / (p1 * (p1 + 1));
        const Q whole = impulse(dt);
        contact.phase = is_open;
        const Q until = time + dt;
        const std::size_t count = touches.size();
        // The others move on as they do; this contact must not begin once more.
        Contact other = contact;
        contact.phase = is_released;
        contact.branch = Branch();
        contact.branch.origin = 1;
        const Q before = rate(contact);
        while (time < until) step(until);
        if (touches.size() != count || before <= 0) throw Refusal("simultaneous");
        contact.phase = is_closed;
        contact.branch = other.branch;
        strike(contact, whole);
        // Positions lag by the second integral of the force.
        const List kept = velocity;
        std::fill(velocity.begin(), velocity.end(), Q(0));
        strike(contact, lag);
        for (std::size_t p = 0; p < position.size(); ++p) position[p] += velocity[p];
        velocity = kept;
        contact.x = powq(overlap(contact), 1 / Q(contact.branch.k));
    }
};

// ---- output

void print(Q x) {
    char text[64];
    quadmath_snprintf(text, sizeof text, "%.24Qe", x);
    std::printf(" %s", text);
}

List state_of(const Motion& motion) {
    List result = motion.position;
    result.insert(result.end(), motion.velocity.begin(), motion.velocity.end());
    return result;
}

std::string sequence(const Motion& motion) {
    std::string text;
    for (const Touch& touch : motion.touches)
        text += std::to_string(touch.damper) + "/" + std::to_string(touch.contact) + " ";
    return text;
}

// Derivative by central differences with one step; throws where the order of contacts differs.
List slope(const List& numbers, int index, Q h, const std::string& contacts) {
    List ends[2];
    for (int side = 0; side < 2; ++side) {
        List moved = numbers;
        moved[index] += side == 0 ? h : -h;
        Motion motion(moved);
        motion.run();
        if (sequence(motion) != contacts) throw Refusal("another order of contacts");
        ends[side] = state_of(motion);
    }
    for (std::size_t i = 0; i < ends[0].size(); ++i) ends[0][i] = (ends[0][i] - ends[1][i]) / (2 * h);
    return ends[0];
}

void answer(List numbers, const std::vector<int>& indices, const List& sizes, bool checks) {
    if (numbers.back() == 0) {
        Motion plan(numbers);
        plan.run();
        numbers.back() = plan.end;
    }
    Motion motion(numbers);
    motion.run();
    // Before anything is printed: all derivatives.
    const std::string contacts = sequence(motion);
    std::vector<List> columns, seconds;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        columns.push_back(slope(numbers, indices[i], sizes[i] * 1e-10Q, contacts));
        if (checks) seconds.push_back(slope(numbers, indices[i], sizes[i] * 4e-10Q, contacts));
    }
    std::printf("ok\nend");
    print(numbers.back());
    std::printf("\nmiss");
    print(motion.smallest_miss);
    std::printf("\nsteps %ld\nstate", motion.steps);
    for (Q x : state_of(motion)) print(x);
    std::printf("\n");
    for (const Touch& touch : motion.touches) {
        std::printf("touch %d %d", touch.damper, touch.contact);
        print(touch.time);
        print(touch.speed);
        print(touch.restitution);
        std::printf("\n");
    }
    for (const auto* list : {&columns, &seconds})
        for (const List& column : *list) {
            std::printf(list == &columns ? "column" : "second");
            for (Q x : column) print(x);
            std::printf("\n");
        }
}

} // namespace

// Options: order, and the decimal exponent of the tolerance. Input: for each run the number of numbers, the
// numbers, the number of directions, their indices and sizes, and whether a second step checks the
// differences.
int main(int count, char** arguments) {
    if (count > 1) order = std::atoi(arguments[1]);
    if (count > 2) log_tolerance = std::atof(arguments[2]) * std::log2(10.0);
    int size = 0;
    while (std::cin >> size) {
        std::string word;
        List numbers(size);
        for (Q& x : numbers) {
            std::cin >> word;
            x = strtod(word.c_str(), nullptr); // inputs are doubles, exactly
        }
        std::cin >> size;
        std::vector<int> indices(size);
        List sizes(size);
        for (int& i : indices) std::cin >> i;
        for (Q& x : sizes) {
            std::cin >> word;
            x = strtod(word.c_str(), nullptr);
        }
        int checks = 0;
        std::cin >> checks;
        try {
            answer(numbers, indices, sizes, checks != 0);
        } catch (const Refusal& refusal) {
            std::printf("refused %s\n", refusal.what());
        }
        std::printf("done\n");
        std::fflush(stdout);
    }
}
