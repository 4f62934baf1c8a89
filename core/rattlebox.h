/* C interface of Rattlebox: dampers as a component in the time loop of another program.
 *
 * A component is made from a packed case, the bytes that `rattlebox pack` writes (rattlebox.Stepper packs
 * cases in memory). All numbers have SI units. Functions that can fail return 0 for success;
 * rattlebox_error() then has the reason. Different components may be used in different threads at the same
 * time.
 */
#ifndef RATTLEBOX_H
#define RATTLEBOX_H

#include <stddef.h>

#if defined(_WIN32)
#define RATTLEBOX_API __declspec(dllexport)
#else
#define RATTLEBOX_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rattlebox_stepper rattlebox_stepper;

/* Creates a component; NULL for failure. The packed case may be freed afterwards. */
RATTLEBOX_API rattlebox_stepper* rattlebox_create(const void* packed_case, size_t size);
RATTLEBOX_API void rattlebox_free(rattlebox_stepper* stepper);

/* Text of the last error; with NULL, of the last rattlebox_create() in this thread. */
RATTLEBOX_API const char* rattlebox_error(const rattlebox_stepper* stepper);

/* 1 for a damper alone, which is driven by the motion of its attachment; 0 for a structure with dampers,
 * which is driven by its loads. */
RATTLEBOX_API int rattlebox_is_alone(const rattlebox_stepper* stepper);
/* Components of a motion or force: 1 for impact dampers, 3 for particle dampers. */
RATTLEBOX_API int rattlebox_components(const rattlebox_stepper* stepper);
RATTLEBOX_API int rattlebox_dampers(const rattlebox_stepper* stepper);
/* Number of inputs: the components of the attachment's acceleration, or the loads of the case. */
RATTLEBOX_API int rattlebox_inputs(const rattlebox_stepper* stepper);
/* Number of outputs: displacements of the points of the case, one for each component; 0 for a damper alone.
 */
RATTLEBOX_API int rattlebox_outputs(const rattlebox_stepper* stepper);

/* Gravity [m/s^2], one number for each component, from the next step on. */
RATTLEBOX_API int rattlebox_set_gravity(rattlebox_stepper* stepper, const double* gravity);

/* Coefficients of restitution and friction; NAN where the contacts of the case have no common constant. */
RATTLEBOX_API double rattlebox_restitution(const rattlebox_stepper* stepper);
RATTLEBOX_API double rattlebox_friction(const rattlebox_stepper* stepper);
/* Chooses them before the first step, NAN for those of the case, and the initial velocity of the attachment
 * of a damper alone (one number for each component [m/s]; NULL for that of the case). */
RATTLEBOX_API int rattlebox_choose(rattlebox_stepper* stepper, double restitution, double friction,
                                   const double* velocity);

/* Advances by a step of some length [s]. `inputs` are the accelerations of the attachment [m/s^2], or the
 * mean values of the loads [N] and base accelerations [m/s^2] in the step. */
RATTLEBOX_API int rattlebox_advance(rattlebox_stepper* stepper, double length, const double* inputs);
/* The same for a damper alone, with the velocity of the attachment at the end of the step [m/s]. */
RATTLEBOX_API int rattlebox_advance_to_velocity(rattlebox_stepper* stepper, double length,
                                                const double* velocity);

RATTLEBOX_API double rattlebox_time(const rattlebox_stepper* stepper);
/* Mean force on the structure in the last step [N], and mean moment about the attachment [N m]; three
 * numbers. */
RATTLEBOX_API void rattlebox_force(const rattlebox_stepper* stepper, int damper, double* force);
RATTLEBOX_API void rattlebox_moment(const rattlebox_stepper* stepper, int damper, double* moment);
/* Work and loss of the last step, and energy stored at its end [J]. The change of the stored energy is work
 * less loss; a step fails if the imbalance exceeds 1 % of the energy put in. */
RATTLEBOX_API double rattlebox_work(const rattlebox_stepper* stepper);
RATTLEBOX_API double rattlebox_loss(const rattlebox_stepper* stepper);
RATTLEBOX_API double rattlebox_stored(const rattlebox_stepper* stepper);
/* Displacements [m] and velocities [m/s] at the end of the last step: of the outputs, or of the attachment
 * (one number for each component). Either pointer may be NULL. */
RATTLEBOX_API void rattlebox_motion(const rattlebox_stepper* stepper, double* displacement, double* velocity);

/* Returns the state and its size; NULL for failure. It is valid until the next call of this function or
 * rattlebox_free(). */
RATTLEBOX_API const void* rattlebox_save(rattlebox_stepper* stepper, size_t* size);
/* Continues from a state of the same case, with the same bits. A damaged or foreign state changes nothing. */
RATTLEBOX_API int rattlebox_restore(rattlebox_stepper* stepper, const void* state, size_t size);

#ifdef __cplusplus
}
#endif

#endif
