/* Bad input: every call answers with a status, reads nothing out of bounds, and writes no result. */
#include <goniochrome.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void expect(const char *what, gonio_status found, gonio_status expected) {
    if (found != expected) {
        fprintf(stderr, "%s: \"%s\" where \"%s\" belongs\n", what, gonio_status_text(found), gonio_status_text(expected));
        failures++;
    }
}

#define EXPECT(status, call) expect(#call, call, GONIO_STATUS_##status)

/* Results that must stay as they are. */
static float untouched[4] = {-7.0f, -7.0f, -7.0f, -7.0f};
static void check_untouched(const char *what) {
    for (int i = 0; i < 4; i++) {
        if (untouched[i] != -7.0f) {
            fprintf(stderr, "%s: a result was written\n", what);
            failures++;
            untouched[i] = -7.0f;
        }
    }
}

static const double one = 1.0, glass = 1.5, gain = -0.1, absorbs = 0.2, faint = 1e-3;
static const gonio_medium air = {NULL, &one, NULL, 1};

static void films(void) {
    const double nm[3] = {400.0, 500.0, 600.0}, n[3] = {1.5, 1.5, 1.5}, back[3] = {400.0, 600.0, 500.0};
    const gonio_medium media[2] = {{NULL, &one, NULL, 1}, {nm, n, NULL, 3}};
    gonio_layer layers[32];
    gonio_stack stack;
    gonio_colour colour;
    memset(&stack, 0, sizeof(stack));
    memset(&colour, 0, sizeof(colour));
    for (int i = 0; i < 32; i++) layers[i].thickness_nm = 100.0, layers[i].medium = 1;
    float *r = untouched;
    EXPECT(NOT_MADE, gonio_stack_reflectance(&stack, 0.5, nm, 3, r, r));
    EXPECT(NULL_POINTER, gonio_stack_make(NULL, media, 2, 0, layers, 1, 0));
    EXPECT(NULL_POINTER, gonio_stack_make(&stack, NULL, 2, 0, layers, 1, 0));
    EXPECT(NULL_POINTER, gonio_stack_make(&stack, media, 2, 0, NULL, 1, 0));
    EXPECT(MISALIGNED, gonio_stack_make((gonio_stack *)((char *)&stack + 1), media, 2, 0, layers, 1, 0));
    EXPECT(MISALIGNED, gonio_stack_make(&stack, (const gonio_medium *)((const char *)media + 4), 1, 0, layers, 1, 0));
    EXPECT(TOO_MANY, gonio_stack_make(&stack, media, 17, 0, layers, 1, 0));
    EXPECT(TOO_MANY, gonio_stack_make(&stack, media, 2, 0, layers, 32, 0));
    EXPECT(TOO_MANY, gonio_stack_make(&stack, media, 2, 0, layers, SIZE_MAX, 0));
    EXPECT(INDEX, gonio_stack_make(&stack, media, 2, 2, layers, 1, 0));
    EXPECT(INDEX, gonio_stack_make(&stack, media, 2, 0, layers, 1, 2));
    EXPECT(INDEX, gonio_stack_make(&stack, media, 0, 0, layers, 1, 0));
    layers[3].medium = 9;
    EXPECT(INDEX, gonio_stack_make(&stack, media, 2, 0, layers, 5, 0));
    layers[3].medium = 1;
    const double thick[] = {-1.0, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        layers[1].thickness_nm = thick[i];
        EXPECT(THICKNESS, gonio_stack_make(&stack, media, 2, 0, layers, 5, 0));
    }
    layers[1].thickness_nm = 0.0;
    const gonio_medium bad[] = {{back, n, NULL, 3}, {NULL, &glass, &gain, 1}, {NULL, &gain, NULL, 1}, {nm, n, NULL, 0}};
    for (int i = 0; i < 4; i++) EXPECT(MEDIUM, gonio_stack_make(&stack, &bad[i], 1, 0, layers, 0, 0));
    const gonio_medium without[] = {{NULL, n, NULL, 3}, {nm, NULL, NULL, 3}};
    for (int i = 0; i < 2; i++) EXPECT(NULL_POINTER, gonio_stack_make(&stack, &without[i], 1, 0, layers, 0, 0));
    EXPECT(NOT_MADE, gonio_stack_reflectance(&stack, 0.5, nm, 3, r, r));

    EXPECT(OK, gonio_stack_make(&stack, media, 2, 0, layers, 31, GONIO_MIRROR));
    EXPECT(OK, gonio_stack_make(&stack, media, 2, 0, NULL, 0, 1));
    const double angles[] = {NAN, -1e-9, 1.0 + 1e-9, INFINITY, -INFINITY};
    for (int i = 0; i < 5; i++) EXPECT(ANGLE, gonio_stack_reflectance(&stack, angles[i], nm, 3, r, r));
    const double wavelengths[] = {0.0, -500.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) EXPECT(WAVELENGTH, gonio_stack_reflectance(&stack, 0.5, &wavelengths[i], 1, r, r));
    const double beyond[2] = {500.0, 700.0};
    EXPECT(NO_DATA, gonio_stack_reflectance(&stack, 0.5, beyond, 2, r, r));
    EXPECT(WAVELENGTH, gonio_stack_reflectance(&stack, 0.5, nm, 0, r, r));
    EXPECT(NULL_POINTER, gonio_stack_reflectance(&stack, 0.5, NULL, 3, r, r));
    EXPECT(NULL_POINTER, gonio_stack_reflectance(&stack, 0.5, nm, 3, NULL, r));
    EXPECT(NULL_POINTER, gonio_stack_reflectance(&stack, 0.5, nm, 3, r, NULL));
    EXPECT(MISALIGNED, gonio_stack_reflectance(&stack, 0.5, nm, 3, (float *)((char *)r + 2), r));
    EXPECT(TOO_MANY, gonio_stack_reflectance(&stack, 0.5, nm, SIZE_MAX, r, r));
    EXPECT(NOT_MADE, gonio_stack_rgb(&stack, &colour, 0.5, r));
    EXPECT(ARGUMENT, gonio_colour_make(&colour, 2, GONIO_SPACE_SRGB));
    EXPECT(ARGUMENT, gonio_colour_make(&colour, GONIO_ILLUMINANT_E, 0));
    EXPECT(OK, gonio_colour_make(&colour, GONIO_ILLUMINANT_E, GONIO_SPACE_SRGB));
    EXPECT(NO_DATA, gonio_stack_rgb(&stack, &colour, 0.5, r)); /* data from 400 to 600 nm alone */
    const gonio_medium murky = {NULL, &glass, &absorbs, 1};
    EXPECT(OK, gonio_stack_make(&stack, &murky, 1, 0, NULL, 0, GONIO_MIRROR));
    EXPECT(AMBIENT, gonio_stack_rgb(&stack, &colour, 0.5, r));
    check_untouched("films");
    float limit[6];
    const gonio_medium misty = {NULL, &glass, &faint, 1}; /* light arrives through a faint k */
    EXPECT(OK, gonio_stack_make(&stack, &misty, 1, 0, NULL, 0, GONIO_MIRROR));
    EXPECT(OK, gonio_stack_rgb(&stack, &colour, 0.5, limit));
    EXPECT(OK, gonio_stack_make(&stack, media, 2, 0, layers, 5, 1));
    EXPECT(OK, gonio_stack_reflectance(&stack, 0.0, nm, 3, limit, limit + 3));
    for (int i = 0; i < 6; i++) {
        if (!(fabsf(limit[i] - 1.0f) < 1e-5f)) expect("grazing light is reflected", GONIO_STATUS_ANGLE, GONIO_STATUS_OK);
    }
}

static void cells(void) {
    const double vertices[4][3] = {{0, 0, 0}, {1000, 0, 0}, {1000, 1000, 0}, {0, 1000, 0}}, nm[1] = {500.0};
    double moved[4][3];
    const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}}, wrong[2][3] = {{0, 1, 2}, {0, 2, 4}}, flat[1][3] = {{0, 1, 1}};
    const uint16_t interface_of[2] = {0, 0}, beyond[2] = {0, 1};
    const gonio_interface interfaces[1] = {{0, GONIO_MIRROR}}, unknown[1] = {{0, 3}};
    const gonio_mesh mesh = {vertices[0], 4, triangles[0], interface_of, 2, interfaces, 1, &air, 1, {1000.0, 1000.0}, 0};
    const gonio_light light = {{0.0, 0.6, 0.8}, nm, 1, 16, 0, 2, 2, 1};
    const size_t size = gonio_cell_memory_size(2, 1), scratch_size = gonio_trace_memory_size(&light);
    uint8_t *memory = malloc(size), *scratch = malloc(scratch_size);
    gonio_cell cell;
    gonio_power power = {-7.0, -7.0, -7.0, -7.0};
    double bins[4];
    memset(&cell, 0, sizeof(cell));
    EXPECT(NOT_MADE, gonio_cell_trace(&cell, &light, scratch, scratch_size, &power, NULL));
    gonio_mesh bad = mesh;
    bad.triangles = wrong[0];
    EXPECT(INDEX, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.triangles = flat[0], bad.triangle_count = 1;
    EXPECT(MESH, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.triangle_count = 0;
    EXPECT(MESH, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.interface_of = beyond;
    EXPECT(INDEX, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.interfaces = unknown;
    EXPECT(INDEX, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.ambient = 1;
    EXPECT(INDEX, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.period_nm[0] = 900.0;
    EXPECT(PERIOD, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.period_nm[1] = NAN;
    EXPECT(PERIOD, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.vertices_nm = NULL;
    EXPECT(NULL_POINTER, gonio_cell_make(&cell, &bad, memory, size));
    memcpy(moved, vertices, sizeof(moved));
    moved[1][2] = NAN;
    bad = mesh, bad.vertices_nm = moved[0];
    EXPECT(MESH, gonio_cell_make(&cell, &bad, memory, size));
    bad = mesh, bad.triangle_count = SIZE_MAX / 4;
    EXPECT(TOO_MANY, gonio_cell_make(&cell, &bad, memory, size));
    EXPECT(NULL_POINTER, gonio_cell_make(&cell, &mesh, NULL, size));
    EXPECT(NULL_POINTER, gonio_cell_make(&cell, NULL, memory, size));
    // Memory that is aligned well needs none of the room for alignment: 63 bytes for nodes, 31 for corners, 14 for the
    // smaller types.
    for (size_t less = 0; less + 108 < size; less += 8) EXPECT(MEMORY, gonio_cell_make(&cell, &mesh, memory, less));
    EXPECT(OK, gonio_cell_make(&cell, &mesh, memory, size));

    gonio_light odd = light;
    const double away[][3] = {{0, 0, -1}, {0, 0, 0}, {NAN, 0, 1}, {0, 0, 2}, {1, 0, 0}, {INFINITY, 0, 1}};
    for (int i = 0; i < 6; i++) {
        memcpy(odd.wi, away[i], sizeof(odd.wi));
        EXPECT(DIRECTION, gonio_cell_trace(&cell, &odd, scratch, scratch_size, &power, bins));
    }
    odd = light, odd.rays = 0;
    EXPECT(ARGUMENT, gonio_cell_trace(&cell, &odd, scratch, scratch_size, &power, bins));
    odd = light, odd.bins_phi = 0;
    EXPECT(ARGUMENT, gonio_cell_trace(&cell, &odd, scratch, scratch_size, &power, bins));
    odd = light, odd.interference = 2;
    EXPECT(ARGUMENT, gonio_cell_trace(&cell, &odd, scratch, scratch_size, &power, bins));
    odd = light, odd.wavelength_nm = NULL;
    EXPECT(NULL_POINTER, gonio_cell_trace(&cell, &odd, scratch, scratch_size, &power, bins));
    EXPECT(MEMORY, gonio_cell_trace(&cell, &light, scratch, scratch_size / 2, &power, bins));
    if (power.reflected != -7.0) expect("cells", GONIO_STATUS_OK, GONIO_STATUS_ARGUMENT);
    EXPECT(OK, gonio_cell_trace(&cell, &light, scratch, scratch_size, &power, NULL));
    if (!(fabs(power.reflected - 1.0) < 1e-6)) expect("a mirror reflects", GONIO_STATUS_MESH, GONIO_STATUS_OK);
    free(memory);
    free(scratch);
}

static gonio_status view(const uint8_t *bytes, size_t size) {
    /* A block of just this size, so that a checker sees a read beyond it. */
    uint8_t *exact = malloc(size ? size : 1);
    gonio_table table;
    memcpy(exact, bytes, size);
    const gonio_status status = gonio_table_view(&table, exact, size);
    free(exact);
    return status;
}

/* A view of orders: indices beyond the last, numbers out of range. */
static void orders(const gonio_table *table) {
    const float up[3] = {0, 0, 1}, odd[][3] = {{0, 0, -1}, {0, 0, 0}, {1, 0, 0}, {NAN, 0, 1}, {0, 0, INFINITY}, {0, 0, 1e-38f}};
    gonio_order_counts counts;
    gonio_order_view view;
    gonio_wavelength wavelength;
    gonio_diffracted_light light = {{-7.0f, -7.0f, -7.0f}, -7.0f};
    gonio_order_sample sample = {7, light, -7.0f};
    int32_t numbers[2];
    memset(&view, 0, sizeof(view));
    EXPECT(OK, gonio_orders_count(table, &counts));
    EXPECT(NULL_POINTER, gonio_orders_count(table, NULL));
    EXPECT(NOT_MADE, gonio_orders_light(&view, 0, 0.0f, 0, &light));
    for (int i = 0; i < 6; i++) EXPECT(DIRECTION, gonio_orders_view(&view, table, odd[i]));
    EXPECT(NULL_POINTER, gonio_orders_view(&view, table, NULL));
    EXPECT(NULL_POINTER, gonio_orders_view(&view, NULL, up));
    EXPECT(NOT_MADE, gonio_orders_sample(&view, 0, 0.5f, &sample));
    EXPECT(OK, gonio_orders_view(&view, table, up));
    const uint32_t beyond[][2] = {{counts.wavelengths, 0}, {0, counts.orders}, {UINT32_MAX, 0}, {0, UINT32_MAX}};
    for (int i = 0; i < 4; i++) {
        EXPECT(INDEX, gonio_orders_light(&view, beyond[i][0], 0.0f, beyond[i][1], &light));
        EXPECT(INDEX, gonio_orders_probability(&view, beyond[i][0], beyond[i][1], untouched));
    }
    for (int i = 0; i < 4; i += 2) {
        EXPECT(INDEX, gonio_orders_sample(&view, beyond[i][0], 0.5f, &sample));
        EXPECT(INDEX, gonio_orders_wavelength(table, beyond[i][0], &wavelength));
        EXPECT(INDEX, gonio_orders_numbers(table, beyond[i + 1][1], numbers));
    }
    const float shares[] = {-0.5f, 1.5f, NAN}, draws[] = {-0.5f, 1.0f, NAN};
    for (int i = 0; i < 3; i++) {
        EXPECT(ARGUMENT, gonio_orders_light(&view, 0, shares[i], 0, &light));
        EXPECT(ARGUMENT, gonio_orders_sample(&view, 0, draws[i], &sample));
    }
    EXPECT(MISALIGNED, gonio_orders_light((gonio_order_view *)((char *)&view + 1), 0, 0.0f, 0, &light));
    EXPECT(NULL_POINTER, gonio_orders_light(&view, 0, 0.0f, 0, NULL));
    if (light.efficiency != -7.0f || sample.order != 7) expect("orders", GONIO_STATUS_OK, GONIO_STATUS_ARGUMENT);
    EXPECT(OK, gonio_orders_light(&view, counts.wavelengths - 1, 1.0f, counts.orders - 1, &light));
}

static void film(const gonio_table *table, uint32_t kind) {
    const float up[3] = {0, 0, 1}, down[3] = {0, 0, -1}, half[2] = {0.5f, 0.5f}, wrong[2] = {1.0f, 0.5f};
    const float odd[][3] = {{NAN, 0, 1}, {0, 0, 0}, {0, INFINITY, 1}}, thick[] = {-1.0f, NAN, 2e9f};
    gonio_film_description description;
    gonio_sample sample;
    if (kind == GONIO_KIND_SCATTER || kind == GONIO_KIND_ORDERS) {
        EXPECT(WRONG_KIND, gonio_film_describe(table, &description));
        EXPECT(WRONG_KIND, gonio_film_reflectance(table, 0.5f, 100.0f, untouched));
        EXPECT(WRONG_KIND, gonio_film_rgb(table, up, up, 100.0f, untouched));
        EXPECT(WRONG_KIND, gonio_film_sample(table, up, half, 100.0f, &sample));
        return;
    }
    EXPECT(OK, gonio_film_describe(table, &description));
    EXPECT(NULL_POINTER, gonio_film_describe(table, NULL));
    EXPECT(ANGLE, gonio_film_reflectance(table, 1.1f, 100.0f, untouched));
    EXPECT(ANGLE, gonio_film_transmittance(table, NAN, 100.0f, untouched));
    EXPECT(NULL_POINTER, gonio_film_transmittance(table, 0.5f, 100.0f, NULL));
    EXPECT(DIRECTION, gonio_film_sample(table, down, half, 100.0f, &sample));
    EXPECT(ARGUMENT, gonio_film_sample(table, up, wrong, 100.0f, &sample));
    for (int i = 0; i < 3; i++) {
        EXPECT(THICKNESS, gonio_film_reflectance(table, 0.5f, thick[i], untouched));
        EXPECT(THICKNESS, gonio_film_rgb(table, up, up, thick[i], untouched));
        EXPECT(THICKNESS, gonio_film_sample(table, up, half, thick[i], &sample));
        EXPECT(DIRECTION, gonio_film_rgb(table, odd[i], up, 100.0f, untouched));
        EXPECT(DIRECTION, gonio_film_sample(table, odd[i], half, 100.0f, &sample));
    }
}

static void blob(const char *path) {
    static uint8_t bytes[1 << 16], damaged[1 << 16];
    FILE *file = fopen(path, "rb");
    if (!file) exit(1);
    const size_t size = fread(bytes, 1, sizeof(bytes), file);
    fclose(file);
    EXPECT(OK, view(bytes, size));
    for (size_t cut = 0; cut < size; cut++) EXPECT(BLOB_LENGTH, view(bytes, cut));
    for (size_t at = 0; at < size; at++) {
        memcpy(damaged, bytes, size);
        damaged[at] ^= 0x80;
        if (view(damaged, size) == GONIO_STATUS_OK) expect("a changed byte", GONIO_STATUS_OK, GONIO_STATUS_BLOB_CHECKSUM);
    }
    memcpy(damaged, bytes, size);
    damaged[0] = 'X';
    EXPECT(BLOB_MAGIC, view(damaged, size));
    damaged[0] = bytes[0], damaged[8] = 2;
    EXPECT(BLOB_VERSION, view(damaged, size));
    damaged[8] = 1, damaged[60] ^= 1;
    EXPECT(BLOB_CHECKSUM, view(damaged, size));
    memset(damaged + 20, 0xff, 20); /* absurd dimensions, under a wrong checksum too */
    EXPECT(BLOB_CHECKSUM, view(damaged, size));
    gonio_table table;
    EXPECT(NULL_POINTER, gonio_table_view(&table, NULL, size));
    EXPECT(NULL_POINTER, gonio_table_view(NULL, bytes, size));
    EXPECT(TOO_MANY, gonio_table_view(&table, bytes, SIZE_MAX));
    memset(&table, 0, sizeof(table));
    const float up[3] = {0, 0, 1}, half[2] = {0.5f, 0.5f};
    EXPECT(NOT_MADE, gonio_table_rgb(&table, up, up, untouched));
    EXPECT(OK, gonio_table_view(&table, bytes, size));
    gonio_table_description description;
    EXPECT(OK, gonio_table_describe(&table, &description));
    EXPECT(NULL_POINTER, gonio_table_describe(&table, NULL));
    const float cosines[] = {NAN, -0.1f, 1.1f, INFINITY}, odd[][3] = {{NAN, 0, 1}, {0, 0, 0}, {0, INFINITY, 1}};
    for (int i = 0; i < 4; i++) EXPECT(ANGLE, gonio_table_reflectance(&table, cosines[i], untouched));
    for (int i = 0; i < 3; i++) {
        EXPECT(DIRECTION, gonio_table_rgb(&table, odd[i], up, untouched));
        EXPECT(DIRECTION, gonio_table_pdf(&table, up, odd[i], untouched));
        EXPECT(DIRECTION, gonio_table_albedo(&table, odd[i], untouched));
    }
    gonio_sample sample;
    gonio_facet_lobe lobe;
    uint32_t lobes;
    const float down[3] = {0, 0, -1}, wrong[][2] = {{1.0f, 0.5f}, {-0.1f, 0.5f}, {0.5f, NAN}};
    EXPECT(DIRECTION, gonio_table_sample(&table, down, half, &sample));
    for (int i = 0; i < 3; i++) EXPECT(ARGUMENT, gonio_table_sample(&table, up, wrong[i], &sample));
    EXPECT(NULL_POINTER, gonio_table_sample(&table, up, half, NULL));
    EXPECT(NULL_POINTER, gonio_table_sample(&table, up, NULL, &sample));
    film(&table, description.kind);
    if (description.kind == GONIO_KIND_SCATTER || description.kind == GONIO_KIND_ORDERS) {
        EXPECT(WRONG_KIND, gonio_table_reflectance(&table, 0.5f, untouched));
    }
    if (description.kind == GONIO_KIND_MIRROR || description.kind == GONIO_KIND_ORDERS) {
        EXPECT(WRONG_KIND, gonio_table_rgb(&table, up, up, untouched));
        EXPECT(WRONG_KIND, gonio_table_pdf(&table, up, up, untouched));
    }
    if (description.kind != GONIO_KIND_SCATTER) {
        EXPECT(WRONG_KIND, gonio_table_albedo(&table, up, untouched));
        EXPECT(WRONG_KIND, gonio_table_lobe_count(&table, &lobes));
        EXPECT(WRONG_KIND, gonio_table_lobe(&table, up, 0, &lobe));
    } else {
        EXPECT(OK, gonio_table_lobe_count(&table, &lobes));
        EXPECT(INDEX, gonio_table_lobe(&table, up, lobes, &lobe));
        EXPECT(DIRECTION, gonio_table_lobe(&table, odd[0], 0, &lobe));
        EXPECT(NULL_POINTER, gonio_table_lobe(&table, up, 0, NULL));
        EXPECT(NULL_POINTER, gonio_table_lobe_count(&table, NULL));
    }
    if (description.kind == GONIO_KIND_ORDERS) {
        EXPECT(WRONG_KIND, gonio_table_sample(&table, up, half, &sample));
        orders(&table);
    } else {
        gonio_order_view seen;
        EXPECT(WRONG_KIND, gonio_orders_view(&seen, &table, up));
    }
    check_untouched(path);
}

int main(int count, char **arguments) {
    films();
    cells();
    for (int i = 1; i < count; i++) blob(arguments[i]);
    const int odd[] = {-1, 27, 2147483647};
    for (int i = 0; i < 3; i++) {
        if (strcmp(gonio_status_text(odd[i]), "no status of this library") != 0) failures++;
    }
    if (failures) fprintf(stderr, "%d failures\n", failures);
    return failures != 0;
}
