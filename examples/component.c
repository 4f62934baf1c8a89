/* Couple a damper to a mass on a spring through the C interface.
 *
 *     rattlebox pack steel_ball.toml --alone -o ball.bin
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
    if (!rattlebox_is_alone(damper) || rattlebox_components(damper) != 1) {
        fprintf(stderr, "an impact damper alone is needed\n");
        return 1;
    }
    const double mass = 1.0, omega = 2 * acos(-1.0) * 10, h = 1e-5; /* 1 kg, 10 Hz, steps of 10 us */
    double x = 5e-3, v = 0, force[3] = {0, 0, 0}, loss = 0;
    for (int k = 0; k < 50000; ++k) {
        v += 0.5 * h * (force[0] / mass - omega * omega * x);
        x += h * v;
        if (rattlebox_advance_to_velocity(damper, h, &v)) {
            fprintf(stderr, "%s\n", rattlebox_error(damper));
            return 1;
        }
        rattlebox_force(damper, 0, force);
        loss += rattlebox_loss(damper);
        v += 0.5 * h * (force[0] / mass - omega * omega * x);
    }
    printf("amplitude %.6e m, loss %.6e J\n", sqrt(x * x + v * v / (omega * omega)), loss);
    rattlebox_free(damper);
    return 0;
}
