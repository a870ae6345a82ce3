/* Prints what the library computes, to the last bit, for comparison with the Rust interface (examples/agree.rs). It
 * compiles as C and as C++. */
#include <goniochrome.h>
#include <stdio.h>
#include <stdlib.h>

#define COUNT(list) (sizeof(list) / sizeof((list)[0]))

#ifndef __cplusplus
_Static_assert(sizeof(gonio_stack) == GONIO_STACK_SIZE, "size of a stack");
_Static_assert(sizeof(gonio_colour) == GONIO_COLOUR_SIZE, "size of a colour");
_Static_assert(sizeof(gonio_table) == GONIO_TABLE_SIZE, "size of a table");
_Static_assert(sizeof(gonio_order_view) == GONIO_ORDER_VIEW_SIZE, "size of a view of orders");
_Static_assert(sizeof(gonio_cell) == GONIO_CELL_SIZE, "size of a cell");
_Static_assert(_Alignof(gonio_stack) == GONIO_STACK_ALIGN, "alignment of a stack");
_Static_assert(_Alignof(gonio_colour) == GONIO_COLOUR_ALIGN, "alignment of a colour");
_Static_assert(_Alignof(gonio_table) == GONIO_TABLE_ALIGN, "alignment of a table");
_Static_assert(_Alignof(gonio_order_view) == GONIO_ORDER_VIEW_ALIGN, "alignment of a view of orders");
_Static_assert(_Alignof(gonio_cell) == GONIO_CELL_ALIGN, "alignment of a cell");
#endif

static void need(gonio_status status) {
    if (status != GONIO_STATUS_OK) {
        fprintf(stderr, "%s\n", gonio_status_text(status));
        exit(1);
    }
}

static void print(const char *what, double x) { printf("%s %a\n", what, x); }

/* Air, a dispersive film on an absorbing substrate. */
static const double table_nm[3] = {350.0, 560.0, 800.0}, film_n[3] = {2.6, 2.45, 2.3}, film_k[3] = {0.02, 0.0, 0.0};
static const double air_n = 1.0, metal_n = 0.9, metal_k = 6.0, glass_n = 1.5;

static gonio_medium medium(const double *nm, const double *n, const double *k, size_t count) {
    gonio_medium made;
    made.wavelength_nm = nm;
    made.n = n;
    made.k = k;
    made.count = count;
    return made;
}

static void films(void) {
    const gonio_medium media[3] = {medium(NULL, &air_n, NULL, 1), medium(table_nm, film_n, film_k, 3),
                                   medium(NULL, &metal_n, &metal_k, 1)};
    const gonio_layer layers[3] = {{180.0, 1}, {90.0, 0}, {410.0, 1}};
    const double cosines[] = {1.0, 0.8, 0.31, 1e-3, 0.0};
    double nm[23];
    float s[COUNT(nm)], p[COUNT(nm)], rgb[3];
    gonio_stack stack;
    gonio_colour colour;
    for (size_t i = 0; i < COUNT(nm); i++) nm[i] = 390.0 + 17.0 * (double)i;
    need(gonio_stack_make(&stack, media, COUNT(media), 0, layers, COUNT(layers), 2));
    need(gonio_colour_make(&colour, GONIO_ILLUMINANT_D65, GONIO_SPACE_REC2020));
    for (size_t a = 0; a < COUNT(cosines); a++) {
        need(gonio_stack_reflectance(&stack, cosines[a], nm, COUNT(nm), s, p));
        for (size_t i = 0; i < COUNT(nm); i++) {
            print("R_s", s[i]);
            print("R_p", p[i]);
        }
        need(gonio_stack_rgb(&stack, &colour, cosines[a], rgb));
        for (int c = 0; c < 3; c++) print("rgb", rgb[c]);
    }
}

/* A ridge of glass along y, two slopes a period. */
static void ridge(uint32_t interference) {
    const double vertices[6][3] = {{0, 0, 0}, {500, 0, 300}, {1000, 0, 0}, {0, 800, 0}, {500, 800, 300}, {1000, 800, 0}};
    const uint32_t triangles[4][3] = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    const uint16_t interface_of[4] = {0, 0, 0, 0};
    const gonio_interface interfaces[1] = {{0, 1}};
    const gonio_medium media[2] = {medium(NULL, &air_n, NULL, 1), medium(NULL, &glass_n, NULL, 1)};
    const double nm[3] = {450.0, 550.0, 650.0};
    gonio_mesh mesh;
    gonio_light light;
    gonio_cell cell;
    gonio_power power[COUNT(nm)];
    double bins[COUNT(nm) * 4 * 8];
    mesh.vertices_nm = vertices[0];
    mesh.vertex_count = COUNT(vertices);
    mesh.triangles = triangles[0];
    mesh.interface_of = interface_of;
    mesh.triangle_count = COUNT(triangles);
    mesh.interfaces = interfaces;
    mesh.interface_count = COUNT(interfaces);
    mesh.media = media;
    mesh.media_count = COUNT(media);
    mesh.period_nm[0] = 1000.0;
    mesh.period_nm[1] = 800.0;
    mesh.ambient = 0;
    light.wi[0] = 0.6;
    light.wi[1] = 0.0;
    light.wi[2] = 0.8;
    light.wavelength_nm = nm;
    light.count = COUNT(nm);
    light.rays = 256;
    light.seed = 7;
    light.bins_cos = 4;
    light.bins_phi = 8;
    light.interference = interference;

    const size_t cell_size = gonio_cell_memory_size(COUNT(triangles), COUNT(interfaces));
    const size_t trace_size = gonio_trace_memory_size(&light);
    uint8_t *memory = (uint8_t *)malloc(cell_size + 1), *scratch = (uint8_t *)malloc(trace_size + 1);
    if (!memory || !scratch) exit(1);
    /* At any alignment. */
    need(gonio_cell_make(&cell, &mesh, memory + 1, cell_size));
    need(gonio_cell_trace(&cell, &light, scratch + 1, trace_size, power, bins));
    for (size_t i = 0; i < COUNT(nm); i++) {
        print("reflected", power[i].reflected);
        print("transmitted", power[i].transmitted);
        print("absorbed", power[i].absorbed);
        print("truncated", power[i].truncated);
    }
    for (size_t i = 0; i < COUNT(bins); i++) print("bin", bins[i]);
    free(memory);
    free(scratch);
}

static void print_light(const gonio_diffracted_light *light) {
    for (int c = 0; c < 3; c++) print("direction", light->direction[c]);
    print("efficiency", light->efficiency);
}

static void orders(const gonio_table *table) {
    gonio_order_counts counts;
    need(gonio_orders_count(table, &counts));
    for (uint32_t order = 0; order < counts.orders; order++) {
        int32_t numbers[2];
        need(gonio_orders_numbers(table, order, numbers));
        for (int c = 0; c < 2; c++) print("order", numbers[c]);
    }
    for (uint32_t w = 0; w < counts.wavelengths; w++) {
        gonio_wavelength wavelength;
        need(gonio_orders_wavelength(table, w, &wavelength));
        print("nm", wavelength.nm);
        for (int c = 0; c < 3; c++) print("rgb", wavelength.rgb[c]);
    }
    for (int i = 0; i < 64; i++) {
        const float wo[3] = {(float)(i % 8) - 3.5f, (float)(i / 8) - 3.5f, 2.0f};
        gonio_order_view view;
        need(gonio_orders_view(&view, table, wo));
        for (uint32_t w = 0; w < counts.wavelengths; w++) {
            for (uint32_t order = 0; order < counts.orders; order++) {
                gonio_diffracted_light light;
                float probability;
                need(gonio_orders_light(&view, w, 0.25f * (float)(i % 5), order, &light));
                need(gonio_orders_probability(&view, w, order, &probability));
                print_light(&light);
                print("probability", probability);
            }
            gonio_order_sample drawn;
            need(gonio_orders_sample(&view, w, (float)i / 64.0f, &drawn));
            print("drawn", drawn.order);
            print_light(&drawn.light);
            print("probability", drawn.probability);
        }
    }
}

static void lobes(const gonio_table *table, const float wi[3]) {
    float albedo[3];
    uint32_t count;
    need(gonio_table_albedo(table, wi, albedo));
    for (int c = 0; c < 3; c++) print("albedo", albedo[c]);
    need(gonio_table_lobe_count(table, &count));
    for (uint32_t i = 0; i < count; i++) {
        gonio_facet_lobe lobe;
        need(gonio_table_lobe(table, wi, i, &lobe));
        for (int c = 0; c < 3; c++) print("direction", lobe.direction[c]);
        for (int c = 0; c < 3; c++) print("reflectance", lobe.reflectance[c]);
    }
}

static void film(const gonio_table *table) {
    gonio_film_description film;
    need(gonio_film_describe(table, &film));
    print("thicknesses", film.thicknesses);
    for (int c = 0; c < 2; c++) print("nm", film.range_nm[c]);
    print("transparent", film.transparent);
    print("finish", film.finish);
    for (int c = 0; c < 2; c++) print("alpha", film.roughness[c]);
    for (int i = 0; i < 64; i++) {
        const float x = (float)(i % 8) - 3.5f, y = (float)(i / 8) - 3.5f, nm = 10.0f * (float)i;
        const float wi[3] = {x, y, 2.0f}, wo[3] = {-y, 0.5f * x, 1.0f}, u[2] = {(float)i / 64.0f, (float)(i % 8) / 8.0f};
        float rgb[3];
        gonio_sample drawn;
        need(gonio_film_reflectance(table, (float)i / 64.0f, nm, rgb));
        for (int c = 0; c < 3; c++) print("reflectance", rgb[c]);
        need(gonio_film_transmittance(table, (float)i / 64.0f, nm, rgb));
        for (int c = 0; c < 3; c++) print("transmittance", rgb[c]);
        need(gonio_film_rgb(table, wi, wo, nm, rgb));
        for (int c = 0; c < 3; c++) print("rgb", rgb[c]);
        need(gonio_film_sample(table, wi, u, nm, &drawn));
        for (int c = 0; c < 3; c++) print("wo", drawn.wo[c]);
        print("pdf", drawn.pdf);
        for (int c = 0; c < 3; c++) print("weight", drawn.weight[c]);
    }
}

static void table(const char *path) {
    FILE *file = fopen(path, "rb");
    static uint8_t bytes[1 << 16];
    if (!file) exit(1);
    const size_t size = fread(bytes, 1, sizeof(bytes), file);
    fclose(file);
    gonio_table view;
    gonio_table_description description;
    need(gonio_table_view(&view, bytes, size));
    need(gonio_table_describe(&view, &description));
    print("kind", description.kind);
    print("channels", description.channels);
    print("space", description.space);
    if (description.kind == GONIO_KIND_ORDERS) {
        orders(&view);
        return;
    }
    if (description.kind != GONIO_KIND_SCATTER) film(&view);
    for (int i = 0; i < 64; i++) {
        /* Exact in binary, and near enough to unit length. */
        const float x = (float)(i % 8) / 8.0f - 0.4375f, y = (float)(i / 8) / 8.0f - 0.4375f;
        const float wi[3] = {x, y, 1.0f - 0.5f * (x * x + y * y)}, wo[3] = {-y, 0.5f * x, 0.75f}, u[2] = {0.5f + x, 0.5f + y};
        float rgb[3], pdf;
        gonio_sample drawn;
        if (description.kind == GONIO_KIND_MIRROR) {
            need(gonio_table_reflectance(&view, u[0], rgb));
        } else {
            need(gonio_table_rgb(&view, wi, wo, rgb));
            need(gonio_table_pdf(&view, wi, wo, &pdf));
            print("pdf", pdf);
            if (description.kind == GONIO_KIND_SCATTER) lobes(&view, wi);
        }
        need(gonio_table_sample(&view, wi, u, &drawn));
        print("pdf", drawn.pdf);
        for (int c = 0; c < 3; c++) {
            print("rgb", rgb[c]);
            print("wo", drawn.wo[c]);
            print("weight", drawn.weight[c]);
        }
    }
}

int main(int count, char **arguments) {
    printf("version %s\nsimd %s\n", gonio_version(), gonio_simd_level());
    films();
    ridge(0);
    ridge(1);
    for (int i = 1; i < count; i++) table(arguments[i]);
    return 0;
}
