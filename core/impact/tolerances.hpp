// The tolerances of the 1-D engine: each with its unit and the reason of its size. A part is without unit.
#pragma once

#include "math/real.hpp"

namespace rattlebox {

// ---- energies

// Largest energy residual over the energy supplied for which a run counts as finished, for every method.
inline constexpr real worst_energy_residual = 0.01;
// Balls and points at stops below this speed [m/s] count as at rest: an energy residual below their kinetic
// energy is rounding.
inline constexpr real speed_at_rest = 1e-9;
// Rounding errors of the energies at one time, as part of the largest energy of a run.
inline constexpr real energy_rounding = 64 * epsilon;
// Part of the energy of all bodies that counts in the size of an isolated contact, whose balance is a small
// difference of such energies.
inline constexpr real energy_beside_contact = 1e-2;

// ---- gaps and speeds, as parts of the terms that they are sums of

// Smallest error of a step that can be told from rounding: a step adds some 60 rounded terms.
inline constexpr real step_rounding = 64 * epsilon;
// A gap is a sum of two or three terms, each rounded, and of the motions of modes.
inline constexpr real flight_gap_rounding = 4 * epsilon;
inline constexpr real contact_gap_rounding = 8 * epsilon;
// Difference of two equal velocities after the impulses of an impact.
inline constexpr real speed_rounding = 16 * epsilon;
// Two hard impacts are at one instant if both gaps are zero to the rounding of their terms and of the time.
inline constexpr real instant_rounding = 16 * epsilon;
// A contact may start only if its gap is zero within this many times its rounding; errors of the time of the
// touch and of positions that have added up come on top.
inline constexpr real touching_margin = 64;

// ---- whether touching contacts close, and stuck ones open

// Terms of the Taylor series of a gap below this part of the largest one are rounding: 18 orders of terms
// that cancel up to each other.
inline constexpr real tendency_of_gap = 8192, tendency_of_terms = 64;
// The same of the force of a stuck contact; one that is attractive at first but grows must be beyond the
// limits above, or a contact would open and close without end.
inline constexpr real force_of_all = 512, force_of_terms = 16, force_that_grows = 32;

// ---- steps of closed contacts

// Range of a step after one whose error was below the tolerance, and after a rejected one; the error is of
// order 8.
inline constexpr real largest_growth = 4, smallest_shrink = 0.2, safety = 0.9, unknown_shrink = 0.1;
inline constexpr real error_exponent = -0.125;
inline constexpr int most_rejections = 200; // then the step is below the rounding of the time
// Number of steps, per permitted event, after which a run is stopped as one without end.
inline constexpr long steps_per_event = 200;
// A series of so many steps must move the time by this part of the duration: with less a run would need 1e15
// steps. Contacts that begin below the rounding of the motion, as in a box at rest that its ball fills, do
// not.
inline constexpr long steps_of_series = 1L << 20;
inline constexpr real part_of_series = 1e-9;
// Steps without soft contacts have no error estimate for the sign of a force; as a multiple of the first one.
inline constexpr real longest_free_step = 2.5;
// First step, as part of the shortest time that the motion can change in.
inline constexpr real first_part = 0.1;
// First step of a contact in x, which is 4 times first_part of the overlap.
inline constexpr real first_part_of_x = 0.4;
// A step is tried again with this part if a contact closed within it too deep to start from rest.
inline constexpr real retry_part = 0.25;
// Size of the bracket of an event, as part of the step: rounding.
inline constexpr real event_part = 4 * epsilon;
// Size of the bracket of a peak, as part of the step; the error of the peak is its square.
inline constexpr real peak_part = 1e-8;
// A knot of a measured curve within this part of the overlap was reached by the last step.
inline constexpr real knot_rounding = 32 * epsilon;
// A contact that starts from rest has this part of the scale of the deepest one.
inline constexpr real scale_from_rest = 0.1;

// ---- contacts that close from rest

// Largest change of the approach rate by a contact force that is neglected.
inline constexpr real negligible_force = 1e-8;
// A contact that has closed by more than this many times its overlap over its rate has not closed from rest.
inline constexpr real growth_from_rest = 50;

// ---- contacts that last

// Explicit steps after a long step, and after a failed attempt.
inline constexpr long wait_after_long_step = 250, wait_after_failure = 1000;
// Longest step, in 1/frequency: beyond it rounding errors of the forces matter. Shortest step, times the cube
// of the number of contacts: below it the equations of all nodes cost more than explicit steps.
inline constexpr real longest_lasting = 40, shortest_lasting = 4;
// Nothing moves if speeds and accelerations are below this many tolerances of the overlaps.
inline constexpr real rest_tolerances = 4;
// Part of the range of a resolved function that it can leave its nodes by.
inline constexpr real between_nodes = 0.05;

} // namespace rattlebox
