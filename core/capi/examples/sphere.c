/* Shades a sphere by a table blob and writes a picture:
 *
 *     goniochrome estimate jewel-beetle -o beetle.exr
 *     goniochrome export beetle.exr --to blob -o beetle.gonio
 *     cc -O2 sphere.c libgoniochrome.a -lm -o sphere && ./sphere beetle.gonio sphere.ppm
 */
#include <goniochrome.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 512 };

/* A sky that brightens towards the zenith, a soft window in it, dark ground. */
static float sky(const float d[3]) {
    const float window = expf(-40.0f * ((d[0] - 0.45f) * (d[0] - 0.45f) + (d[2] - 0.6f) * (d[2] - 0.6f)));
    return d[1] < 0.0f ? 0.12f + 0.1f * d[1] : 0.35f + 0.65f * d[1] + 6.0f * window;
}

/* Two numbers in [0, 1) of a pixel's own: PCG 2D (Jarzynski and Olano, JCGT 2020). If all pixels drew by the same
 * numbers, the edges of what they draw would show as contour lines. */
static void numbers_of(uint32_t x, uint32_t y, float own[2]) {
    x = x * 1664525u + 1013904223u, y = y * 1664525u + 1013904223u;
    x += y * 1664525u, y += x * 1664525u;
    x ^= x >> 16, y ^= y >> 16;
    x += y * 1664525u, y += x * 1664525u;
    x ^= x >> 16, y ^= y >> 16;
    own[0] = (float)(x >> 8) / 16777216.0f, own[1] = (float)(y >> 8) / 16777216.0f;
}

/* Both kinds of table: one direction for a mirror, the mean of some drawn ones for the rest. */
static void shade(const gonio_table *table, const float normal[3], const float own[2], float rgb[3]) {
    enum { SIDE = 4 };
    /* The surface's frame: the eye looks down -z. */
    const float length = hypotf(normal[0], normal[2]);
    const float t[3] = {normal[2] / length, 0.0f, -normal[0] / length};
    const float b[3] = {normal[1] * t[2], normal[2] * t[0] - normal[0] * t[2], -normal[1] * t[0]};
    const float eye[3] = {t[2], b[2], normal[2]};
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    for (int i = 0; i < SIDE * SIDE; i++) {
        /* One number pair in each cell of a grid, all moved by the pixel's own and around the ends. */
        float u[2] = {(float)(i % SIDE) / SIDE + own[0], (float)(i / SIDE) / SIDE + own[1]};
        for (int c = 0; c < 2; c++) u[c] -= u[c] < 1.0f ? 0.0f : 1.0f;
        gonio_sample drawn;
        if (gonio_table_sample(table, eye, u, &drawn) != GONIO_STATUS_OK) continue;
        float d[3];
        for (int c = 0; c < 3; c++) d[c] = drawn.wo[0] * t[c] + drawn.wo[1] * b[c] + drawn.wo[2] * normal[c];
        for (int c = 0; c < 3; c++) rgb[c] += drawn.weight[c] * sky(d) / (SIDE * SIDE);
    }
}

static unsigned char encoded(float linear) {
    const float x = fminf(fmaxf(linear, 0.0f), 1.0f);
    return (unsigned char)(255.0f * (x < 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f) + 0.5f);
}

static unsigned char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0 && (*size = (size_t)ftell(file)) > 0 && (bytes = malloc(*size))) {
        rewind(file);
        *size = fread(bytes, 1, *size, file);
    }
    if (file) fclose(file);
    return bytes;
}

int main(int count, char **arguments) {
    if (count != 3) return fprintf(stderr, "usage: sphere TABLE.gonio PICTURE.ppm\n"), 2;
    size_t size = 0;
    unsigned char *bytes = read_file(arguments[1], &size);
    gonio_table table;
    const gonio_status status = gonio_table_view(&table, bytes, size);
    if (status != GONIO_STATUS_OK) return fprintf(stderr, "%s: %s\n", arguments[1], gonio_status_text(status)), 1;
    FILE *picture = fopen(arguments[2], "wb");
    if (!picture) return fprintf(stderr, "%s: cannot be written\n", arguments[2]), 1;
    fprintf(picture, "P6\n%d %d\n255\n", SIZE, SIZE);
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            float n[3] = {(x + 0.5f) * 2.2f / SIZE - 1.1f, 1.1f - (y + 0.5f) * 2.2f / SIZE, 0.0f};
            float rgb[3] = {0.03f, 0.03f, 0.03f};
            const float inside = 1.0f - n[0] * n[0] - n[1] * n[1];
            if (inside > 0.0f) {
                n[2] = sqrtf(inside);
                float own[2];
                numbers_of((uint32_t)x, (uint32_t)y, own);
                shade(&table, n, own, rgb);
            }
            for (int c = 0; c < 3; c++) fputc(encoded(rgb[c]), picture);
        }
    }
    const int failed = ferror(picture) | fclose(picture);
    free(bytes);
    return failed ? (fprintf(stderr, "%s: cannot be written\n", arguments[2]), 1) : 0;
}
