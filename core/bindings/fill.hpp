// Copies the values of structs from Python into structs of the core. In a batch the struct gets the value of
// the first variant, and a column stores where the values of the others are.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <variant>

#include "bindings/node.hpp"
#include "impact/batch.hpp"

namespace rattlebox::bindings {

template <class Law> constexpr std::size_t table_count = 0;
template <class Law>
    requires requires { Law::tables; }
constexpr std::size_t table_count<Law> = std::size(Law::tables);

inline rattlebox::Table view(const Table& array) { return {array.data(), static_cast<int>(array.shape(0))}; }

// Base classes in Python of the normal, tangential and restitution laws.
struct NormalForce : Node {
    virtual ~NormalForce() = default;
    virtual NormalLaw choice() const = 0;
    virtual std::unique_ptr<NormalForce> resized(PairSize from, PairSize to) const = 0;
};
struct TangentialForce : Node {
    virtual ~TangentialForce() = default;
    virtual TangentialLaw choice() const = 0;
};
struct Restitution : Node {
    virtual ~Restitution() = default;
    virtual RestitutionLaw choice() const = 0;
};

template <class Law> struct FamilyOf {
    using type = Node;
};
template <class Law>
    requires CompleteNormalLaw<Law>
struct FamilyOf<Law> {
    using type = NormalForce;
};
template <class Law>
    requires CompleteTangentialLaw<Law>
struct FamilyOf<Law> {
    using type = TangentialForce;
};
template <class Law>
    requires CompleteRestitutionLaw<Law>
struct FamilyOf<Law> {
    using type = Restitution;
};

template <class Law> struct LawNumbers;

// Implements the virtual functions for one law, whose coefficients must be single numbers.
template <class Law, class Base> struct LawOfFamily : Base {};
template <class Law> struct LawOfFamily<Law, NormalForce> : NormalForce {
    NormalLaw choice() const override;
    std::unique_ptr<NormalForce> resized(PairSize from, PairSize to) const override;
};
template <class Law> struct LawOfFamily<Law, TangentialForce> : TangentialForce {
    TangentialLaw choice() const override;
};
template <class Law> struct LawOfFamily<Law, Restitution> : Restitution {
    RestitutionLaw choice() const override;
};

// The coefficients of a law: numbers, or arrays over a grid.
template <class Law> struct LawNumbers : LawOfFamily<Law, typename FamilyOf<Law>::type> {
    using Family = typename FamilyOf<Law>::type;

    std::array<Number, std::size(Law::fields)> numbers;
    std::array<Table, table_count<Law>> tables;

    // Returns the law of one pair. Its tables point into the arrays of this object.
    Law law() const {
        Law result;
        for (std::size_t k = 0; k < numbers.size(); ++k) result.*Law::fields[k].member = numbers[k].single();
        view_tables(result);
        return result;
    }
    void view_tables(Law& result) const {
        if constexpr (table_count<Law> > 0)
            for (std::size_t k = 0; k < tables.size(); ++k) result.*Law::tables[k].member = view(tables[k]);
    }
};

template <class Laws, class Law> Laws as_choice(const Law& law) {
    Laws result;
    result.set(law);
    return result;
}
template <class Law> NormalLaw LawOfFamily<Law, NormalForce>::choice() const {
    return as_choice<NormalLaw>(static_cast<const LawNumbers<Law>*>(this)->law());
}
template <class Law> TangentialLaw LawOfFamily<Law, TangentialForce>::choice() const {
    return as_choice<TangentialLaw>(static_cast<const LawNumbers<Law>*>(this)->law());
}
template <class Law> RestitutionLaw LawOfFamily<Law, Restitution>::choice() const {
    return as_choice<RestitutionLaw>(static_cast<const LawNumbers<Law>*>(this)->law());
}
template <class Law>
std::unique_ptr<NormalForce> LawOfFamily<Law, NormalForce>::resized(PairSize from, PairSize to) const {
    const auto& own = *static_cast<const LawNumbers<Law>*>(this);
    const Law law = own.law().resized(from, to);
    // The copy keeps the arrays of the tables alive, into which the law points.
    auto other = std::make_unique<LawNumbers<Law>>(own);
    for (std::size_t k = 0; k < own.numbers.size(); ++k) other->numbers[k] = law.*Law::fields[k].member;
    return other;
}

template <class Laws> struct LawOfChoice;
template <class... Laws> struct LawOfChoice<Variant<Laws...>> {
    using type = std::variant<LawNumbers<Laws>...>;
};
// One law of a table of laws.
template <class Laws> struct LawOf {
    typename LawOfChoice<Laws>::type law;
};

// Copies values. The targets must not move afterwards, because columns point into them.
class Filler {
    Batch* batch_; // null: arrays over a grid raise an error

    // Sets the values of all variants from an array whose axes from `first` on are those of the grid.
    void column(real& target, const Vector& array, std::size_t first, std::size_t offset) {
        // The first variant is set here; a column of pointer and strides gives the others while the batch
        // runs, so that nothing is copied for each of a million variants.
        target = array.data()[offset];
        if (array.ndim() == first) return;
        const std::size_t axes = array.ndim() - first;
        if (!batch_ || axes != batch_->shape.size())
            throw std::invalid_argument(
                "an array has the wrong number of axes; it must have those of the grid");
        Column column{&target, array.data() + offset, std::vector<std::size_t>(axes, 0)};
        // A stride of zero repeats a value along an axis, as in NumPy.
        std::size_t step = 1;
        for (std::size_t k = axes; k-- > 0;) {
            const std::size_t size = array.shape(first + k);
            if (size != 1 && size != batch_->shape[k])
                throw std::invalid_argument("an array does not broadcast to the grid");
            if (size != 1) column.stride[k] = step;
            step *= size;
        }
        // An array of one value is the same in all variants and needs no column.
        if (step > 1) batch_->columns.push_back(std::move(column));
    }

public:
    explicit Filler(Batch* batch = nullptr) : batch_(batch) {}

    void number(real& target, const Number& number) {
        if (number.varies())
            column(target, number.grid, 0, 0);
        else
            target = number.value;
    }

    // Copies component i of a vector of n.
    void component(real& target, const Vector& vector, std::size_t i, std::size_t n) {
        if (vector.ndim() == 0 || vector.shape(0) != n)
            throw std::invalid_argument("a vector has the wrong number of components");
        std::size_t each = 1;
        for (std::size_t k = 1; k < vector.ndim(); ++k) each *= vector.shape(k);
        column(target, vector, 1, i * each);
    }

    void vector(std::vector<real>& target, const Vector& values, std::size_t n) {
        target.resize(n);
        for (std::size_t i = 0; i < n; ++i) component(target[i], values, i, n);
    }

    template <class Law> void law(Law& target, const LawNumbers<Law>& given) {
        for (std::size_t k = 0; k < given.numbers.size(); ++k)
            number(target.*Law::fields[k].member, given.numbers[k]);
        given.view_tables(target);
    }

    template <class... Laws> void choose(Variant<Laws...>& target, const LawOf<Variant<Laws...>>& given) {
        std::visit([&]<class Law>(const LawNumbers<Law>& one) { law(target.set(Law{}), one); }, given.law);
    }
};

} // namespace rattlebox::bindings

// A field for one law of a table has the type of the base class in Python.
namespace nanobind::detail {

template <class Laws> constexpr auto family_name = const_name("NormalForce");
template <> inline constexpr auto family_name<rattlebox::TangentialLaw> = const_name("TangentialForce");
template <> inline constexpr auto family_name<rattlebox::RestitutionLaw> = const_name("Restitution");

template <class Laws> struct type_caster<rattlebox::bindings::LawOf<Laws>> {
    using Any = rattlebox::bindings::LawOf<Laws>;
    NB_TYPE_CASTER(Any, family_name<Laws>)

    bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
        make_caster<decltype(Any::law)> caster;
        if (!caster.from_python(source, flags, cleanup)) return false;
        value.law = caster.operator cast_t<decltype(Any::law)>();
        return true;
    }
    static handle from_cpp(const Any& any, rv_policy policy, cleanup_list* cleanup) noexcept {
        return make_caster<decltype(Any::law)>::from_cpp(any.law, policy, cleanup);
    }
};

} // namespace nanobind::detail
