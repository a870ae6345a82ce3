/* C interface of goniochrome. cbindgen generates this file from core/capi.
 *
 * Objects live in memory of the caller and need no destruction. Every call is re-entrant: it keeps no state, allocates
 * nothing, and uses the caller's stack. Results are written only if the status is GONIO_STATUS_OK. Pointers may be NULL
 * or misaligned: calls return a status for those. Lengths are in nanometres; z is the surface's normal; directions
 * leave the surface.
 */

#ifndef GONIOCHROME_H
#define GONIOCHROME_H

#include <stddef.h>
#include <stdint.h>

/*
 Largest number of media of a stack or a cell.
 */
#define GONIO_MAX_MEDIA 16

/*
 Size of a gonio_colour in bytes.
 */
#define GONIO_COLOUR_SIZE (8 * 384)

/*
 Alignment of a gonio_colour in bytes.
 */
#define GONIO_COLOUR_ALIGN 8

/*
 Illuminant D65: daylight of 6504 K.
 */
#define GONIO_ILLUMINANT_D65 0

/*
 Illuminant E: equal energy at every wavelength.
 */
#define GONIO_ILLUMINANT_E 1

/*
 Colour space linear sRGB: Rec. 709 primaries.
 */
#define GONIO_SPACE_SRGB 1

/*
 Colour space linear Rec. 2020.
 */
#define GONIO_SPACE_REC2020 2

/*
 Colour space ACEScg.
 */
#define GONIO_SPACE_ACESCG 3

/*
 Largest number of layers of a stack.
 */
#define GONIO_MAX_LAYERS 31

/*
 Index that stands for a perfect mirror instead of the medium below an interface.
 */
#define GONIO_MIRROR 65535

/*
 Size of a gonio_stack in bytes.
 */
#define GONIO_STACK_SIZE (8 * 384)

/*
 Alignment of a gonio_stack in bytes.
 */
#define GONIO_STACK_ALIGN 8

/*
 Size of a gonio_cell in bytes.
 */
#define GONIO_CELL_SIZE (8 * 384)

/*
 Alignment of a gonio_cell in bytes.
 */
#define GONIO_CELL_ALIGN 8

/*
 Size of a gonio_table in bytes.
 */
#define GONIO_TABLE_SIZE (8 * 40)

/*
 Alignment of a gonio_table in bytes.
 */
#define GONIO_TABLE_ALIGN 8

/*
 Kind of a table: a mirror-like surface, which reflects into one direction only.
 */
#define GONIO_KIND_MIRROR 1

/*
 Kind of a table: a surface that reflects into every direction.
 */
#define GONIO_KIND_SCATTER 2

/*
 Kind of a table: a periodic surface, which reflects into diffraction orders. The functions gonio_orders_… take it.
 */
#define GONIO_KIND_ORDERS 3

/*
 Kind of a table: a mirror-like surface with a transmittance, a thickness that varies, or a finish, by which it
 reflects into every direction. The functions gonio_film_… take it. Functions without a thickness take the first.
 */
#define GONIO_KIND_FILM 4

/*
 Finish of a mirror-like surface: none, the surface is smooth.
 */
#define GONIO_FINISH_NONE 0

/*
 Finish: GGX facets with correlated masking and shadowing.
 */
#define GONIO_FINISH_GGX 1

/*
 Finish: GGX facets with separable masking and shadowing.
 */
#define GONIO_FINISH_GGX_SEPARABLE 2

/*
 Finish: Beckmann facets with correlated masking and shadowing.
 */
#define GONIO_FINISH_BECKMANN 3

/*
 Finish: Beckmann facets with separable masking and shadowing.
 */
#define GONIO_FINISH_BECKMANN_SEPARABLE 4

/*
 Finish: tabulated facets with correlated masking and shadowing.
 */
#define GONIO_FINISH_TABULATED 5

/*
 Finish: tabulated facets with separable masking and shadowing.
 */
#define GONIO_FINISH_TABULATED_SEPARABLE 6

/*
 Size of a gonio_order_view in bytes.
 */
#define GONIO_ORDER_VIEW_SIZE (8 * 32)

/*
 Alignment of a gonio_order_view in bytes.
 */
#define GONIO_ORDER_VIEW_ALIGN 8

/*
 Status that a call returns. Results are written only if it is GONIO_STATUS_OK.
 */
enum gonio_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     The call has succeeded.
     */
    GONIO_STATUS_OK = 0,
    /*
     A pointer is NULL.
     */
    GONIO_STATUS_NULL_POINTER = 1,
    /*
     A pointer is not aligned for its type.
     */
    GONIO_STATUS_MISALIGNED = 2,
    /*
     The object has not been made, or making it has failed.
     */
    GONIO_STATUS_NOT_MADE = 3,
    /*
     The memory that was handed over is too small.
     */
    GONIO_STATUS_MEMORY = 4,
    /*
     There are more elements than the object has room for, or than memory can hold.
     */
    GONIO_STATUS_TOO_MANY = 5,
    /*
     cos theta is not in [0, 1].
     */
    GONIO_STATUS_ANGLE = 6,
    /*
     A direction is not finite, is zero, or points below the surface where it must not.
     */
    GONIO_STATUS_DIRECTION = 7,
    /*
     There are no wavelengths, or one is not from 1e-3 to 1e9 nm.
     */
    GONIO_STATUS_WAVELENGTH = 8,
    /*
     A medium's data are empty, not finite, not increasing in wavelength, or out of range (n from 1e-6 to 1e6, k from
     0 to 1e6).
     */
    GONIO_STATUS_MEDIUM = 9,
    /*
     A medium has no data at a wavelength.
     */
    GONIO_STATUS_NO_DATA = 10,
    /*
     An index refers to a medium, an interface, a vertex, an order, a wavelength or a lobe that does not
     exist.
     */
    GONIO_STATUS_INDEX = 11,
    /*
     A thickness is not from 0 to 1e9 nm.
     */
    GONIO_STATUS_THICKNESS = 12,
    /*
     The medium that the light comes from absorbs too much: its k is above 1e-3.
     */
    GONIO_STATUS_AMBIENT = 13,
    /*
     The mesh is empty, not finite or beyond 1e9 nm, or a triangle has no area.
     */
    GONIO_STATUS_MESH = 14,
    /*
     The period is not positive, or the mesh leaves it.
     */
    GONIO_STATUS_PERIOD = 15,
    /*
     A count or an enumerator is out of range.
     */
    GONIO_STATUS_ARGUMENT = 16,
    /*
     Interfering waves do not converge in this cell; trace it without interference.
     */
    GONIO_STATUS_DIVERGED = 17,
    /*
     The table is of another kind.
     */
    GONIO_STATUS_WRONG_KIND = 18,
    /*
     The bytes do not begin with the magic of a table blob.
     */
    GONIO_STATUS_BLOB_MAGIC = 19,
    /*
     The table blob is of a later version.
     */
    GONIO_STATUS_BLOB_VERSION = 20,
    /*
     The table blob is truncated, or followed by other bytes.
     */
    GONIO_STATUS_BLOB_LENGTH = 21,
    /*
     The table blob is damaged: its checksum differs.
     */
    GONIO_STATUS_BLOB_CHECKSUM = 22,
    /*
     A field of the table blob's header has no meaning.
     */
    GONIO_STATUS_BLOB_FIELD = 23,
    /*
     The table blob's dimensions do not fit its size.
     */
    GONIO_STATUS_BLOB_DIMENSIONS = 24,
    /*
     The table blob's values are not sound.
     */
    GONIO_STATUS_BLOB_VALUES = 25,
    /*
     The table blob holds a scatter table of a version before 0.2: make and export the table anew.
     */
    GONIO_STATUS_BLOB_RETIRED = 26,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gonio_status gonio_status;
#else
typedef int32_t gonio_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Conversion of spectra to RGB; made by gonio_colour_make. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_colour;

/*
 Planar stack; made by gonio_stack_make. It may be moved.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_stack;

/*
 Complex refractive index n + ik of a medium by vacuum wavelength. The arrays must outlive the objects that are made
 from it.
 */
typedef struct {
    /*
     Vacuum wavelengths in nanometres, strictly increasing. Not read, and may be NULL, if count is 1.
     */
    const double *wavelength_nm;
    /*
     n at each wavelength, from 1e-6 to 1e6; linear between them.
     */
    const double *n;
    /*
     k at each wavelength, from 0 to 1e6; linear between them. NULL for a medium that does not absorb.
     */
    const double *k;
    /*
     Number of wavelengths; 1 for a medium with the same n and k at every wavelength.
     */
    size_t count;
} gonio_medium;

/*
 Layer of a stack.
 */
typedef struct {
    /*
     Thickness in nanometres, from 0 to 1e9.
     */
    double thickness_nm;
    /*
     Index of the layer's medium.
     */
    uint16_t medium;
} gonio_layer;

/*
 Incident light, and settings of the tracer.
 */
typedef struct {
    /*
     Unit vector towards the light, z > 0.
     */
    double wi[3];
    /*
     Vacuum wavelengths in nanometres.
     */
    const double *wavelength_nm;
    /*
     Number of wavelengths.
     */
    size_t count;
    /*
     Number of starting rays over the period, at least 1.
     */
    uint32_t rays;
    /*
     Seed of the sequence of starting points. Results of different seeds are independent.
     */
    uint32_t seed;
    /*
     Number of bins of reflected light in cos theta, counted from the horizon; 1 to 1024.
     */
    uint32_t bins_cos;
    /*
     Number of bins of reflected light in phi, counted from x; 1 to 1024.
     */
    uint32_t bins_phi;
    /*
     Coherence. 1: paths of one starting ray that leave within 40 degrees interfere; 0: every path adds as power.
     */
    uint32_t interference;
} gonio_light;

/*
 Periodic cell of polygons; made by gonio_cell_make. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_cell;

/*
 Media on the two sides of a facet.
 */
typedef struct {
    /*
     Index of the medium on the side from which the triangles run counter-clockwise.
     */
    uint16_t above;
    /*
     Index of the medium on the other side, or GONIO_MIRROR.
     */
    uint16_t below;
} gonio_interface;

/*
 Mesh over one period, [0, period_x] × [0, period_y], z up, which repeats. It must be closed: light that falls
 through a hole is lost and counts as truncated. Vertices that lie beside the border of the period by the rounding of
 single precision are moved onto it.
 */
typedef struct {
    /*
     Three coordinates of each vertex, in nanometres, from -1e9 to 1e9.
     */
    const double *vertices_nm;
    /*
     Number of vertices.
     */
    size_t vertex_count;
    /*
     Indices of the three vertices of each triangle.
     */
    const uint32_t *triangles;
    /*
     Index of the interface of each triangle.
     */
    const uint16_t *interface_of;
    /*
     Number of triangles.
     */
    size_t triangle_count;
    /*
     Interfaces.
     */
    const gonio_interface *interfaces;
    /*
     Number of interfaces.
     */
    size_t interface_count;
    /*
     Media.
     */
    const gonio_medium *media;
    /*
     Number of media.
     */
    size_t media_count;
    /*
     Periods in x and y, in nanometres.
     */
    double period_nm[2];
    /*
     Index of the medium that light comes from.
     */
    uint16_t ambient;
} gonio_mesh;

/*
 Distribution of the unpolarised incident power, as fractions of it.
 */
typedef struct {
    /*
     Power that leaves through the top.
     */
    double reflected;
    /*
     Power that leaves through the bottom.
     */
    double transmitted;
    /*
     Power that media absorb.
     */
    double absorbed;
    /*
     Power of rays that were dropped or lost: the error bar.
     */
    double truncated;
} gonio_power;

/*
 View of a table blob; made by gonio_table_view. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[40];
} gonio_table;

/*
 Kind, channels and colour space of a table.
 */
typedef struct {
    /*
     GONIO_KIND_MIRROR, GONIO_KIND_SCATTER, GONIO_KIND_ORDERS or GONIO_KIND_FILM.
     */
    uint32_t kind;
    /*
     Number of channels. The first three are red, green and blue. 3 for orders, the RGB weights of their wavelengths.
     */
    uint32_t channels;
    /*
     Colour space: GONIO_SPACE_…; 0 if it is unknown, 4 for the matrix printed in the paper.
     */
    uint32_t space;
} gonio_table_description;

/*
 Lobe of flat facets: an exact direction into which they reflect.
 */
typedef struct {
    /*
     Direction, a unit vector; zeros if the lobe is not above the surface.
     */
    float direction[3];
    /*
     RGB fraction of the light that leaves in this direction: the radiance seen is it times the radiance from there.
     */
    float reflectance[3];
} gonio_facet_lobe;

/*
 Outgoing direction that was drawn, with its density and weight.
 */
typedef struct {
    /*
     Direction, a unit vector.
     */
    float wo[3];
    /*
     Density per solid angle. It is 1 for a mirror-like surface without a finish, which has no density. 0 for a draw
     without light, which has weight 0 and counts as a sample.
     */
    float pdf;
    /*
     RGB of the BRDF times cos theta_o divided by the density; the reflectance of a mirror-like surface without a
     finish.
     */
    float weight[3];
} gonio_sample;

/*
 Transmittance, thicknesses and finish of a mirror-like surface.
 */
typedef struct {
    /*
     Number of thicknesses; 1 where none varies.
     */
    uint32_t thicknesses;
    /*
     First and last thickness in nm of the layer that varies. Equal where none does.
     */
    float range_nm[2];
    /*
     1 if the table holds a transmittance, else 0.
     */
    uint32_t transparent;
    /*
     Finish: GONIO_FINISH_…
     */
    uint32_t finish;
    /*
     Roughness alpha along x and y; 0 without a finish, and for tabulated facets.
     */
    float roughness[2];
} gonio_film_description;

/*
 Numbers of orders and of wavelengths of a table.
 */
typedef struct {
    /*
     Number of orders.
     */
    uint32_t orders;
    /*
     Number of wavelengths.
     */
    uint32_t wavelengths;
} gonio_order_counts;

/*
 Wavelength of a table of orders.
 */
typedef struct {
    /*
     Vacuum wavelength in nanometres.
     */
    float nm;
    /*
     Linear RGB that a reflectance of 1 at this wavelength adds to a colour. Over all wavelengths they add up to
     white.
     */
    float rgb[3];
} gonio_wavelength;

/*
 Table of diffraction orders seen from one direction; made by gonio_orders_view. It may be moved, and shared between
 threads. It refers to the bytes of the table's blob, not to the gonio_table.
 */
typedef struct {
    uint64_t opaque[32];
} gonio_order_view;

/*
 Light that reaches the viewer by one order.
 */
typedef struct {
    /*
     Direction towards the light, a unit vector; zero if the order is evanescent.
     */
    float direction[3];
    /*
     Share of that light's radiance which the viewer receives, unpolarised; 0 if the order is evanescent.
     */
    float efficiency;
} gonio_diffracted_light;

/*
 Order that was drawn, its light, and the probability of the draw.
 */
typedef struct {
    /*
     Index of the order.
     */
    uint32_t order;
    /*
     Light that reaches the viewer by the order.
     */
    gonio_diffracted_light light;
    /*
     Probability of the draw; 0 if no light reaches the viewer.
     */
    float probability;
} gonio_order_sample;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Version of the library, such as "0.1.0".
 */
const char *gonio_version(void);

/*
 Instruction set that the library was compiled for: "avx512", "avx2+fma", "avx", "sse2", "neon", "simd128" or
 "scalar".
 */
const char *gonio_simd_level(void);

/*
 One line of English that describes a status. Any other number has a text too.
 */
const char *gonio_status_text(int32_t status);

/*
 Makes the conversion of spectra to RGB under `illuminant` (GONIO_ILLUMINANT_…) in `space` (GONIO_SPACE_…).

 # Safety
 A pointer that is neither NULL nor misaligned points to an object of its type.
 */
gonio_status gonio_colour_make(gonio_colour *colour, uint32_t illuminant, uint32_t space);

/*
 Makes a stack of `layer_count` layers, listed from the top. Light comes from medium `ambient`; below the last layer
 lies medium `substrate`, or GONIO_MIRROR. The layers are copied; the media's arrays are not.

 # Safety
 Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say. The
 media's arrays outlive the stack.
 */
gonio_status gonio_stack_make(gonio_stack *stack,
                              const gonio_medium *media,
                              size_t media_count,
                              uint16_t ambient,
                              const gonio_layer *layers,
                              size_t layer_count,
                              uint16_t substrate);

/*
 Computes the reflectance for s and p polarised light that arrives at `cos_theta`, at each of `count` wavelengths.

 cos_theta is in [0, 1]; at 0 the result is the limit: everything is reflected. Any other value, and NaN, give
 GONIO_STATUS_ANGLE. Results differ from exact arithmetic by less than 1e-6: computation is in double precision and
 is rounded once. It uses 20 KiB of stack, 35 KiB with AVX-512.

 # Safety
 Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
 */
gonio_status gonio_stack_reflectance(const gonio_stack *stack,
                                     double cos_theta,
                                     const double *wavelength_nm,
                                     size_t count,
                                     float *reflectance_s,
                                     float *reflectance_p);

/*
 Computes the linear RGB of unpolarised light that is reflected at `cos_theta`, in [0, 1]. Components may be
 negative.

 It sums over 81 wavelengths, 5 nm apart. For films in air up to n d = 6 micrometres the result is within 5e-4 of the
 integral. Thicker stacks and narrow filters have fringes between those wavelengths, and would be tinted: compute
 their reflectance at finer wavelengths by gonio_stack_reflectance and sum that.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
 */
gonio_status gonio_stack_rgb(const gonio_stack *stack, const gonio_colour *colour, double cos_theta, float *rgb);

/*
 Computes the size in bytes of the memory, at any alignment, that a cell of so many triangles and interfaces needs; 0
 if there are too many.
 */
size_t gonio_cell_memory_size(size_t triangle_count, size_t interface_count);

/*
 Computes the size in bytes of the memory, at any alignment, that gonio_cell_trace needs for such light; 0 if there
 are too many wavelengths or bins.

 # Safety
 A pointer that is neither NULL nor misaligned points to an object of its type.
 */
size_t gonio_trace_memory_size(const gonio_light *light);

/*
 Makes a cell in `memory`, which has `memory_size` bytes, at least as many as gonio_cell_memory_size says. The cell
 keeps pointers into `memory` and to the media's arrays: all must outlive the cell and must not change. Triangles of
 one interface in one plane form one facet; they are found by comparing each with each, which suits cells of up to
 some thousand triangles.

 # Safety
 Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
 */
gonio_status gonio_cell_make(gonio_cell *cell, const gonio_mesh *mesh, uint8_t *memory, size_t memory_size);

/*
 Traces light through a cell. `power` receives one element for each wavelength. Unless it is NULL, `bins` receives,
 for each wavelength, the reflected power of each bin, row by row in cos theta. With interference, the power of a bin
 that few rays reach may be below zero, by noise. `memory` has `memory_size` bytes, at least as many as
 gonio_trace_memory_size says, and is used by this call alone. It uses 29 KiB of stack, 51 KiB with AVX-512.

 # Safety
 Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
 */
gonio_status gonio_cell_trace(const gonio_cell *cell,
                              const gonio_light *light,
                              uint8_t *memory,
                              size_t memory_size,
                              gonio_power *power,
                              double *bins);

/*
 Checks a table blob of `size` bytes, at any alignment, and makes a view of it. The bytes are not copied: they must
 outlive the view and must not change. The time is proportional to the size.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types, and `bytes` to `size` bytes.
 */
gonio_status gonio_table_view(gonio_table *table, const uint8_t *bytes, size_t size);

/*
 Describes a table: its kind, channels and colour space.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_table_describe(const gonio_table *table, gonio_table_description *description);

/*
 Looks up the RGB reflectance of a mirror-like surface at `cos_theta`. It is constant beyond the table's largest
 angle. NaN and cosines outside [0, 1] give GONIO_STATUS_ANGLE.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
 */
gonio_status gonio_table_reflectance(const gonio_table *table, float cos_theta, float *rgb);

/*
 Looks up the RGB BRDF in 1/sr, without the cosine, of a surface that reflects into every direction. Directions are
 unit vectors in the surface's frame, whose z is the normal; both leave the surface. The result is 0 if either is
 below it. The lobes of flat facets are not part of it: gonio_table_lobe gives each. It takes tables of
 GONIO_KIND_SCATTER and GONIO_KIND_FILM; without a finish, the latter give 0.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi`, `wo` and `rgb` to three floats.
 */
gonio_status gonio_table_rgb(const gonio_table *table, const float *wi, const float *wo, float *rgb);

/*
 Looks up the RGB albedo of a surface that reflects into every direction: the fraction of the light from `wi` that it
 reflects, lobes included; 0 if `wi` is below the surface. It sums over the whole table: keep the result.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi` and `rgb` to three floats.
 */
gonio_status gonio_table_albedo(const gonio_table *table, const float *wi, float *rgb);

/*
 Counts the lobes of flat facets of a surface that reflects into every direction. Most tables have none.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_table_lobe_count(const gonio_table *table, uint32_t *count);

/*
 Looks up a lobe of flat facets for light from `wi`: its direction, and the fraction of the light that it reflects.
 The radiance that a viewer in the direction `wi` receives by it is the reflectance times the radiance from the
 lobe's direction. Both are 0 if `wi` or the lobe is below the surface.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats.
 */
gonio_status gonio_table_lobe(const gonio_table *table, const float *wi, uint32_t lobe, gonio_facet_lobe *result);

/*
 Looks up the density per solid angle with which gonio_table_sample and gonio_film_sample draw `wo` for `wi`; 0 if
 either is below the surface. It takes tables of GONIO_KIND_SCATTER and GONIO_KIND_FILM; without a finish, the latter
 give 0.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi` and `wo` to three floats.
 */
gonio_status gonio_table_pdf(const gonio_table *table, const float *wi, const float *wo, float *pdf);

/*
 Draws an outgoing direction for `wi`, which must lie above the surface, by two numbers in [0, 1). It takes
 all tables but those of orders; the lobes of flat facets are not drawn. Some draws are without light: their weight
 and density are 0, and their direction is the mirror image of `wi`.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats, `u` to two.
 */
gonio_status gonio_table_sample(const gonio_table *table, const float *wi, const float *u, gonio_sample *sample);

/*
 Describes a mirror-like surface, of GONIO_KIND_MIRROR or GONIO_KIND_FILM.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_film_describe(const gonio_table *table, gonio_film_description *description);

/*
 Looks up the RGB reflectance of a mirror-like surface at `cos_theta`, for a thickness in nm from 0 to 1e9 of the
 layer that varies. It is constant beyond the table's angles and thicknesses. With a finish, it is that of each
 facet. NaN and cosines outside [0, 1] give GONIO_STATUS_ANGLE.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
 */
gonio_status gonio_film_reflectance(const gonio_table *table, float cos_theta, float thickness_nm, float *rgb);

/*
 Looks up the RGB transmittance of a mirror-like surface, as gonio_film_reflectance does the reflectance; 0 if the
 table holds none. It is that of the smooth surface: a finish is one of reflected light.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
 */
gonio_status gonio_film_transmittance(const gonio_table *table, float cos_theta, float thickness_nm, float *rgb);

/*
 Looks up the RGB BRDF in 1/sr, without the cosine, of a mirror-like surface with a finish, for a thickness in nm
 from 0 to 1e9. Directions are in the surface's frame, whose z is the normal; both leave the surface. The result is 0
 if either is below it, and without a finish. A finish with energy compensation returns the light of several bounces
 too. gonio_table_pdf gives the density of gonio_film_sample.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi`, `wo` and `rgb` to three floats.
 */
gonio_status gonio_film_rgb(const gonio_table *table, const float *wi, const float *wo, float thickness_nm, float *rgb);

/*
 Draws an outgoing direction for `wi`, which must lie above the surface, by two numbers in [0, 1), for a thickness in
 nm from 0 to 1e9. Without a finish it is the mirror direction, with density 1. Some draws are without light: their
 weight and density are 0, and their direction is the mirror image of `wi`.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats, `u` to two.
 */
gonio_status gonio_film_sample(const gonio_table *table,
                               const float *wi,
                               const float *u,
                               float thickness_nm,
                               gonio_sample *sample);

/*
 Reads the numbers of orders and of wavelengths of a table of orders.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_orders_count(const gonio_table *table, gonio_order_counts *counts);

/*
 Reads the numbers m and n of an order, along x and y.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `numbers` to two integers.
 */
gonio_status gonio_orders_numbers(const gonio_table *table, uint32_t order, int32_t *numbers);

/*
 Reads a wavelength and its RGB weight.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_orders_wavelength(const gonio_table *table, uint32_t wavelength, gonio_wavelength *result);

/*
 Makes the view of a table of orders from `wo`, the direction towards the viewer in the surface's frame, which lies
 above the surface and need not be of unit length.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types; `wo` to three floats.
 */
gonio_status gonio_orders_view(gonio_order_view *view, const gonio_table *table, const float *wo);

/*
 Looks up the light that reaches the viewer by an order, at the share `t` in [0, 1] of the way from a wavelength to
 the next. The radiance that the viewer receives is the sum of efficiency times radiance from each order's direction.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_orders_light(const gonio_order_view *view,
                                uint32_t wavelength,
                                float t,
                                uint32_t order,
                                gonio_diffracted_light *light);

/*
 Draws an order at a wavelength in proportion to its efficiency, by a number `u` in [0, 1). The estimate of the
 radiance is efficiency/probability times the radiance from the order's direction.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_orders_sample(const gonio_order_view *view,
                                 uint32_t wavelength,
                                 float u,
                                 gonio_order_sample *sample);

/*
 Looks up the probability with which gonio_orders_sample draws an order.

 # Safety
 Pointers that are neither NULL nor misaligned point to objects of their types.
 */
gonio_status gonio_orders_probability(const gonio_order_view *view,
                                      uint32_t wavelength,
                                      uint32_t order,
                                      float *probability);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GONIOCHROME_H */
