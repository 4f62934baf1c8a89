// Structs that are passed between Python and the core. A struct declares its fields once, by name and member;
// `define` binds it with a constructor of keyword arguments (an unknown or missing one raises TypeError) and
// read-only attributes.
//
// In a batch a number may be an array over the grid of the variants, and a vector may have the axes of the
// grid after its own axis, so that a million variants are one object.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "math/real.hpp"

namespace rattlebox::bindings {

namespace nb = nanobind;

template <int axes>
using Doubles = nb::ndarray<nb::numpy, double, nb::ndim<axes>, nb::c_contig, nb::device::cpu>;
template <int axes>
using Integers = nb::ndarray<nb::numpy, std::int64_t, nb::ndim<axes>, nb::c_contig, nb::device::cpu>;
// A vector, in a batch with the axes of the grid after its own.
using Vector = nb::ndarray<nb::numpy, const double, nb::c_contig, nb::device::cpu>;
// An array that is the same for all variants, such as the knots of a curve.
using Table = nb::ndarray<nb::numpy, const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// A saved state.
using Bytes = nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using SavedState = nb::ndarray<nb::numpy, const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// A number, or an array that broadcasts to the grid of a batch.
struct Number {
    real value = 0;
    Vector grid; // invalid for a single number

    Number() = default;
    Number(real number) : value(number) {}
    bool varies() const { return grid.is_valid(); }
    real single() const {
        if (varies())
            throw std::invalid_argument("an array is given where one number is needed; pass a single value");
        return value;
    }
};

// How a field can depend on the variant of a batch.
enum class Varies { number, vector, never };

// Base of all structs that are passed between Python and the core.
struct Node {};

template <class T> constexpr Varies varies_of = Varies::never;
template <> inline constexpr Varies varies_of<Number> = Varies::number;
template <> inline constexpr Varies varies_of<std::optional<Number>> = Varies::number;
template <> inline constexpr Varies varies_of<Vector> = Varies::vector;

// ---- fields

template <class Owner, class T> struct Required {
    using Value = T;
    const char* name;
    T Owner::* member;

    T get(const Owner& owner) const { return owner.*member; }
    void set(Owner& owner, T value) const { owner.*member = std::move(value); }
    auto argument() const { return nb::arg(name); }
};

template <class Owner, class T> struct WithDefault {
    using Value = T;
    const char* name;
    T Owner::* member;
    T initial;

    T get(const Owner& owner) const { return owner.*member; }
    void set(Owner& owner, T value) const { owner.*member = std::move(value); }
    auto argument() const { return nb::arg(name) = initial; }
};

template <class Owner, class T> Required<Owner, T> field(const char* name, T Owner::* member) {
    return {name, member};
}
template <class Owner, class T, class Initial>
WithDefault<Owner, T> field(const char* name, T Owner::* member, Initial initial) {
    return {name, member, T(initial)};
}

template <class Owner> struct Base {
    using type = Node;
};
template <class Owner>
    requires requires { typename Owner::Family; }
struct Base<Owner> {
    using type = typename Owner::Family;
};
template <class Owner> using BaseOf = typename Base<Owner>::type;

using Names = nb::typed<nb::dict, nb::str, Varies>;

inline nb::dict values_of(nb::handle node) {
    nb::dict values;
    for (nb::handle name : node.attr("fields")()) values[name] = node.attr(name);
    return values;
}

inline void add_node(nb::module_& module) {
    nb::enum_<Varies>(module, "Varies", "How a field can depend on the variant of a batch.")
        .value("number", Varies::number)
        .value("vector", Varies::vector)
        .value("never", Varies::never);
    nb::class_<Node>(module, "Node",
                     "A struct with read-only fields that is passed between Python and the core.")
        .def_static(
            "fields", [] { return Names(); },
            "Return the names of the fields, and how each can depend on the variant of a batch.")
        .def(
            "replace",
            [](nb::handle self, const nb::kwargs& changes) {
                nb::dict values = values_of(self);
                // The constructor checks the names: an unknown field raises the same error as there.
                values.update(changes);
                return self.type()(**values);
            },
            nb::sig("def replace(self, **changes: object) -> typing.Self"),
            "Return a copy with other values of some fields.")
        .def("__repr__", [](nb::handle self) {
            std::string text = nb::cast<std::string>(self.type().attr("__name__")) + "(", between;
            for (auto [name, value] : values_of(self)) {
                text += between + nb::cast<std::string>(name) + "=" + nb::repr(value).c_str();
                between = ", ";
            }
            return text + ")";
        });
}

template <class Owner, class... Fields>
auto define(nb::module_& module, const char* name, const char* doc, const Fields&... fields) {
    nb::class_<Owner, BaseOf<Owner>> bound(module, name, doc);
    bound.def(
        "__init__",
        [fields...](Owner* self, typename Fields::Value... values) {
            // Set on a temporary, since a conversion that throws must leave no half-built object behind.
            Owner result;
            (fields.set(result, std::move(values)), ...);
            new (self) Owner(std::move(result));
        },
        nb::kw_only(), fields.argument()...);
    (bound.def_prop_ro(
         fields.name, [fields](const Owner& self) -> typename Fields::Value { return fields.get(self); },
         nb::rv_policy::automatic),
     ...);
    bound.def_static("fields", [fields...] {
        Names names;
        ((names[fields.name] = nb::cast(varies_of<typename Fields::Value>)), ...);
        return names;
    });
    return bound;
}

// ---- arrays

// Returns an array that owns the memory of a vector.
template <class Array, class T> Array owned(std::vector<T> values, const std::vector<std::size_t>& shape) {
    // The vector moves to the heap and is deleted with the last array that views it: results are not copied.
    auto* memory = new std::vector<T>(std::move(values));
    nb::capsule owner(memory, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    return Array(reinterpret_cast<typename Array::Scalar*>(memory->data()), shape.size(), shape.data(),
                 owner);
}
template <class Array, class T> Array owned(std::vector<T> values) {
    const std::size_t size = values.size();
    return owned<Array>(std::move(values), {size});
}

} // namespace rattlebox::bindings

namespace nanobind::detail {

template <> struct type_caster<rattlebox::bindings::Number> {
    NB_TYPE_CASTER(rattlebox::bindings::Number, const_name("float | numpy.typing.NDArray[numpy.float64]"))

    bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
        if (PyFloat_Check(source.ptr()) || PyLong_Check(source.ptr())) {
            value = PyFloat_AsDouble(source.ptr());
            // -1 is both a value and the sign of an error. The error is cleared, so that the next caster is
            // tried.
            if (value.value != -1 || !PyErr_Occurred()) return true;
            PyErr_Clear();
            return false;
        }
        if (!ndarray_check(source)) return false;
        make_caster<rattlebox::bindings::Vector> caster;
        if (!caster.from_python(source, flags, cleanup)) return false;
        if (caster.value.ndim() == 0)
            value = *caster.value.data();
        else
            value.grid = caster.value;
        return true;
    }

    static handle from_cpp(const rattlebox::bindings::Number& number, rv_policy policy,
                           cleanup_list* cleanup) noexcept {
        if (!number.varies()) return PyFloat_FromDouble(number.value);
        return make_caster<rattlebox::bindings::Vector>::from_cpp(number.grid, policy, cleanup);
    }
};

} // namespace nanobind::detail
