// The functions of FMI 2.0 and 3.0 for co-simulation. The types are those of the standards
// (https://fmi-standard.org); only what an FMU of this kind needs is declared.
#include "stepper/fmu.hpp"

#include <atomic>
#include <cstdio>
#include <set>

#if defined(_WIN32)
#define FMU_EXPORT extern "C" __declspec(dllexport)
#else
#define FMU_EXPORT extern "C" __attribute__((visibility("default")))
#endif

namespace {

using rattlebox::fmu::Fmu;

enum Outcome : int { ok = 0, warning = 1, discard = 2, error = 3, fatal = 4 };

using Log2 = void (*)(void* environment, const char* instance, int status, const char* category,
                      const char* message, ...);
using Log3 = void (*)(void* environment, int status, const char* category, const char* message);

struct Callbacks2 {
    Log2 log;
    void* (*allocate)(std::size_t, std::size_t);
    void (*free)(void*);
    void (*step_finished)(void*, int);
    void* environment;
};

struct Instance {
    Fmu fmu;
    std::string name;
    Log2 log2 = nullptr;
    Log3 log3 = nullptr;
    void* environment = nullptr;

    void report(const char* message, Outcome status = error) const {
        const char* category = status == warning ? "logStatusWarning" : "logStatusError";
        if (log2) log2(environment, name.c_str(), status, category, "%s", message);
        if (log3) log3(environment, status, category, message);
    }
};

using State = std::vector<std::uint8_t>;

// Objects that importers hold by pointers, so that a pointer that is NULL, foreign or was freed is found out.
template <class T> class Registry {
    std::set<const void*> all_;
    std::atomic_flag lock_ = ATOMIC_FLAG_INIT;

    template <class F> auto locked(F&& f) {
        while (lock_.test_and_set(std::memory_order_acquire)) {
        }
        const auto unlock = [](std::atomic_flag* lock) { lock->clear(std::memory_order_release); };
        const std::unique_ptr<std::atomic_flag, decltype(unlock)> guard(&lock_, unlock);
        return f();
    }

public:
    T* add(std::unique_ptr<T> made) {
        locked([&] { all_.insert(made.get()); });
        return made.release();
    }
    T* find(void* pointer) {
        return locked([&] { return all_.count(pointer) > 0; }) ? static_cast<T*>(pointer) : nullptr;
    }
    // Returns whether there was such an object.
    bool remove(void* pointer) {
        if (!locked([&] { return all_.erase(pointer) > 0; })) return false;
        delete static_cast<T*>(pointer);
        return true;
    }
};

Registry<Instance> instances;
Registry<State> states;

Instance* of(void* instance) { return instances.find(instance); }

template <class T> T& needed(T* pointer, const char* name) {
    if (!pointer) throw std::invalid_argument(std::string(name) + " is NULL, or was freed");
    return *pointer;
}

// Calls f(instance) and reports an exception; no exception leaves the library.
template <class F> int guarded(void* handle, F&& f) noexcept {
    Instance* instance = of(handle);
    if (!instance) return error;
    try {
        f(*instance);
        return ok;
    } catch (const std::exception& e) {
        instance->report(e.what());
    } catch (...) {
        instance->report("unknown error");
    }
    return error;
}

int unsupported(void* instance, const char* function) {
    return guarded(instance, [&](Instance&) {
        throw std::invalid_argument(std::string(function) + " is not supported");
    });
}

// "file:///a%20b" -> "/a b"
std::string path_of(const char* uri) {
    std::string text = uri ? uri : "", path;
    for (const char* start : {"file://localhost", "file://", "file:"})
        if (text.rfind(start, 0) == 0) {
            text.erase(0, std::strlen(start));
            break;
        }
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned code;
        if (text[i] == '%' && i + 2 < text.size() && std::sscanf(text.c_str() + i + 1, "%2x", &code) == 1) {
            path += static_cast<char>(code);
            i += 2;
        } else {
            path += text[i];
        }
    }
    if (path.size() > 2 && path[0] == '/' && path[2] == ':') path.erase(0, 1); // "/C:/a"
    return path;
}

template <class Report>
Instance* instantiate(const char* name, const std::string& resources, Report&& report) {
    try {
        return instances.add(std::unique_ptr<Instance>(new Instance{Fmu(resources), name ? name : ""}));
    } catch (const std::exception& e) {
        report(e.what());
    } catch (...) {
        report("unknown error");
    }
    return nullptr;
}

// Puts bytes into the state to which an importer points, which is a new one if that is NULL.
void put(void** state, State&& bytes) {
    if (needed(state, "the pointer to the state"))
        needed(states.find(*state), "the state") = std::move(bytes);
    else
        *state = states.add(std::make_unique<State>(std::move(bytes)));
}

int save(void* instance, void** state) {
    return guarded(instance, [&](Instance& i) { put(state, i.fmu.save()); });
}
int restore(void* instance, void* state) {
    return guarded(instance, [&](Instance& i) {
        const State& bytes = needed(states.find(state), "the state");
        i.fmu.restore(bytes.data(), bytes.size());
    });
}
// Freeing NULL does nothing, as the standard demands.
int forget(void* instance, void** state) {
    if (!state || !*state) return ok;
    const bool removed = states.remove(*state);
    *state = nullptr;
    return removed ? ok : guarded(instance, [](Instance&) { needed<State>(nullptr, "the state"); });
}
int size_of(void* instance, void* state, std::size_t* size) {
    return guarded(instance, [&](Instance&) {
        needed(size, "the pointer to the size") = needed(states.find(state), "the state").size();
    });
}
int write(void* instance, void* state, void* bytes, std::size_t size) {
    return guarded(instance, [&](Instance&) {
        const State& from = needed(states.find(state), "the state");
        if (size < from.size()) throw std::invalid_argument("the buffer is too small for the state");
        needed(static_cast<std::uint8_t*>(bytes), "the buffer");
        std::memcpy(bytes, from.data(), from.size());
    });
}
int read(void* instance, const void* bytes, std::size_t size, void** state) {
    return guarded(instance, [&](Instance&) {
        const auto* from = &needed(static_cast<const std::uint8_t*>(bytes), "the buffer");
        put(state, State(from, from + size));
    });
}

// Calls f(reference, value) for each variable.
template <class Value, class F>
int each(void* instance, const unsigned* references, std::size_t n, Value* values, F&& f) {
    return guarded(instance, [&](Instance& i) {
        if (n > 0) needed(references, "the list of variables"), needed(values, "the list of values");
        for (std::size_t k = 0; k < n; ++k) f(i.fmu, references[k], values[k]);
    });
}
int get(void* instance, const unsigned* references, std::size_t n, double* values) {
    return each(instance, references, n, values,
                [](const Fmu& fmu, unsigned r, double& v) { v = fmu.get(r); });
}
int set(void* instance, const unsigned* references, std::size_t n, const double* values) {
    return each(instance, references, n, values, [](Fmu& fmu, unsigned r, double v) { fmu.set(r, v); });
}
template <class Integer>
int choice(void* instance, const unsigned* references, std::size_t n, Integer* values) {
    return each(instance, references, n, values,
                [](const Fmu& fmu, unsigned r, Integer& v) { v = fmu.choice(r); });
}
template <class Integer>
int choose(void* instance, const unsigned* references, std::size_t n, const Integer* values) {
    return each(instance, references, n, values, [](Fmu& fmu, unsigned r, Integer v) { fmu.choose(r, v); });
}
int step(void* instance, double time, double length) {
    return guarded(instance, [&](Instance& i) {
        i.fmu.step(time, length);
        for (const std::string& text : i.fmu.warnings()) i.report(text.c_str(), warning);
    });
}
int begin(void* instance, double time) {
    return guarded(instance, [&](Instance& i) { i.fmu.set_origin(time); });
}
int initialize(void* instance) {
    return guarded(instance, [](Instance& i) { i.fmu.initialize(); });
}
int terminate(void* instance) {
    return guarded(instance, [](Instance& i) { i.fmu.terminate(); });
}
int reset(void* instance) {
    return guarded(instance, [](Instance& i) { i.fmu.reset(); });
}

using References = const unsigned*;
using Size = std::size_t;

} // namespace

// clang-format off

// ---- FMI 2.0

FMU_EXPORT const char* fmi2GetTypesPlatform() { return "default"; }
FMU_EXPORT const char* fmi2GetVersion() { return "2.0"; }
FMU_EXPORT int fmi2SetDebugLogging(void*, int, Size, const char* const*) { return ok; }
FMU_EXPORT void* fmi2Instantiate(const char* name, int kind, const char*, const char* resources,
                                 const Callbacks2* callbacks, int, int) {
    const Log2 log = callbacks ? callbacks->log : nullptr;
    void* environment = callbacks ? callbacks->environment : nullptr;
    const auto report = [&](const char* message) {
        if (log) log(environment, name ? name : "", error, "logStatusError", "%s", message);
    };
    if (kind != 1) return report("this FMU is for co-simulation"), nullptr;
    Instance* made = instantiate(name, path_of(resources), report);
    if (made) made->log2 = log, made->environment = environment;
    return made;
}
FMU_EXPORT void fmi2FreeInstance(void* i) { instances.remove(i); }
FMU_EXPORT int fmi2SetupExperiment(void* i, int, double, double from, int, double) { return begin(i, from); }
FMU_EXPORT int fmi2EnterInitializationMode(void*) { return ok; }
FMU_EXPORT int fmi2ExitInitializationMode(void* i) { return initialize(i); }
FMU_EXPORT int fmi2Terminate(void* i) { return terminate(i); }
FMU_EXPORT int fmi2Reset(void* i) { return reset(i); }
FMU_EXPORT int fmi2GetReal(void* i, References r, Size n, double* v) { return get(i, r, n, v); }
FMU_EXPORT int fmi2SetReal(void* i, References r, Size n, const double* v) { return set(i, r, n, v); }
FMU_EXPORT int fmi2GetInteger(void* i, References r, Size n, int* v) { return choice(i, r, n, v); }
FMU_EXPORT int fmi2SetInteger(void* i, References r, Size n, const int* v) { return choose(i, r, n, v); }
FMU_EXPORT int fmi2GetBoolean(void* i, References, Size n, int*) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi2SetBoolean(void* i, References, Size n, const int*) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi2GetString(void* i, References, Size n, const char**) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi2SetString(void* i, References, Size n, const char* const*) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi2GetFMUstate(void* i, void** s) { return save(i, s); }
FMU_EXPORT int fmi2SetFMUstate(void* i, void* s) { return restore(i, s); }
FMU_EXPORT int fmi2FreeFMUstate(void* i, void** s) { return forget(i, s); }
FMU_EXPORT int fmi2SerializedFMUstateSize(void* i, void* s, Size* n) { return size_of(i, s, n); }
FMU_EXPORT int fmi2SerializeFMUstate(void* i, void* s, char* bytes, Size n) { return write(i, s, bytes, n); }
FMU_EXPORT int fmi2DeSerializeFMUstate(void* i, const char* bytes, Size n, void** s) { return read(i, bytes, n, s); }
FMU_EXPORT int fmi2GetDirectionalDerivative(void* i, References, Size, References, Size, const double*, double*) { return unsupported(i, __func__); }
FMU_EXPORT int fmi2SetRealInputDerivatives(void* i, References, Size, const int*, const double*) { return unsupported(i, __func__); }
FMU_EXPORT int fmi2GetRealOutputDerivatives(void* i, References, Size, const int*, double*) { return unsupported(i, __func__); }
FMU_EXPORT int fmi2DoStep(void* i, double t, double length, int) { return step(i, t, length); }
FMU_EXPORT int fmi2CancelStep(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi2GetStatus(void*, int, int*) { return discard; }
FMU_EXPORT int fmi2GetRealStatus(void*, int, double*) { return discard; }
FMU_EXPORT int fmi2GetIntegerStatus(void*, int, int*) { return discard; }
FMU_EXPORT int fmi2GetBooleanStatus(void*, int, int*) { return discard; }
FMU_EXPORT int fmi2GetStringStatus(void*, int, const char**) { return discard; }

// ---- FMI 3.0

FMU_EXPORT const char* fmi3GetVersion() { return "3.0"; }
FMU_EXPORT int fmi3SetDebugLogging(void*, bool, Size, const char* const*) { return ok; }
FMU_EXPORT void* fmi3InstantiateCoSimulation(const char* name, const char*, const char* resources, bool, bool, bool, bool,
                                             References, Size, void* environment, Log3 log, void*) {
    const auto report = [&](const char* message) {
        if (log) log(environment, error, "logStatusError", message);
    };
    Instance* made = instantiate(name, resources ? resources : "", report);
    if (made) made->log3 = log, made->environment = environment;
    return made;
}
FMU_EXPORT void* fmi3InstantiateModelExchange(const char*, const char*, const char*, bool, bool, void*, Log3) { return nullptr; }
FMU_EXPORT void* fmi3InstantiateScheduledExecution(const char*, const char*, const char*, bool, bool, void*, Log3, void*, void*, void*) { return nullptr; }
FMU_EXPORT void fmi3FreeInstance(void* i) { instances.remove(i); }
FMU_EXPORT int fmi3EnterInitializationMode(void* i, bool, double, double from, bool, double) { return begin(i, from); }
FMU_EXPORT int fmi3ExitInitializationMode(void* i) { return initialize(i); }
FMU_EXPORT int fmi3EnterEventMode(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3EnterStepMode(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3Terminate(void* i) { return terminate(i); }
FMU_EXPORT int fmi3Reset(void* i) { return reset(i); }
FMU_EXPORT int fmi3GetFloat64(void* i, References r, Size n, double* v, Size) { return get(i, r, n, v); }
FMU_EXPORT int fmi3SetFloat64(void* i, References r, Size n, const double* v, Size) { return set(i, r, n, v); }
FMU_EXPORT int fmi3GetInt32(void* i, References r, Size n, std::int32_t* v, Size) { return choice(i, r, n, v); }
FMU_EXPORT int fmi3SetInt32(void* i, References r, Size n, const std::int32_t* v, Size) { return choose(i, r, n, v); }
FMU_EXPORT int fmi3GetInt64(void* i, References r, Size n, std::int64_t* v, Size) { return choice(i, r, n, v); }
FMU_EXPORT int fmi3SetInt64(void* i, References r, Size n, const std::int64_t* v, Size) { return choose(i, r, n, v); }
#define NO_VARIABLES(kind, type) \
    FMU_EXPORT int fmi3Get##kind(void* i, References, Size n, type*, Size) { return n ? unsupported(i, __func__) : ok; } \
    FMU_EXPORT int fmi3Set##kind(void* i, References, Size n, const std::type_identity_t<type>*, Size) { return n ? unsupported(i, __func__) : ok; }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, std::int8_t)
NO_VARIABLES(UInt8, std::uint8_t)
NO_VARIABLES(Int16, std::int16_t)
NO_VARIABLES(UInt16, std::uint16_t)
NO_VARIABLES(UInt32, std::uint32_t)
NO_VARIABLES(UInt64, std::uint64_t)
NO_VARIABLES(Boolean, bool)
NO_VARIABLES(String, const char*)
FMU_EXPORT int fmi3GetBinary(void* i, References, Size n, Size*, const std::uint8_t**, Size) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi3SetBinary(void* i, References, Size n, const Size*, const std::uint8_t* const*, Size) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi3GetClock(void* i, References, Size n, bool*) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi3SetClock(void* i, References, Size n, const bool*) { return n ? unsupported(i, __func__) : ok; }
FMU_EXPORT int fmi3GetNumberOfVariableDependencies(void* i, unsigned, Size*) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3GetVariableDependencies(void* i, unsigned, Size*, unsigned*, Size*, int*, Size) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3GetFMUState(void* i, void** s) { return save(i, s); }
FMU_EXPORT int fmi3SetFMUState(void* i, void* s) { return restore(i, s); }
FMU_EXPORT int fmi3FreeFMUState(void* i, void** s) { return forget(i, s); }
FMU_EXPORT int fmi3SerializedFMUStateSize(void* i, void* s, Size* n) { return size_of(i, s, n); }
FMU_EXPORT int fmi3SerializeFMUState(void* i, void* s, std::uint8_t* bytes, Size n) { return write(i, s, bytes, n); }
FMU_EXPORT int fmi3DeserializeFMUState(void* i, const std::uint8_t* bytes, Size n, void** s) { return read(i, bytes, n, s); }
FMU_EXPORT int fmi3GetDirectionalDerivative(void* i, References, Size, References, Size, const double*, Size, double*, Size) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3GetAdjointDerivative(void* i, References, Size, References, Size, const double*, Size, double*, Size) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3GetOutputDerivatives(void* i, References, Size, const std::int32_t*, double*, Size) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3EnterConfigurationMode(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3ExitConfigurationMode(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3UpdateDiscreteStates(void* i, bool*, bool*, bool*, bool*, bool*, double*) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3EvaluateDiscreteStates(void* i) { return unsupported(i, __func__); }
FMU_EXPORT int fmi3DoStep(void* i, double t, double length, bool, bool* event, bool* terminate, bool* early, double* last) {
    for (bool* flag : {event, terminate, early})
        if (flag) *flag = false;
    const int outcome = step(i, t, length);
    if (const Instance* instance = of(i); instance && last) *last = instance->fmu.get(rattlebox::fmu::time);
    return outcome;
}

// Functions of other kinds of FMUs. Importers look up all names; the arguments after the instance are not used.
#define OTHER_KIND(name) \
    FMU_EXPORT int fmi3##name(void* i) { return unsupported(i, __func__); }
OTHER_KIND(ActivateModelPartition)
OTHER_KIND(CompletedIntegratorStep)
OTHER_KIND(EnterContinuousTimeMode)
OTHER_KIND(GetContinuousStateDerivatives)
OTHER_KIND(GetContinuousStates)
OTHER_KIND(GetEventIndicators)
OTHER_KIND(GetIntervalDecimal)
OTHER_KIND(GetIntervalFraction)
OTHER_KIND(GetNominalsOfContinuousStates)
OTHER_KIND(GetNumberOfContinuousStates)
OTHER_KIND(GetNumberOfEventIndicators)
OTHER_KIND(GetShiftDecimal)
OTHER_KIND(GetShiftFraction)
OTHER_KIND(SetContinuousStates)
OTHER_KIND(SetIntervalDecimal)
OTHER_KIND(SetIntervalFraction)
OTHER_KIND(SetShiftDecimal)
OTHER_KIND(SetShiftFraction)
OTHER_KIND(SetTime)
