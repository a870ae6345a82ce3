/* C interface of goniochrome. Made by cbindgen from core/capi; tests/run there makes it anew.
 *
 * Objects live in memory of the caller and need no destruction. Every call is re-entrant: it keeps no state, allocates
 * nothing, and uses the caller's stack. Results are written only after GONIO_STATUS_OK. Pointers may be NULL or misaligned, and
 * are answered with a status. Lengths are in nanometres; z is the surface's normal; directions leave the surface.
 */

#ifndef GONIOCHROME_H
#define GONIOCHROME_H

#include <stddef.h>
#include <stdint.h>

/*
 Bytes of a gonio_cell.
 */
#define GONIO_CELL_SIZE (8 * 384)

/*
 Alignment of a gonio_cell.
 */
#define GONIO_CELL_ALIGN 8

/*
 Bytes of a gonio_colour.
 */
#define GONIO_COLOUR_SIZE (8 * 384)

/*
 Alignment of a gonio_colour.
 */
#define GONIO_COLOUR_ALIGN 8

/*
 The light.
 */
#define GONIO_ILLUMINANT_D65 0

/*
 Light of equal energy at every wavelength.
 */
#define GONIO_ILLUMINANT_E 1

/*
 Linear sRGB, Rec. 709 primaries.
 */
#define GONIO_SPACE_SRGB 1

/*
 Linear Rec. 2020.
 */
#define GONIO_SPACE_REC2020 2

/*
 ACEScg.
 */
#define GONIO_SPACE_ACESCG 3

/*
 Most media of a stack or a cell.
 */
#define GONIO_MAX_MEDIA 16

/*
 Most layers of a stack.
 */
#define GONIO_MAX_LAYERS 31

/*
 The index of a perfect mirror, in place of a medium below an interface.
 */
#define GONIO_MIRROR 65535

/*
 Bytes of a gonio_stack.
 */
#define GONIO_STACK_SIZE (8 * 384)

/*
 Alignment of a gonio_stack.
 */
#define GONIO_STACK_ALIGN 8

/*
 Bytes of a gonio_table.
 */
#define GONIO_TABLE_SIZE (8 * 32)

/*
 Alignment of a gonio_table.
 */
#define GONIO_TABLE_ALIGN 8

/*
 A mirror-like surface: one direction out for one in.
 */
#define GONIO_KIND_MIRROR 1

/*
 A surface that reflects everywhere.
 */
#define GONIO_KIND_SCATTER 2

/*
 What a call answers; only after GONIO_STATUS_OK are its results written.
 */
enum gonio_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     Done.
     */
    GONIO_STATUS_OK = 0,
    /*
     A pointer is NULL.
     */
    GONIO_STATUS_NULL_POINTER = 1,
    /*
     A pointer is not aligned for what it points to.
     */
    GONIO_STATUS_MISALIGNED = 2,
    /*
     The object has not been made, or its making failed.
     */
    GONIO_STATUS_NOT_MADE = 3,
    /*
     The memory handed over is too small.
     */
    GONIO_STATUS_MEMORY = 4,
    /*
     More elements than the object has room for, or than memory can hold.
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
     No wavelengths, or one is not from 1e-3 to 1e9 nm.
     */
    GONIO_STATUS_WAVELENGTH = 8,
    /*
     A medium's data are empty, not finite, not increasing in wavelength, or out of range (n from 1e-6 to 1e6, k from 0 to 1e6).
     */
    GONIO_STATUS_MEDIUM = 9,
    /*
     A medium has no data at a wavelength.
     */
    GONIO_STATUS_NO_DATA = 10,
    /*
     An index names a medium, an interface or a vertex that is not there.
     */
    GONIO_STATUS_INDEX = 11,
    /*
     A thickness is not from 0 to 1e9 nm.
     */
    GONIO_STATUS_THICKNESS = 12,
    /*
     The medium that the light comes from absorbs: its k is above 1e-3.
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
     The table is of the other kind.
     */
    GONIO_STATUS_WRONG_KIND = 18,
    /*
     The bytes do not begin as a table blob does.
     */
    GONIO_STATUS_BLOB_MAGIC = 19,
    /*
     The table blob is of a later version.
     */
    GONIO_STATUS_BLOB_VERSION = 20,
    /*
     The table blob is cut short, or followed by other bytes.
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
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gonio_status gonio_status;
#else
typedef int32_t gonio_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 Light, and how to follow it.
 */
typedef struct {
    /*
     The unit vector towards the light, z > 0.
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
     Starting rays over the period.
     */
    uint32_t rays;
    /*
     Which sequence of starting points: results of different seeds are independent.
     */
    uint32_t seed;
    /*
     Bins in cos theta of reflected light, from 0 at the horizon; 1 to 1024.
     */
    uint32_t bins_cos;
    /*
     Bins in phi, from 0 at x; 1 to 1024.
     */
    uint32_t bins_phi;
    /*
     1: paths of one starting ray that leave in one bin interfere; 0: every path adds as power.
     */
    uint32_t interference;
} gonio_light;

/*
 A periodic cell of polygons; made by gonio_cell_make. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_cell;

/*
 The media that facets divide.
 */
typedef struct {
    /*
     The medium on the side from which the triangles run counter-clockwise.
     */
    uint16_t above;
    /*
     The medium on the other side, or GONIO_MIRROR.
     */
    uint16_t below;
} gonio_interface;

/*
 n + ik of a medium against vacuum wavelength. The arrays must outlive what is made of them.
 */
typedef struct {
    /*
     Vacuum wavelengths in nanometres, strictly increasing; not read, and may be NULL, if count is 1.
     */
    const double *wavelength_nm;
    /*
     n at each wavelength, linear between them; from 1e-6 to 1e6.
     */
    const double *n;
    /*
     k at each wavelength, from 0 to 1e6; NULL for a medium that does not absorb.
     */
    const double *k;
    /*
     Number of wavelengths; 1 for the same n and k at all of them.
     */
    size_t count;
} gonio_medium;

/*
 A mesh over one period, [0, period_x] × [0, period_y], z up; it repeats. It must be closed: light that finds a hole
 is lost, and counts as truncated. Vertices that lie beside the border of the period by the rounding of single
 precision count as on it.
 */
typedef struct {
    /*
     Three coordinates for each vertex, in nanometres, from -1e9 to 1e9.
     */
    const double *vertices_nm;
    /*
     Number of vertices.
     */
    size_t vertex_count;
    /*
     Three vertices for each triangle.
     */
    const uint32_t *triangles;
    /*
     The interface of each triangle.
     */
    const uint16_t *interface_of;
    /*
     Number of triangles.
     */
    size_t triangle_count;
    /*
     The interfaces.
     */
    const gonio_interface *interfaces;
    /*
     Number of interfaces.
     */
    size_t interface_count;
    /*
     The media.
     */
    const gonio_medium *media;
    /*
     Number of media.
     */
    size_t media_count;
    /*
     The periods in x and y, in nanometres.
     */
    double period_nm[2];
    /*
     The medium that light comes from.
     */
    uint16_t ambient;
} gonio_mesh;

/*
 Where the light went, as fractions of what came, unpolarised.
 */
typedef struct {
    /*
     Through the top.
     */
    double reflected;
    /*
     Through the bottom.
     */
    double transmitted;
    /*
     By media.
     */
    double absorbed;
    /*
     Of rays that were dropped or lost: the error bar.
     */
    double truncated;
} gonio_power;

/*
 How spectra become colours; made by gonio_colour_make. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_colour;

/*
 A planar stack; made by gonio_stack_make. It may be moved.
 */
typedef struct {
    uint64_t opaque[384];
} gonio_stack;

/*
 A layer.
 */
typedef struct {
    /*
     Thickness in nanometres, from 0 to 1e9.
     */
    double thickness_nm;
    /*
     Which of the media.
     */
    uint16_t medium;
} gonio_layer;

/*
 A view of a table blob; made by gonio_table_view. It may be moved, and shared between threads.
 */
typedef struct {
    uint64_t opaque[32];
} gonio_table;

/*
 What a table holds.
 */
typedef struct {
    /*
     GONIO_KIND_MIRROR or GONIO_KIND_SCATTER.
     */
    uint32_t kind;
    /*
     Channels; RGB is that of the first three.
     */
    uint32_t channels;
    /*
     GONIO_SPACE_…; 0 if the blob does not say, 4 for the matrix that the paper prints.
     */
    uint32_t space;
} gonio_table_description;

/*
 A direction that was drawn, and what light from it is worth.
 */
typedef struct {
    /*
     The direction, a unit vector.
     */
    float wo[3];
    /*
     Its density per solid angle; 1 for a mirror-like surface, which has no other.
     */
    float pdf;
    /*
     BRDF times cos theta_o over the density, RGB; for a mirror-like surface its reflectance.
     */
    float weight[3];
} gonio_sample;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Version of the library, such as "0.1.0".
 */
const char *gonio_version(void);

/*
 The instruction set that the library was compiled for: "avx512", "avx2+fma", "avx", "sse2", "neon", "simd128" or "scalar".
 */
const char *gonio_simd_level(void);

/*
 Bytes of memory, at any alignment, that a cell of so many triangles and interfaces needs; 0 if there are too many.
 */
size_t gonio_cell_memory_size(size_t triangle_count, size_t interface_count);

/*
 Bytes of memory, at any alignment, that gonio_cell_trace needs for such light; 0 if there are too many wavelengths or bins.

 # Safety
 A pointer that is neither NULL nor misaligned points to what its type says.
 */
size_t gonio_trace_memory_size(const gonio_light *light);

/*
 Makes a cell. It keeps pointers to the media's arrays and into `memory`, which has
 `memory_size` bytes, at least gonio_cell_memory_size: all must outlive the cell and must not change. Triangles of one
 interface in one plane are found by comparing each with each: this is for cells of up to some thousand triangles.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types and counts say.
 */
gonio_status gonio_cell_make(gonio_cell *cell, const gonio_mesh *mesh, uint8_t *memory, size_t memory_size);

/*
 Follows light through a cell. `power` holds one element for each wavelength; `bins`, unless it is NULL, the reflected power
 of each bin, rows in cos theta, for each wavelength. `memory` has `memory_size` bytes, at least gonio_trace_memory_size,
 for this call alone. 29 KiB of stack are used, 51 with AVX-512.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types and counts say.
 */
gonio_status gonio_cell_trace(const gonio_cell *cell,
                              const gonio_light *light,
                              uint8_t *memory,
                              size_t memory_size,
                              gonio_power *power,
                              double *bins);

/*
 Prepares colours under `illuminant` (GONIO_ILLUMINANT_…) in `space` (GONIO_SPACE_…).

 # Safety
 A pointer that is neither NULL nor misaligned points to what its type says.
 */
gonio_status gonio_colour_make(gonio_colour *colour, uint32_t illuminant, uint32_t space);

/*
 Makes a stack: `layer_count` layers from the top, light from medium `ambient`, below the last layer medium
 `substrate` or GONIO_MIRROR. The layers are copied, the media's arrays are not.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types and counts say; the media's arrays outlive
 the stack.
 */
gonio_status gonio_stack_make(gonio_stack *stack,
                              const gonio_medium *media,
                              size_t media_count,
                              uint16_t ambient,
                              const gonio_layer *layers,
                              size_t layer_count,
                              uint16_t substrate);

/*
 Reflectance of light that arrives at `cos_theta`, polarised s and p, at each of `count` wavelengths.

 cos_theta in (0, 1]; at 0 the limit: everything is reflected. NaN and all else: GONIO_STATUS_ANGLE. The differences
 from exact arithmetic are below 1e-6: it computes in double precision and rounds once. 20 KiB of stack are used, 35
 with AVX-512.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types and counts say.
 */
gonio_status gonio_stack_reflectance(const gonio_stack *stack,
                                     double cos_theta,
                                     const double *wavelength_nm,
                                     size_t count,
                                     float *reflectance_s,
                                     float *reflectance_p);

/*
 Linear RGB of the light that is reflected at `cos_theta`, unpolarised; components may be negative. Angles as for
 gonio_stack_reflectance.

 It sums 81 wavelengths, 5 nm apart: for films in air up to n d = 6 micrometres it is within 5e-4 of the integral.
 Thicker stacks and narrow filters have fringes between those wavelengths, which tint them; sum finer ones by
 gonio_stack_reflectance.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say; `rgb` to three floats.
 */
gonio_status gonio_stack_rgb(const gonio_stack *stack, const gonio_colour *colour, double cos_theta, float *rgb);

/*
 One line of English for a status; for any other number too.
 */
const char *gonio_status_text(int32_t status);

/*
 Checks a table blob of `size` bytes, at any alignment, and looks at it where it lies: the bytes must outlive the view and
 must not change. Takes time in proportion to the size.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say, and `bytes` to `size` bytes.
 */
gonio_status gonio_table_view(gonio_table *table,
                              const uint8_t *bytes,
                              size_t size);

/*
 What the table holds.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say.
 */
gonio_status gonio_table_describe(const gonio_table *table, gonio_table_description *description);

/*
 Reflectance of a mirror-like surface at `cos_theta`, RGB. Beyond the table's largest angle it is held. NaN and what is
 outside [0, 1]: GONIO_STATUS_ANGLE.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say; `rgb` to three floats.
 */
gonio_status gonio_table_reflectance(const gonio_table *table, float cos_theta, float *rgb);

/*
 The BRDF in 1/sr of a surface that reflects everywhere, RGB, without the cosine. Directions are unit vectors in the
 surface's frame, z its normal, both leaving the surface; 0 if either is below it.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say; `wi`, `wo` and `rgb` to three floats.
 */
gonio_status gonio_table_rgb(const gonio_table *table, const float *wi, const float *wo, float *rgb);

/*
 The density per solid angle with which gonio_table_sample draws `wo` for `wi`; 0 below the surface.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say; `wi` and `wo` to three floats.
 */
gonio_status gonio_table_pdf(const gonio_table *table, const float *wi, const float *wo, float *pdf);

/*
 Draws a direction for `wi`, which must lie above the surface, from two numbers in [0, 1). Either kind of table.

 # Safety
 Pointers that are neither NULL nor misaligned point to what their types say; `wi` to three floats, `u` to two.
 */
gonio_status gonio_table_sample(const gonio_table *table, const float *wi, const float *u, gonio_sample *sample);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GONIOCHROME_H */
