/* Couple a damper to a mass on a spring through the C interface.
 *
 *     rattlebox pack steel_ball_jackson_green.toml --alone -o ball.bin
 *     cc component.c -I <core headers> <rattlebox_component.so> -lm -o component
 *     ./component ball.bin
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "rattlebox.h"

static void* read_file(const char* name, size_t* size) {
    FILE* file = fopen(name, "rb");
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    void* bytes = malloc(*size);
    *size = fread(bytes, 1, *size, file);
    fclose(file);
    return bytes;
}

int main(int argc, char** argv) {
    size_t size = 0;
    void* packed = argc > 1 ? read_file(argv[1], &size) : NULL;
    rattlebox_stepper* damper = packed ? rattlebox_create(packed, size) : NULL;
    if (!damper) {
        fprintf(stderr, "%s\n", packed ? rattlebox_error(NULL) : "usage: component CASE.bin");
        return 1;
    }
    free(packed);
    /* The structure of this case after a blow; steps of 2 us, a contact lasts 350 us. */
    const double mass = 20, stiffness = 8e4, damping = 25.3, h = 2e-6;
    double x = 0, v = 0.15, force[3] = {0, 0, 0}, loss = 0;
    if (!rattlebox_is_alone(damper) || rattlebox_components(damper) != 1 ||
        rattlebox_choose(damper, NAN, NAN, &v)) {
        fprintf(stderr, "an impact damper alone is needed\n");
        return 1;
    }
    for (int k = 0; k < 25000; ++k) {
        const double half = 0.5 * h / mass;
        v += half * (force[0] - damping * v - stiffness * x);
        x += h * v;
        if (rattlebox_advance_to_velocity(damper, h, &v)) {
            fprintf(stderr, "%s\n", rattlebox_error(damper));
            return 1;
        }
        rattlebox_force(damper, 0, force);
        loss += rattlebox_loss(damper);
        v += half * (force[0] - damping * v - stiffness * x);
    }
    printf("amplitude %.4f mm, lost in the damper %.2f mJ\n", 1e3 * sqrt(x * x + v * v * mass / stiffness),
           1e3 * loss);
    rattlebox_free(damper);
    return 0;
}
