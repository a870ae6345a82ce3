/* Prints the colours that a viewer sees on a grating under a lamp, from a blob of a table of diffraction orders:
 *
 *     cc -O2 orders.c libgoniochrome.a -lm -o orders && ./orders disc.gonio
 */
#include <goniochrome.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Radiance of white light from a direction: a lamp of 10 degrees, tilted 30 degrees towards -x, in dim light. */
static float radiance(const float d[3]) {
    const float cosine = -0.5f * d[0] + 0.8660254f * d[2];
    return cosine > 0.9961947f ? 1.0f : 0.01f;
}

/* The colour towards `wo`: each order at each wavelength is one look at the light. */
static gonio_status shade(const gonio_table *table, const float wo[3], float rgb[3]) {
    gonio_order_counts counts = {0, 0};
    gonio_order_view view;
    gonio_status status = gonio_orders_count(table, &counts);
    if (status == GONIO_STATUS_OK) status = gonio_orders_view(&view, table, wo);
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    for (uint32_t w = 0; w < counts.wavelengths && status == GONIO_STATUS_OK; w++) {
        gonio_wavelength wavelength;
        float sum = 0.0f;
        status = gonio_orders_wavelength(table, w, &wavelength);
        for (uint32_t order = 0; order < counts.orders && status == GONIO_STATUS_OK; order++) {
            gonio_diffracted_light light;
            status = gonio_orders_light(&view, w, 0.0f, order, &light);
            if (status == GONIO_STATUS_OK && light.efficiency > 0.0f) sum += light.efficiency * radiance(light.direction);
        }
        for (int c = 0; c < 3 && status == GONIO_STATUS_OK; c++) rgb[c] += wavelength.rgb[c] * sum;
    }
    return status;
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
    if (count != 2) return fprintf(stderr, "usage: orders TABLE.gonio\n"), 2;
    size_t size = 0;
    unsigned char *bytes = read_file(arguments[1], &size);
    gonio_table table;
    gonio_status status = gonio_table_view(&table, bytes, size);
    for (int degrees = -85; degrees <= 85 && status == GONIO_STATUS_OK; degrees += 5) {
        const float angle = (float)degrees * 0.017453293f, wo[3] = {sinf(angle), 0.0f, cosf(angle)};
        float rgb[3];
        status = shade(&table, wo, rgb);
        if (status == GONIO_STATUS_OK) printf("%3d degrees: %7.4f %7.4f %7.4f\n", degrees, rgb[0], rgb[1], rgb[2]);
    }
    if (status != GONIO_STATUS_OK) fprintf(stderr, "%s: %s\n", arguments[1], gonio_status_text(status));
    free(bytes);
    return status != GONIO_STATUS_OK;
}
